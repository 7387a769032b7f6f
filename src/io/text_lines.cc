#include "io/text_lines.h"

#include <algorithm>

#include "io/number_text.h"

namespace vdb_offset {

bool TextLines::next() {
  if (rest_.empty()) return false;
  const std::size_t end = std::min(rest_.find_first_of("\r\n"), rest_.size());
  line_ = rest_.substr(0, end);
  const bool pair = rest_.substr(end, 2) == "\r\n";
  rest_.remove_prefix(std::min(end + (pair ? 2 : 1), rest_.size()));
  ++number_;
  return true;
}

std::vector<std::string_view> tokens_of(std::string_view line) {
  std::vector<std::string_view> tokens;
  const auto separates = [](char c) { return is_space(c) || c == ','; };
  std::size_t at = 0;
  while (at < line.size()) {
    while (at < line.size() && separates(line[at])) ++at;
    const std::size_t begin = at;
    while (at < line.size() && !separates(line[at])) ++at;
    if (at > begin) tokens.push_back(line.substr(begin, at - begin));
  }
  return tokens;
}

}  // namespace vdb_offset
