#include "io/xml_text.h"

#include <cstddef>

namespace vdb_offset {
namespace {

bool continues(std::string_view text, std::size_t at) {
  return at < text.size() && (static_cast<unsigned char>(text[at]) & 0xC0U) == 0x80U;
}

/// Bytes of the UTF-8 sequence that starts at `at`, 0 if there is none. Overlong forms, surrogates
/// and the two non-characters U+FFFE and U+FFFF do not count.
std::size_t sequence_length(std::string_view text, std::size_t at) {
  const auto first = static_cast<unsigned char>(text[at]);
  const std::size_t length = first < 0x80U                      ? 1
                             : first >= 0xC2U && first < 0xE0U  ? 2
                             : first >= 0xE0U && first < 0xF0U  ? 3
                             : first >= 0xF0U && first <= 0xF4U ? 4
                                                                : 0;
  if (length < 2) return length;
  for (std::size_t n = 1; n < length; ++n) {
    if (!continues(text, at + n)) return 0;
  }
  const auto second = static_cast<unsigned char>(text[at + 1]);
  const bool overlong = (first == 0xE0U && second < 0xA0U) || (first == 0xF0U && second < 0x90U);
  const bool outside = (first == 0xEDU && second >= 0xA0U) || (first == 0xF4U && second >= 0x90U);
  const std::string_view sequence = text.substr(at, length);
  const bool non_character = sequence == "\xEF\xBF\xBE" || sequence == "\xEF\xBF\xBF";
  return overlong || outside || non_character ? 0 : length;
}

std::string escaped(char c) {
  switch (c) {
    case '&':
      return "&amp;";
    case '<':
      return "&lt;";
    case '>':
      return "&gt;";
    case '"':
      return "&quot;";
    case '\'':
      return "&apos;";
    default:
      return std::string(1, static_cast<unsigned char>(c) < 0x20U || c == 0x7F ? '?' : c);
  }
}

}  // namespace

std::string xml_text(std::string_view text) {
  std::string result;
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t length = sequence_length(text, at);
    if (length < 2) {
      result += length == 0 ? "?" : escaped(text[at]);
      ++at;
      continue;
    }
    result += text.substr(at, length);
    at += length;
  }
  return result;
}

}  // namespace vdb_offset
