#pragma once

#include <cstdint>
#include <numbers>
#include <string>
#include <string_view>

namespace vdb_offset {

inline double radians(double degrees) { return degrees * std::numbers::pi / 180.0; }
inline double degrees(double radians) { return radians * 180.0 / std::numbers::pi; }

/// "1.50 GiB" for 1610612736.
std::string format_bytes(double bytes);

/// Bytes in "4G", "512MiB", "1.5 GB" or "1048576" (K, M, G, T are powers of 1024).
/// Throws InputError for anything else, for a negative or a non-finite number.
std::uint64_t parse_bytes(std::string_view text);

}  // namespace vdb_offset
