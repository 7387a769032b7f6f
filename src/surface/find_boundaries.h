#pragma once

#include <array>
#include <memory>
#include <vector>

#include "surface/orient.h"
#include "vdb_offset/surface/boundary.h"
#include "vdb_offset/surface/surface.h"

namespace vdb_offset {

/// Where an oriented surface is open.
struct OpenSurface {
  NodeGrids grids;
  Vec3List& nodes_world;  ///< those on a boundary are put on it exactly
  const Topology& topology;
  bool is_flat = false;  ///< curves, as strips along z
};

/// What the free edges of a surface end on.
struct Ends {
  Boundaries boundaries;
  std::vector<BoundarySet> on;  ///< of each node
  std::vector<int> tapers;      ///< nodes where the wall goes on smoothly without layers
  int taper_edges = 0;          ///< that they are of
  std::vector<std::array<Vec3, 2>> open_tails;  ///< see SurfaceReport
  std::vector<MissedEdges> missed;
  double moved_max_world = 0;  ///< farthest that a node moved onto its boundary
};

/// Boundaries as named, then, unless told otherwise, planes through the free edges that are left.
/// Throws InputError: see SurfaceOptions.
Ends find_boundaries(const OpenSurface& surface, const SurfaceOptions& options);

/// "patch 2 'tip', side imax, points 3 to 9".
std::string side_name(const Patches& patches, const SideRange& range);

}  // namespace vdb_offset
