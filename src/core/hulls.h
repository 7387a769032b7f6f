#pragma once

#include <span>

#include "vdb_offset/core/vec.h"

namespace vdb_offset {

/// Nearest places of the convex hulls of two sets of points, world.
struct HullGap {
  double distance_world = 0;  ///< 0 where the hulls meet
  Vec3 first = Vec3::Zero();
  Vec3 second = Vec3::Zero();
};

/// Accuracy  the distance to 1e-9 of itself, or 1e-10 of the sets' size; below that hulls meet.
/// Cost      about a microsecond for sets of ten points.
HullGap hull_gap(std::span<const Vec3> first, std::span<const Vec3> second);

/// Whether hulls do not meet: the same, but done as soon as a plane between them is found.
bool are_apart(std::span<const Vec3> first, std::span<const Vec3> second);

}  // namespace vdb_offset
