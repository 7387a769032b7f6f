#pragma once

#include "blocks/window.h"
#include "vdb_offset/blocks/multi_block.h"
#include "vdb_offset/surface/surface.h"

namespace vdb_offset {

/// Cells that were positive may be inverted where columns were lowered beside others that were not:
/// lowers the others to the lowest of their face, and all of it where that is not enough, until
/// none is inverted or nothing is left to lower. Returns how many, counted each time.
int lower_inverted(const Surface& surface, const ColumnGraph& graph, MultiBlock& mesh);

}  // namespace vdb_offset
