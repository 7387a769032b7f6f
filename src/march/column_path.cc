#include "march/column_path.h"

#include <algorithm>

namespace vdb_offset {

std::size_t ColumnPath::segment(double s_world) const {
  const auto after = std::upper_bound(knots_.begin(), knots_.end(), s_world,
                                      [](double s, const Knot& knot) { return s < knot.s_world; });
  const auto n = static_cast<std::size_t>(after - knots_.begin());
  return std::clamp<std::size_t>(n, 1, knots_.size() - 1) - 1;
}

Vec3 ColumnPath::point(double s_world) const {
  if (knots_.size() < 2) return knots_.front().point_world;
  const Knot& a = knots_[segment(s_world)];
  const Knot& b = *(&a + 1);
  const double length = b.s_world - a.s_world;
  const double t = (s_world - a.s_world) / length;
  const double u = 1 - t;
  // Offsets from the start, so that a first cell of 1e-6 keeps its digits.
  return a.point_world + (t * t * (3 - 2 * t)) * (b.point_world - a.point_world) +
         (length * t * u) * (u * a.tangent - t * b.tangent);
}

Vec3 ColumnPath::derivative(double s_world) const {
  if (knots_.size() < 2) return knots_.front().tangent;
  const Knot& a = knots_[segment(s_world)];
  const Knot& b = *(&a + 1);
  const double length = b.s_world - a.s_world;
  const double t = (s_world - a.s_world) / length;
  return (6 * t * (1 - t) / length) * (b.point_world - a.point_world) +
         (1 - t) * (1 - 3 * t) * a.tangent + t * (3 * t - 2) * b.tangent;
}

}  // namespace vdb_offset
