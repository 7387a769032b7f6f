#pragma once

#include <cstddef>
#include <string_view>

namespace vdb_offset {

/// The words of a text in memory, one after another, whatever the lines; lines are counted from 1
/// and end as in TextLines.
class TextWords {
 public:
  /// From `comment` on a line is passed over, unless it is 0.
  explicit TextWords(std::string_view bytes, char comment = '\0', std::size_t line = 1)
      : bytes_(bytes), comment_(comment), line_(line) {}

  /// Steps to the next word; false after the last.
  bool next();
  /// The same, but not beyond the line of the word before.
  bool next_of_line();
  std::string_view word() const { return word_; }
  /// Of the word; of the end after the last.
  std::size_t line() const { return line_; }
  /// What follows the word on its line, without the blanks round it; passed over.
  std::string_view rest_of_line();

 private:
  bool at_line_end() const;
  void skip_comment();

  std::string_view bytes_;
  char comment_;
  std::size_t line_;
  std::size_t at_ = 0;
  std::string_view word_;
};

}  // namespace vdb_offset
