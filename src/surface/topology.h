#pragma once

#include <vector>

#include "vdb_offset/surface/boundary.h"
#include "vdb_offset/surface/patch.h"
#include "vdb_offset/surface/topology.h"

namespace vdb_offset {

/// Vertices and edges of oriented patches from the nodes of their sides; `on`: the boundaries of
/// each node, empty for none. Throws InputError where more than two sides share an edge.
Topology build_topology(const Patches& patches, const std::vector<std::vector<int>>& nodes,
                        const std::vector<BoundarySet>& on = {});

/// Points along a side, and the index within the patch of point `s` along it.
int side_points(const Patch& patch, Side side);
int side_point(const Patch& patch, Side side, int s);

}  // namespace vdb_offset
