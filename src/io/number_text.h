#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

/// Numbers as text files have them, for every reader of text.
namespace vdb_offset {

inline bool is_space(char c) { return c == ' ' || (c >= '\t' && c <= '\r'); }
inline bool is_digit(char c) { return c >= '0' && c <= '9'; }

/// All of `text` as a whole number; nothing if it is none, or does not fit.
std::optional<std::int64_t> parse_whole(std::string_view text);

/// All of `text` as a number, Fortran's `-.5`, `+1` and `1.0D-3` too. What is too large becomes
/// infinite, what is too small 0; "nan" and "inf" are read as such: callers check.
std::optional<double> parse_real(std::string_view text);

/// A token short enough and clean enough for a message, in quotes.
std::string quoted(std::string_view text);

}  // namespace vdb_offset
