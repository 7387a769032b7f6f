// ISO 10303-21: text in quotes, comments as in C, ".WORDS." in full stops; words else are keywords.

#include "io/cad/step_numbers.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <sstream>
#include <string_view>

#include "vdb_offset/core/error.h"

namespace vdb_offset::cad {
namespace {

constexpr std::string_view kDigits = "0123456789";
constexpr std::string_view kOfNumbers = ".Ee+-";  // so are these

bool is_letter(char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_'; }
bool is_digit(char c) { return kDigits.find(c) != std::string_view::npos; }

class StepText {
 public:
  explicit StepText(std::string text) : text_(std::move(text)) {}

  /// The first number that is none, with its place; empty: all are.
  std::string find() {
    while (at_ < text_.size()) {
      if (is_letter(text_[at_])) {
        const std::string_view word = take([](char c) { return is_letter(c) || is_digit(c); });
        if (!is_enumeration(word) && is_none(word)) return place_of(word);
      } else if (is_digit(text_[at_])) {
        const std::string_view number = take(
            [](char c) { return is_digit(c) || kOfNumbers.find(c) != std::string_view::npos; });
        if (!is_in_range(number)) return place_of(number);
      } else {
        skip();
      }
    }
    return {};
  }

 private:
  /// Text, a comment, or one character.
  void skip() {
    const std::string_view start = std::string_view(text_).substr(at_, 2);
    if (start[0] == '\'' || start[0] == '"') {
      skip_to(start.substr(0, 1), at_ + 1);
    } else if (start == "/*") {
      skip_to("*/", at_ + 2);
    } else {
      ++at_;
    }
  }

  void skip_to(std::string_view end, std::size_t from) {
    const std::size_t found = text_.find(end, from);
    at_ = found == std::string::npos ? text_.size() : found + end.size();
  }

  template <typename Is>
  std::string_view take(const Is& is) {
    const std::size_t from = at_;
    while (at_ < text_.size() && is(text_[at_])) ++at_;
    return std::string_view(text_).substr(from, at_ - from);
  }

  std::size_t start_of(std::string_view word) const {
    return static_cast<std::size_t>(word.data() - text_.data());
  }

  bool is_enumeration(std::string_view word) const {
    const std::size_t start = start_of(word);
    return start > 0 && text_[start - 1] == '.' && at_ < text_.size() && text_[at_] == '.';
  }

  static bool is_none(std::string_view word) {
    constexpr std::array<std::string_view, 6> kNone{"NAN",  "INF", "INFINITY",
                                                    "QNAN", "IND", "SNAN"};
    std::string upper(word);
    for (char& c : upper) c = c >= 'a' && c <= 'z' ? static_cast<char>(c - 'a' + 'A') : c;
    return std::ranges::find(kNone, upper) != kNone.end();
  }

  bool is_in_range(std::string_view number) const {
    constexpr double kMost = 1e150;
    constexpr std::size_t kShort = 100;  // without an exponent no larger
    const std::size_t start = start_of(number);
    if (start > 0 && text_[start - 1] == '#') return true;
    if (number.find_first_of("Ee") == std::string_view::npos && number.size() < kShort) return true;
    return std::abs(std::strtod(std::string(number).c_str(), nullptr)) < kMost;
  }

  std::string place_of(std::string_view word) const {
    const std::size_t start = start_of(word);
    const auto line = 1 + std::count(text_.begin(), text_.begin() + std::ptrdiff_t(start), '\n');
    const std::size_t statement = text_.rfind(';', start);
    const std::size_t name = text_.find('#', statement == std::string::npos ? 0 : statement);
    std::string entity;
    if (name < start) {
      const std::size_t end = text_.find_first_not_of(kDigits, name + 1);
      entity = fmt::format(", in {}", text_.substr(name, end - name));
    }
    return fmt::format("line {}{}: '{}'", line, entity, word.substr(0, 40));
  }

  std::string text_;
  std::size_t at_ = 0;
};

}  // namespace

void check_step_numbers(const std::string& file) {
  std::stringstream text;
  text << std::ifstream(file, std::ios::binary).rdbuf();
  const std::string found = StepText(std::move(text).str()).find();
  if (found.empty()) return;
  throw IoError(
      fmt::format("{}: {} is no number that a length can be; mend it in the program that "
                  "wrote the file",
                  file, found));
}

}  // namespace vdb_offset::cad
