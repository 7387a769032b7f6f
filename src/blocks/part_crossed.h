#pragma once

#include <array>
#include <utility>
#include <vector>

#include "blocks/window.h"
#include "vdb_offset/blocks/multi_block.h"
#include "vdb_offset/surface/surface.h"

namespace vdb_offset {

/// Cells that cross those over other faces (see `check_crossings`): the nodes that they stand over,
/// -1 for none, and the level below. Each once, in order.
std::vector<std::pair<std::array<int, 4>, int>> crossed_cells(const Surface& surface,
                                                              const MultiBlock& mesh);

/// Lowers columns of cells that cross others, and neighbours' with them so that heights do not
/// step, until none crosses: columns that were moved can end beyond the bisector of a corner.
/// Returns how many, counted each time.
int part_crossed(const Surface& surface, const ColumnGraph& graph, MultiBlock& mesh);

}  // namespace vdb_offset
