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
  double size;  // longest edge
  double sine;  // of the smallest angle, 0 if an edge has no length
  Vec3 normal;  // not of unit length
};

template <typename Real>
std::array<Real, 3> cast(const Vec3& v) {
  return {static_cast<Real>(v[0]), static_cast<Real>(v[1]), static_cast<Real>(v[2])};
}

TriangleGeometry in_voxels(const ShapeTask& task) {
  const double scale = 1 / task.voxel_world;
  return {scale * task.world.a, scale * task.world.ab, scale * task.world.ac};
}

Measures measure(const TriangleGeometry& corners) {
  const Vec3& ab = corners.ab;
  const Vec3& ac = corners.ac;
  const Vec3 normal = ab.cross(ac);
  std::array<double, 3> length2{ab.squaredNorm(), ac.squaredNorm(), (ac - ab).squaredNorm()};
  std::sort(length2.begin(), length2.end());
  const double longest = std::sqrt(length2[2] * length2[1]);
  const double area = normal.norm();
  return {std::sqrt(length2[2]), longest > 0 && length2[0] > 0 ? area / longest : 0.0, normal};
}

template <typename Real>
TriangleShape<Real> shape_of(const TriangleGeometry& corners, const Measures& m, double reach) {
  TriangleShape<Real> shape;
  shape.a = corners.a;
  const std::array<Vec3, 3> edges{corners.ab, corners.ac, corners.ac - corners.ab};
  const bool flat = m.sine < kFlat;
  const Vec3 normal = flat ? Vec3(Vec3::Zero()) : Vec3(m.normal.normalized());
  for (std::size_t e = 0; e < 3; ++e) {
    const double length2 = edges[e].squaredNorm();
    shape.edge[e] = cast<Real>(edges[e]);
    shape.inverse[e] = static_cast<Real>(length2 > 1e-280 ? 1 / length2 : 0.0);
  }
  const double area2 = m.normal.squaredNorm();
  const double inverse_area2 = flat ? 0.0 : 1 / area2;
  shape.gram = {static_cast<Real>(corners.ac.squaredNorm() * inverse_area2),
                static_cast<Real>(corners.ab.dot(corners.ac) * inverse_area2),
                static_cast<Real>(corners.ab.squaredNorm() * inverse_area2)};
  shape.normal = cast<Real>(normal);
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
