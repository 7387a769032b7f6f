#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace vdb_offset {

bool is_gzip(std::string_view bytes);

/// Unpack what gzip packed, of one or several members. `name` is for messages. Throws IoError for
/// damaged data, LimitError for what would be larger than `limit` bytes.
std::string unpacked(std::string_view bytes, const std::string& name, std::size_t limit);

}  // namespace vdb_offset
