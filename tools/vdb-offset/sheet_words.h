#pragma once

#include <string>

#include "vdb_offset/surface/surface.h"

namespace vdb_offset::command {

/// Open parts within closed ones or standing on them, and what layers do there; empty: there are
/// none.
std::string sheets_in_words(const Surface& surface);

}  // namespace vdb_offset::command
