#pragma once

#include <algorithm>
#include <cstddef>
#include <random>
#include <string>
#include <string_view>

namespace vdb_offset::test {

/// One of the ways in which files are broken: bytes changed (some to `letters`, which mean
/// something in the format), cut out, doubled, or cut off; half of them near the front, where sizes
/// are.
inline void mutate(std::string& bytes, std::mt19937& random, std::string_view letters) {
  const auto below = [&random](std::size_t n) { return n == 0 ? 0 : random() % n; };
  const std::size_t reach =
      random() % 2 == 0 ? std::min<std::size_t>(bytes.size(), 200) : bytes.size();
  const std::size_t at = below(reach);
  const std::size_t length = 1 + below(std::min<std::size_t>(bytes.size() - at, 40));
  switch (random() % 6) {
    case 0:
      bytes[at] = static_cast<char>(random());
      break;
    case 1:
      bytes[at] = static_cast<char>(bytes[at] ^ (1 << random() % 8));
      break;
    case 2:
      bytes.erase(at, length);
      break;
    case 3:
      bytes.insert(at, bytes.substr(at, length));
      break;
    case 4:
      bytes.resize(below(bytes.size()));
      break;
    default:
      bytes[at] = letters[below(letters.size())];
      break;
  }
}

}  // namespace vdb_offset::test
