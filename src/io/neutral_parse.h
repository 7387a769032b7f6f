#pragma once

#include <string>
#include <string_view>

#include "vdb_offset/io/neutral_map.h"

namespace vdb_offset {

/// read_neutral_map for a file that is in memory; `name` is for messages.
NeutralMap read_neutral_map_bytes(std::string_view bytes, const std::string& name);

}  // namespace vdb_offset
