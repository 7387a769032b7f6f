#pragma once

#include "console.h"
#include "vdb_offset/surface/surface.h"

namespace vdb_offset::command {

/// What the free edges end on, and what may be a mistake: a boundary that was named and ends none,
/// or that edges miss.
void print_boundaries(const Console& console, const Surface& surface);

}  // namespace vdb_offset::command
