#pragma once

#include "vdb_offset/core/vec.h"
#include "vdb_offset/march/march.h"
#include "vdb_offset/surface/surface.h"

namespace vdb_offset {

/// Which way columns lean, so that layers fan out beyond the free edges on no boundary: for each
/// node a vector within the wall, away from it at the edges nearby, as long as the tangent of the
/// angle. Empty if there is no such edge, or `options.splay` is 0.
/// Cost  n log n in the nodes within kSplayReach distances of free edges.
Vec3List lean(const Surface& surface, const MarchOptions& options, double distance_world);

}  // namespace vdb_offset
