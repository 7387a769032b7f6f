#pragma once

#include <vector>

#include "blocks/window.h"
#include "vdb_offset/march/march.h"
#include "vdb_offset/surface/surface.h"

namespace vdb_offset {

/// Height of a column whose layers are all as high as the first is asked to be: where it is lower
/// the first is too, so that it is the last to be lowered.
double first_cells(const Layers& layers, std::size_t node);

/// Lowers columns to at most `most_world`, by node, along themselves, and neighbours' with them so
/// that heights do not step for that reason. Returns how many.
int lower_columns(const Surface& surface, const ColumnGraph& graph,
                  const std::vector<double>& most_world, Layers& layers);

}  // namespace vdb_offset
