#pragma once

#include <Eigen/Core>
#include <vector>

namespace vdb_offset {

/// A point or direction in world space.
using Vec3 = Eigen::Vector3d;
using Vec3List = std::vector<Vec3>;

/// An axis-aligned box, world units; empty until the first `add`.
struct Box {
  Vec3 lo = Vec3::Constant(1e300);
  Vec3 hi = Vec3::Constant(-1e300);

  void add(const Vec3& p) {
    lo = lo.cwiseMin(p);
    hi = hi.cwiseMax(p);
  }
  void add(const Box& other) {
    lo = lo.cwiseMin(other.lo);
    hi = hi.cwiseMax(other.hi);
  }
  bool empty() const { return lo.x() > hi.x(); }
  /// Length of the diagonal, 0 when empty.
  double size() const { return empty() ? 0.0 : (hi - lo).norm(); }
};

}  // namespace vdb_offset
