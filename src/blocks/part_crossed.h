#pragma once

#include <array>
#include <utility>
#include <vector>

#include "blocks/window.h"
#include "vdb_offset/blocks/multi_block.h"
#include "vdb_offset/surface/surface.h"

namespace vdb_offset {

/// Of each two stacks that cross (see `check_crossings`) the lowest cells that do: the nodes that
/// they stand over, -1 for none, and the level below. Each once, in order. Without those over a
/// wall that crosses itself, which do at any height.
std::vector<std::pair<std::array<int, 4>, int>> lowest_crossed(const Surface& surface,
                                                               const MultiBlock& mesh);

/// Lowers columns of cells that cross others, and neighbours' with them so that heights do not
/// step, until none of `lowest_crossed` is left or they become no fewer: columns that were moved
/// can end beyond the bisector of a corner. Returns how many, counted each time.
int part_crossed(const Surface& surface, const ColumnGraph& graph, MultiBlock& mesh);

}  // namespace vdb_offset
