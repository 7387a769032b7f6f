#pragma once

#include <span>
#include <vector>

#include "vdb_offset/core/vec.h"
#include "vdb_offset/surface/wall.h"

namespace vdb_offset {

/// Exact distances along one column after the other; one for each thread. It remembers what was
/// nearest last, which bounds the next search, and the triangles that the column stands on, whose
/// distance is never below the true one and nearly always equal to it.
class WallSearch {
 public:
  explicit WallSearch(const Wall& wall) : wall_(wall) {}

  /// Start on the column whose foot the triangles `own` share.
  void begin(std::span<const int> own);

  /// Nearest place on the whole wall.
  WallPoint nearest(const Vec3& point_world);

  /// Nearest place on the column's own triangles: an upper bound of the true distance.
  WallPoint nearest_own(const Vec3& point_world) const;

 private:
  const Wall& wall_;
  std::vector<int> own_;
  int last_ = -1;
};

}  // namespace vdb_offset
