#include "io/text_words.h"

#include <algorithm>

#include "io/number_text.h"

namespace vdb_offset {

bool TextWords::at_line_end() const {
  return at_ >= bytes_.size() || bytes_[at_] == '\n' || bytes_[at_] == '\r';
}

void TextWords::skip_comment() {
  if (comment_ == '\0' || at_ >= bytes_.size() || bytes_[at_] != comment_) return;
  at_ = std::min(bytes_.find_first_of("\r\n", at_), bytes_.size());
}

bool TextWords::next_of_line() {
  while (!at_line_end() && is_space(bytes_[at_])) ++at_;
  skip_comment();
  word_ = {};
  if (at_line_end()) return false;
  const std::size_t begin = at_;
  while (at_ < bytes_.size() && !is_space(bytes_[at_]) &&
         (comment_ == '\0' || bytes_[at_] != comment_)) {
    ++at_;
  }
  word_ = bytes_.substr(begin, at_ - begin);
  return true;
}

bool TextWords::next() {
  while (!next_of_line()) {
    if (at_ >= bytes_.size()) return false;
    at_ += bytes_.substr(at_, 2) == "\r\n" ? 2 : 1;
    ++line_;
  }
  return true;
}

std::string_view TextWords::rest_of_line() {
  const std::size_t end = std::min(bytes_.find_first_of("\r\n", at_), bytes_.size());
  std::string_view rest = bytes_.substr(at_, end - at_);
  at_ = end;
  while (!rest.empty() && is_space(rest.front())) rest.remove_prefix(1);
  while (!rest.empty() && is_space(rest.back())) rest.remove_suffix(1);
  return rest;
}

}  // namespace vdb_offset
