#pragma once

#include <span>
#include <vector>

#include "vdb_offset/core/vec.h"
#include "vdb_offset/surface/boundary.h"
#include "vdb_offset/surface/wall.h"

namespace vdb_offset {

/// Exact distances to the wall and its mirror images, along one column after the other; one for
/// each thread. It remembers what was nearest last, which bounds the next search, and the triangles
/// that the column stands on, whose distance is never below the true one and nearly always equal to
/// it.
class WallSearch {
 public:
  /// `boundaries` may be null.
  WallSearch(const Wall& wall, const Boundaries* boundaries)
      : wall_(wall), boundaries_(boundaries) {}

  /// Start on the column whose foot the triangles `own` share.
  void begin(std::span<const int> own);

  /// Nearest place on the whole wall, or on its image where the point lies beyond a boundary.
  WallPoint nearest(const Vec3& point_world);

  /// Nearest place on the column's own triangles: an upper bound of the true distance.
  WallPoint nearest_own(const Vec3& point_world) const;
  /// Its distance alone.
  double distance_own(const Vec3& point_world) const;

  /// Whether nothing of the wall is within a distance: cheaper than what is nearest.
  bool is_clear(const Vec3& point_world, double distance_world) const;

 private:
  WallPoint nearest_in_domain(const Vec3& point_world);

  const Wall& wall_;
  const Boundaries* boundaries_;
  std::vector<int> own_;
  int last_ = -1;
};

}  // namespace vdb_offset
