#pragma once

#include <vector>

#include "surface/quad_edges.h"

namespace vdb_offset {

/// The half-edges along a side of a rectangular patch, from its corner half-edge to the next.
std::vector<int> side_from(const QuadEdges& edges, const QuadCuts& cuts, int corner);

/// Gives up borders where patches make up a larger rectangle, the longest first. All patches must
/// be rectangles, and stay so.
void merge_patches(const QuadEdges& edges, QuadCuts& cuts);

}  // namespace vdb_offset
