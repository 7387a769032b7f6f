#include "io/vtk_stream.h"

#include <algorithm>
#include <array>
#include <cstdint>

#include "io/number_text.h"

namespace vdb_offset {
namespace {

/// What a letter of base64 (RFC 4648) stands for; -1 for others.
int base64_value(char c) {
  if (c >= 'A' && c <= 'Z') return c - 'A';
  if (c >= 'a' && c <= 'z') return c - 'a' + 26;
  if (c >= '0' && c <= '9') return c - '0' + 52;
  if (c == '+') return 62;
  return c == '/' ? 63 : -1;
}

}  // namespace

/// Four letters to three bytes, or to less where '=' ends a part.
bool VtkStream::decode_group() {
  std::array<int, 4> values{};
  std::size_t letters = 0;
  std::size_t used = 0;
  for (; used < text_.size() && letters < 4; ++used) {
    const char c = text_[used];
    if (is_space(c)) continue;
    values[letters] = c == '=' ? -2 : base64_value(c);
    if (values[letters] == -1) return false;
    ++letters;
  }
  if (letters < 4 || values[0] < 0 || values[1] < 0) return false;
  text_.remove_prefix(used);
  std::uint32_t bits = 0;
  for (const int value : values)
    bits = (bits << 6U) | static_cast<std::uint32_t>(std::max(value, 0));
  const std::size_t bytes = values[2] < 0 ? 1 : values[3] < 0 ? 2 : 3;
  for (std::size_t n = 0; n < bytes; ++n) {
    ready_.push_back(static_cast<char>((bits >> (16U - 8U * n)) & 0xFFU));
  }
  return true;
}

std::string_view VtkStream::take(std::size_t count) {
  if (is_raw_) {
    const std::string_view out = text_.substr(0, count);
    text_.remove_prefix(out.size());
    return out;
  }
  ready_.erase(0, given_);
  while (ready_.size() < count && decode_group()) {
  }
  given_ = std::min(count, ready_.size());
  return std::string_view(ready_).substr(0, given_);
}

}  // namespace vdb_offset
