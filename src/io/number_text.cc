#include "io/number_text.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <system_error>

namespace vdb_offset {
namespace {

/// from_chars takes no plus sign; Fortran and C write one.
std::string_view without_plus(std::string_view text) {
  const bool plus = text.size() > 1 && text[0] == '+' && text[1] != '-' && text[1] != '+';
  return plus ? text.substr(1) : text;
}

/// A number that from_chars calls out of range: below the smallest double it is zero. Its exponent
/// tells, or else whether there are digits before the point.
double out_of_range(std::string_view text) {
  const std::size_t exponent = text.find_first_of("eE");
  const std::size_t first = text.find_first_not_of("+-0");
  const bool tiny = exponent != std::string_view::npos
                        ? text.substr(exponent).find('-') != std::string_view::npos
                        : first != std::string_view::npos && text[first] == '.';
  const double size = tiny ? 0.0 : HUGE_VAL;
  return text[0] == '-' ? -size : size;
}

}  // namespace

std::optional<std::int64_t> parse_whole(std::string_view text) {
  text = without_plus(text);
  std::int64_t value = 0;
  const char* end = text.data() + text.size();
  const auto [stop, error] = std::from_chars(text.data(), end, value);
  if (error != std::errc{} || stop != end) return {};
  return value;
}

std::optional<double> parse_real(std::string_view text) {
  text = without_plus(text);
  double value = 0.0;
  const char* end = text.data() + text.size();
  const auto [stop, error] = std::from_chars(text.data(), end, value);
  if (stop == end && error == std::errc{}) return value;
  if (stop == end && error == std::errc::result_out_of_range) return out_of_range(text);
  std::array<char, 64> buffer{};
  if (stop == end || (*stop != 'D' && *stop != 'd') || text.size() > buffer.size()) return {};
  std::copy(text.begin(), text.end(), buffer.begin());
  buffer[static_cast<std::size_t>(stop - text.data())] = 'e';
  const std::string_view with_e(buffer.data(), text.size());
  const char* end_e = buffer.data() + text.size();
  const auto [stop_e, error_e] = std::from_chars(buffer.data(), end_e, value);
  if (stop_e != end_e) return {};
  if (error_e == std::errc::result_out_of_range) return out_of_range(with_e);
  return error_e == std::errc{} ? std::optional(value) : std::nullopt;
}

std::string quoted(std::string_view text) {
  constexpr std::size_t kShown = 32;
  std::string shown = "\"";
  for (const char c : text.substr(0, kShown)) shown += c > ' ' && c <= '~' ? c : '?';
  return shown + (text.size() > kShown ? "...\"" : "\"");
}

}  // namespace vdb_offset
