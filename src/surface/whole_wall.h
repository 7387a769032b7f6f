#pragma once

#include <optional>
#include <vector>

#include "surface/find_boundaries.h"

namespace vdb_offset {

/// A surface with the parts of the wall that have no layers.
struct WholeWall {
  Patches patches;  ///< oriented; the surface's own first
  std::vector<std::vector<int>> nodes;
  Vec3List nodes_world;
  Topology topology;
  std::vector<int> node_of;  ///< of each node of the surface

  OpenSurface open(bool is_flat) { return {{patches, nodes}, nodes_world, topology, is_flat}; }
};

/// None where there are no such parts, or where all of it together is no surface.
std::optional<WholeWall> whole_wall(const OpenSurface& surface, const SurfaceOptions& options,
                                    double width_world);

}  // namespace vdb_offset
