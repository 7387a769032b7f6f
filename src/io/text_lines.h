#pragma once

#include <cstddef>
#include <string_view>
#include <vector>

namespace vdb_offset {

/// The lines of a text in memory, counted from 1; ended by "\n", "\r\n" or "\r".
class TextLines {
 public:
  /// A byte order mark of UTF-8 is passed over.
  explicit TextLines(std::string_view bytes) : rest_(bytes) {
    if (rest_.substr(0, 3) == "\xEF\xBB\xBF") rest_.remove_prefix(3);
  }

  /// Steps to the next line; false after the last.
  bool next();
  std::string_view line() const { return line_; }
  std::size_t number() const { return number_; }

 private:
  std::string_view rest_;
  std::string_view line_;
  std::size_t number_ = 0;
};

/// What blanks and commas separate.
std::vector<std::string_view> tokens_of(std::string_view line);

}  // namespace vdb_offset
