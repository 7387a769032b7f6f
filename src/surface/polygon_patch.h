#pragma once

#include <vector>

#include "vdb_offset/surface/patch.h"

namespace vdb_offset {

/// Makes a patch of polygons one of its nodes: each is one point, in the order of the points that
/// they come from; faces that welding has left less than three corners are dropped; and finds its
/// rim. `nodes`: of each point, kept in step.
void settle_polygons(Patch& patch, std::vector<int>& nodes);

}  // namespace vdb_offset
