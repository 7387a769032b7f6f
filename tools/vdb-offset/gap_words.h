#pragma once

#include <string>

#include "vdb_offset/surface/surface.h"

namespace vdb_offset::command {

/// Free edges that a larger --weld than `weld` would join to others, and which; empty: there are
/// none.
std::string gaps_in_words(const Surface& surface, double weld);

}  // namespace vdb_offset::command
