#pragma once

#include <vector>

#include "core/grading.h"
#include "vdb_offset/surface/surface.h"

namespace vdb_offset {

/// Neighbours of each node along grid lines.
Links links_of(const Surface& surface);

/// The shortest way along grid lines to a node.
struct Way {
  int node;
  int from;  ///< where it begins
  double length_world;
};
/// From some nodes to all that are nearer than `reach_world`, nearest first. Cost n log n in those.
std::vector<Way> ways_from(const Links& links, const std::vector<int>& nodes, double reach_world);

}  // namespace vdb_offset
