#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include "vdb_offset/core/vec.h"

namespace vdb_offset {

/// Tells two sides of something thin from what lies beside each other, at points near each other.
class FacingSides {
 public:
  /// Four points, by their numbers; one of them may be there twice.
  using Cell = std::array<int, 4>;
  /// Whether all cells go counter-clockwise seen from one side of the surface: the two sides of
  /// something thin do not go the same way then, but a surface that is there twice does.
  enum class Oriented { No, Yes };

  /// The points are referred to, not copied. Cost O(n).
  FacingSides(std::vector<Cell> cells, const Vec3List& points_world, Oriented oriented);

  /// Whether cells at one point lie over those at the other, no much farther away than these two
  /// are: sides of something thin, unless it narrows to an edge there. Any thread.
  bool face_each_other(int a, int b) const;

 private:
  std::span<const std::size_t> cells_at(int point) const;
  const Vec3& position(int point) const { return points_world_[static_cast<std::size_t>(point)]; }
  struct Place {
    Vec3 point_world, normal;
  };
  Place nearest_at(int point, const Vec3& to_world) const;
  bool lies_over(int point, int other) const;

  const Vec3List& points_world_;
  std::vector<Cell> cells_;
  Oriented oriented_;
  std::vector<std::size_t> at_;
  std::vector<std::size_t> first_;  // in at_, of each point, and the end
};

}  // namespace vdb_offset
