#include "rasterize/triangle_shape.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>

#include "rasterize/tiles.h"

namespace vdb_offset {

namespace {

// Triangles beyond these, in voxels and sines of angles, are filtered in double precision.
constexpr double kLargest = 24;
constexpr double kSmallest = 1e-9;
constexpr double kThinnest = 0.01;
// Below this sine a triangle is no more than its edges.
constexpr double kFlat = 1e-6;
// Roundings that add up in one distance.
constexpr double kRoundings = 32;

struct Measures {
  std::array<double, 3> length2;  // of ab, ac, bc
  double size;                    // longest edge
  double area;                    // twice the triangle's
  double sine;                    // of the smallest angle, 0 if an edge has no length
  Vec3 normal;                    // as long as `area`
};

template <typename Real>
std::array<Real, 3> cast(const Vec3& v) {
  return {static_cast<Real>(v[0]), static_cast<Real>(v[1]), static_cast<Real>(v[2])};
}

TriangleGeometry in_voxels(const ShapeTask& task) {
  const double scale = 1 / task.voxel_world;
  return {scale * task.world.a, scale * task.world.ab, scale * task.world.ac};
}

/// Sorted by least and most: branches would be guessed wrong.
Measures measure(const TriangleGeometry& corners) {
  const Vec3& ab = corners.ab;
  const Vec3& ac = corners.ac;
  Measures m{{ab.squaredNorm(), ac.squaredNorm(), (ac - ab).squaredNorm()}, 0, 0, 0, ab.cross(ac)};
  const auto [x, y, z] = m.length2;
  const double least = std::min(std::min(x, y), z);
  const double most = std::max(std::max(x, y), z);
  const double middle = std::max(std::min(x, y), std::min(std::max(x, y), z));
  const double longest = std::sqrt(most * middle);
  m.size = std::sqrt(most);
  m.area = m.normal.norm();
  m.sine = longest > 0 && least > 0 ? m.area / longest : 0.0;
  return m;
}

template <typename Real>
TriangleShape<Real> shape_of(const TriangleGeometry& corners, const Measures& m, double reach) {
  TriangleShape<Real> shape;
  shape.a = corners.a;
  const std::array<Vec3, 3> edges{corners.ab, corners.ac, corners.ac - corners.ab};
  const bool flat = m.sine < kFlat;
  for (std::size_t e = 0; e < 3; ++e) {
    shape.edge[e] = cast<Real>(edges[e]);
    shape.inverse[e] = static_cast<Real>(m.length2[e] > 1e-280 ? 1 / m.length2[e] : 0.0);
  }
  const double inverse_area = flat ? 0.0 : 1 / m.area;
  const double inverse_area2 = inverse_area * inverse_area;
  shape.gram = {static_cast<Real>(m.length2[1] * inverse_area2),
                static_cast<Real>(corners.ab.dot(corners.ac) * inverse_area2),
                static_cast<Real>(m.length2[0] * inverse_area2)};
  shape.normal = cast<Real>(Vec3(inverse_area * m.normal));
  shape.size = static_cast<Real>(m.size);
  constexpr double kEpsilon = std::numeric_limits<Real>::epsilon();
  const double blur = kRoundings * kEpsilon / (flat ? 1.0 : m.sine);
  const double neglected = flat ? 2 * kFlat * m.size : 0.0;
  const double error = (0.5 * (kTile - 1) + reach + m.size) * blur + neglected + 1e-6;
  shape.lo = cast<Real>(corners.ab.cwiseMin(corners.ac).cwiseMin(0.0).array() - error);
  shape.hi = cast<Real>(corners.ab.cwiseMax(corners.ac).cwiseMax(0.0).array() + error);
  // (d + e)^2 - d^2 for d within reach; the last term covers the rounding of bounds to float.
  shape.slack = static_cast<float>(2 * reach * error + error * error + 1e-6 * reach * reach);
  return shape;
}

}  // namespace

TriangleShape<float> small_shape(const ShapeTask& task) {
  const TriangleGeometry corners = in_voxels(task);
  const Measures m = measure(corners);
  const bool usual = m.size < kLargest && m.size > kSmallest && m.sine > kThinnest;
  return usual ? shape_of<float>(corners, m, task.reach_voxels) : TriangleShape<float>{};
}

TriangleShape<double> any_shape(const ShapeTask& task) {
  const TriangleGeometry corners = in_voxels(task);
  return shape_of<double>(corners, measure(corners), task.reach_voxels);
}

}  // namespace vdb_offset
