#pragma once

#include <array>
#include <span>
#include <vector>

#include "vdb_offset/core/vec.h"
#include "vdb_offset/surface/wall.h"

namespace vdb_offset {

/// An edge of a wall's triangles that goes through another of them.
struct EdgeCrossing {
  std::array<int, 2> vertices;  ///< of the edge
  int triangle = -1;            ///< that it is one of
  int through = -1;             ///< the first that it is found to go through
  Vec3 place_world = Vec3::Zero();
};

/// One for each edge that crosses a triangle it shares no vertex with, in order of the triangles.
/// `part` of each vertex, one for all of a triangle: those of unlike parts alone; none: all.
/// Cost     a query of the hierarchy for each edge, side by side.
/// Threads  the same for any count.
std::vector<EdgeCrossing> edge_crossings(const Wall& wall, std::span<const int> part = {});

}  // namespace vdb_offset
