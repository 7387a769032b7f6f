#pragma once

#include <array>
#include <cstddef>
#include <span>

#include "rasterize/row_vector.h"
#include "vdb_offset/surface/wall.h"

namespace vdb_offset {

/// Squared distances of places to triangles, one each, eight at a time: those of
/// `Wall::distance2` to some roundings, in a third of its time.
class ExactDistances {
 public:
  /// Gathers a triangle of the wall and a place; not more than kRow before `find`.
  void add(const Wall& wall, int index, const Vec3& place) {
    const TriangleGeometry& triangle = wall.geometry()[static_cast<std::size_t>(index)];
    const std::size_t n = count_++;
    triangles_[n] = index;
    for (std::size_t x = 0; x < 3; ++x) {
      const auto axis = static_cast<Eigen::Index>(x);
      place_[x][n] = place[axis];
      a_[x][n] = triangle.a[axis];
      ab_[x][n] = triangle.ab[axis];
      ac_[x][n] = triangle.ac[axis];
    }
  }
  std::size_t count() const { return count_; }

  /// Those that were gathered, which are then forgotten. World units squared.
  std::span<const double> find(const Wall& wall);

 private:
  using Lane = std::array<double, kRow>;

  std::size_t count_ = 0;
  std::array<int, kRow> triangles_{};
  alignas(64) std::array<Lane, 3> place_{}, a_{}, ab_{}, ac_{};
  alignas(64) Lane distance2_{};
};

}  // namespace vdb_offset
