#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "vdb_offset/core/vec.h"
#include "vdb_offset/surface/boundary.h"

namespace vdb_offset {

/// A straight line of edges.
struct EdgeLine {
  Vec3 point, direction;  // unit length
  std::vector<int> nodes;
};

/// The lines that edges (pairs of nodes) lie on, to a tolerance, up to one more than `most`.
std::vector<EdgeLine> lines_of(const Vec3List& nodes_world,
                               const std::vector<std::array<int, 2>>& edges, std::size_t most,
                               double tolerance_world);

/// The two planes through the axis of a circle that an open chain of points is an arc of, to a
/// tolerance, and through the arc's ends: four points or more, as three always are on a circle.
std::vector<Plane> meridians_of(const Vec3List& points_world, double tolerance_world);

}  // namespace vdb_offset
