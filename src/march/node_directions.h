#pragma once

#include <vector>

#include "vdb_offset/core/vec.h"
#include "vdb_offset/surface/wall.h"

namespace vdb_offset {

/// Which way out of each wall vertex, and how fine the wall is there.
struct NodeDirections {
  Vec3List direction;  ///< unit; angle-weighted mean of the normals, or the one that sees all of
                       ///< them best
  std::vector<double> spacing_world;  ///< shortest edge at the vertex
};

NodeDirections node_directions(const Wall& wall, int nodes);

}  // namespace vdb_offset
