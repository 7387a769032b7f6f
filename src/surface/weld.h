#pragma once

#include <functional>
#include <vector>

#include "vdb_offset/core/progress.h"
#include "vdb_offset/core/vec.h"
#include "vdb_offset/surface/patch.h"

namespace vdb_offset {

struct Welding {
  Vec3List nodes_world;                       ///< the first point that each node was welded from
  std::vector<std::vector<int>> patch_nodes;  ///< for each patch, the node of each point
  double moved_max_world = 0;                 ///< farthest point from its node
};

/// Of a tolerance: points nearer than this part of it are one, on whatever sides they are, since
/// numbers of files are off by as much.
constexpr double kWeldNoise = 1e-3;

/// Of two points by their indices; empty: of none.
using KeepApart = std::function<bool(int, int)>;

/// For each point the lowest index of the points that become one node with it; `spacing` is
/// infinite where a point has none. Points near each other are one unless they are kept apart.
std::vector<int> weld_points(const Vec3List& points, const std::vector<double>& spacing,
                             double part, const KeepApart& keeps_apart, const Progress& progress);

/// Make one node of points of a body closer than `part` of the shorter of their local spacings.
/// Local spacing: the shortest grid edge at the point that is more than rounding, 1e-11 of the
/// size, and on no side that is no longer than 3e-7 of its patch: a pole in single precision. Where
/// patches end, points nearer than `kWeldNoise` of `part`, or 3e-7 of the size, are joined first.
/// Two sides of something thin stay apart then: points that the surface goes on around, and on its
/// rims those whose cells face each other. Cost O(n log n), also where many points coincide.
Welding weld(const Patches& patches, double part, const Progress& progress);

}  // namespace vdb_offset
