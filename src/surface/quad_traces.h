#pragma once

#include "surface/quad_edges.h"

namespace vdb_offset {

/// Cuts from the points where borders leave more than two quads between them, straight on, until
/// every patch is a rectangle, a tube or a torus.
void trace_lines(const QuadEdges& edges, QuadCuts& cuts);

/// Cuts tubes and tori open, so that all patches are rectangles. Returns the number of cuts.
int cut_seams(const QuadEdges& edges, QuadCuts& cuts);

}  // namespace vdb_offset
