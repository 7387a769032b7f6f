// The formatted kind of PLOT3D, after Walatka et al., "PLOT3D User's Manual" (NASA TM 101067,
// 1990): list-directed Fortran input, so only tokens count, never lines.

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <optional>
#include <system_error>

#include "io/number_text.h"
#include "io/plot3d_cursor.h"

namespace vdb_offset {
namespace {

/// Repeat counts may ask for anything. A point has four numbers at most and takes a byte at least,
/// so counting further could not make a file fit.
std::uint64_t most_numbers(std::string_view bytes) {
  return 8 * (static_cast<std::uint64_t>(bytes.size()) + 1);
}

}  // namespace

double plot3d_length_distance(std::uint64_t have, std::uint64_t need) {
  const double a = static_cast<double>(std::min(have, need));
  const double b = static_cast<double>(std::max(have, need));
  return 1.0 - a / b;
}

Plot3dTextCursor::Plot3dTextCursor(std::string_view bytes) : bytes_(bytes), token_(bytes) {
  const std::uint64_t most = most_numbers(bytes);
  Plot3dTextCursor scan = *this;
  while (count_ <= most && scan.next_token()) count_ += std::min(scan.repeat_, most);
}

void Plot3dTextCursor::set_dialect(const Plot3dDialect& dialect) { dialect_ = dialect; }

bool Plot3dTextCursor::next_token() {
  const auto skip_space = [this] {
    while (end_ < bytes_.size() && is_space(bytes_[end_])) ++end_;
  };
  skip_space();
  if (after_value_ && end_ < bytes_.size() && bytes_[end_] == ',') {
    ++end_;
    skip_space();
  }
  if (end_ == bytes_.size()) return false;
  const std::size_t begin = end_;
  std::size_t digits = 0;
  while (end_ < bytes_.size() && !is_space(bytes_[end_]) && bytes_[end_] != ',') {
    if (digits == end_ - begin && is_digit(bytes_[end_])) ++digits;
    ++end_;
  }
  after_value_ = true;
  ++tokens_;
  repeat_ = 1;
  token_ = bytes_.substr(begin, end_ - begin);
  if (digits == 0 || digits + 1 >= token_.size() || token_[digits] != '*') return true;
  const auto error = std::from_chars(token_.data(), token_.data() + digits, repeat_).ec;
  if (error != std::errc{} || repeat_ == 0) {
    repeat_ = 1;  // left in the token, so that it is refused as a number
  } else {
    token_.remove_prefix(digits + 1);
  }
  return true;
}

void Plot3dTextCursor::advance() {
  if (repeat_ > 0) --repeat_;
  if (repeat_ == 0 && !next_token()) {
    throw Plot3dMismatch{fmt::format("the file ends after {} numbers, inside its header", taken_),
                         bytes_.size(), Plot3dMismatch::kBadCount};
  }
  ++taken_;
}

void Plot3dTextCursor::refuse(std::string_view rule) const {
  throw Plot3dMismatch{fmt::format("{} is {}, which is not {}", position(), quoted(token_), rule),
                       byte(), Plot3dMismatch::kBadData};
}

std::int64_t Plot3dTextCursor::whole() {
  advance();
  const std::optional<std::int64_t> value = parse_whole(token_);
  if (!value) refuse("a whole number");
  return *value;
}

double Plot3dTextCursor::coordinate() {
  advance();
  const std::optional<double> value = parse_real(token_);
  if (!value) refuse("a number");
  return *value;
}

bool Plot3dTextCursor::whole_literal() const {
  return token_.find_first_not_of("+-0123456789") == std::string_view::npos;
}

std::string Plot3dTextCursor::position() const {
  return fmt::format("token {} (byte {})", tokens_, byte());
}

void Plot3dTextCursor::check_length(const std::vector<Plot3dBlockSize>& blocks) const {
  const int numbers = plot3d_dimensions(dialect_) + (dialect_.iblank ? 1 : 0);
  std::uint64_t points = 0;
  for (const Plot3dBlockSize& size : blocks) points += plot3d_points(size);
  const std::uint64_t need = taken_ + points * static_cast<std::uint64_t>(numbers);
  if (need == count_ && points <= size()) return;
  throw Plot3dMismatch{
      fmt::format("its sizes (blocks: {}, points: {}) need {} numbers, and the file holds {}{}",
                  blocks.size(), points, need, count_ > most_numbers(bytes_) ? "more than " : "",
                  std::min(count_, most_numbers(bytes_))),
      bytes_.size(), plot3d_length_distance(count_, need)};
}

std::string Plot3dTextCursor::remark() const {
  Plot3dTextCursor scan = *this;
  while (scan.next_token()) {
    if (parse_real(scan.token_)) continue;
    return fmt::format(" ({} is {}, which is not a number)", scan.position(), quoted(scan.token_));
  }
  return {};
}

}  // namespace vdb_offset
