#pragma once

#include <vector>

#include "vdb_offset/surface/surface.h"

namespace vdb_offset {

/// By how much a quantity may differ between neighbouring nodes of the wall.
struct Grading {
  double ratio = 1.2;  ///< of the larger to the smaller, above 1
  double slope = 0;    ///< of the difference to the length of the edge between them; 0: any
};

/// Neighbours of each node along grid lines.
struct Links {
  std::vector<std::size_t> first;  ///< of each node, and the end
  std::vector<int> to;
};
Links links_of(const Surface& surface);

/// The shortest way along grid lines to a node.
struct Way {
  int node;
  int from;  ///< where it begins
  double length_world;
};
/// From some nodes to all that are nearer than `reach_world`, nearest first. Cost n log n in those.
std::vector<Way> ways_from(const Surface& surface, const Links& links,
                           const std::vector<int>& nodes, double reach_world);

/// Lowers values until no two neighbours differ by more: the largest such values.
/// In  `values`: one for each node, >= 0; zeros stay, and their neighbours obey the slope alone.
/// Cost  n log n in the nodes.
void grade(const Surface& surface, const Grading& grading, std::vector<double>& values);

}  // namespace vdb_offset
