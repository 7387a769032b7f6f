#include "io/cgns_names.h"

#include <algorithm>

#include "vdb_offset/io/cgns.h"

namespace vdb_offset {
namespace {

/// At most `bytes`, and no part of a UTF-8 character.
std::string cut(const std::string& text, std::size_t bytes) {
  if (text.size() <= bytes) return text;
  while (bytes > 0 && (static_cast<unsigned char>(text[bytes]) & 0xC0U) == 0x80U) --bytes;
  return text.substr(0, bytes);
}

/// Blanks around a name are lost by the library.
std::string legal(std::string name) {
  std::ranges::replace_if(
      name, [](char c) { return c == '/' || static_cast<unsigned char>(c) < 32 || c == 127; }, '_');
  const std::size_t first = name.find_first_not_of(' ');
  if (first == std::string::npos) return "unnamed";
  name = name.substr(first, name.find_last_not_of(' ') + 1 - first);
  return name == "." || name == ".." ? "unnamed" : name;
}

}  // namespace

std::string CgnsNames::take(const std::string& wanted) {
  const std::string name = legal(wanted);
  std::string candidate = legal(cut(name, kCgnsName));
  for (int n = 2; !taken_.insert(candidate).second; ++n) {
    const std::string number = "-" + std::to_string(n);
    candidate = cut(name, kCgnsName - number.size()) + number;
  }
  return candidate;
}

}  // namespace vdb_offset
