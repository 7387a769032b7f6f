#pragma once

#include <array>
#include <vector>

#include "vdb_offset/core/vec.h"
#include "vdb_offset/surface/surface.h"

namespace vdb_offset {

/// A closed loop of three free edges.
struct SmallHole {
  std::array<Vec3, 3> corners_world;
  bool is_slit = false;  ///< without area: one point lies on the edge between the two others
};

/// Free edges on no boundary, where the wall does not taper off: columns splay there.
struct SplayedEdges {
  int edges = 0;                         ///< on both sides of a wall with layers on both
  std::array<Vec3, 2> first_world = {};  ///< ends of the first
  std::vector<SmallHole> small_holes{};  ///< that they enclose, each once; none of a flat surface
};

/// Cost  O(n log n) in the number of free edges.
SplayedEdges splayed_edges(const Surface& surface);

}  // namespace vdb_offset
