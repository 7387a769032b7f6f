#include "vdb_offset/core/units.h"

#include <fmt/format.h>

#include <array>
#include <cctype>
#include <charconv>
#include <cmath>
#include <optional>
#include <system_error>

#include "vdb_offset/core/error.h"

namespace vdb_offset {
namespace {

constexpr std::string_view kPrefixes = "KMGTP";

std::string_view trimmed(std::string_view text) {
  constexpr std::string_view kSpace = " \t\r\n";
  const std::size_t begin = text.find_first_not_of(kSpace);
  if (begin == std::string_view::npos) return {};
  return text.substr(begin, text.find_last_not_of(kSpace) - begin + 1);
}

/// The power of 1024 that "", "B", "K", "KB", "KiB" ... "PiB" stand for, in any case.
std::optional<int> power_of_suffix(std::string_view suffix) {
  std::string upper;
  for (const char c : suffix)
    upper += static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
  if (upper.empty() || upper == "B") return 0;
  const std::size_t prefix = kPrefixes.find(upper[0]);
  const std::string_view rest = std::string_view(upper).substr(1);
  if (prefix == std::string_view::npos) return {};
  if (!rest.empty() && rest != "B" && rest != "IB") return {};
  return static_cast<int>(prefix) + 1;
}

}  // namespace

std::string format_bytes(double bytes) {
  constexpr std::array kUnits = {"KiB", "MiB", "GiB", "TiB", "PiB"};
  // The half of the last digit shown: 1023.996 KiB must read "1.00 MiB", not "1024.00 KiB".
  constexpr double kNextUnit = 1024.0 - 0.005;
  if (std::abs(bytes) < 1023.5) return fmt::format("{:.0f} B", bytes);
  double value = bytes / 1024.0;
  std::size_t unit = 0;
  while (std::abs(value) >= kNextUnit && unit + 1 < kUnits.size()) {
    value /= 1024.0;
    ++unit;
  }
  return fmt::format("{:.2f} {}", value, kUnits[unit]);
}

std::uint64_t parse_bytes(std::string_view text) {
  const auto refuse = [&](std::string_view why) {
    return InputError(fmt::format(
        "\"{}\" is not a number of bytes: {}; write it like 4G, 512MiB or 1048576", text, why));
  };
  const std::string_view words = trimmed(text);
  double value = 0.0;
  const auto [end, error] = std::from_chars(words.data(), words.data() + words.size(), value);
  if (error != std::errc{}) throw refuse("it must start with a number");
  const auto used = static_cast<std::size_t>(end - words.data());
  const std::string_view suffix = trimmed(words.substr(used));
  const std::optional<int> power = power_of_suffix(suffix);
  if (!std::isfinite(value)) throw refuse("the number must be finite");
  if (!power) throw refuse(fmt::format("the unit \"{}\" is unknown", suffix));
  if (value < 0.0) throw refuse("it must not be negative");
  const double bytes = std::floor(std::ldexp(value, 10 * *power));
  if (bytes >= std::ldexp(1.0, 64)) throw refuse("it does not fit in 64 bits");
  return static_cast<std::uint64_t>(bytes);
}

}  // namespace vdb_offset
