#pragma once

#include <vector>

#include "vdb_offset/surface/patch.h"
#include "vdb_offset/surface/topology.h"

namespace vdb_offset {

/// Vertices and edges of oriented patches from the nodes of their sides.
/// Throws InputError where more than two sides share an edge.
Topology build_topology(const Patches& patches, const std::vector<std::vector<int>>& nodes);

}  // namespace vdb_offset
