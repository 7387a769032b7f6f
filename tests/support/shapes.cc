#include "support/shapes.h"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>

namespace vdb_offset::test {

namespace {

using LongVec = Eigen::Matrix<long double, 3, 1>;

long double segment_distance(const LongVec& a, const LongVec& b, const LongVec& p) {
  const LongVec ab = b - a;
  const long double length2 = ab.squaredNorm();
  long double t = length2 > 0 ? ab.dot(p - a) / length2 : 0;
  t = std::clamp<long double>(t, 0, 1);
  return (a + t * ab - p).norm();
}

long double triangle_distance(const std::array<LongVec, 3>& v, const LongVec& p) {
  long double best = std::min({segment_distance(v[0], v[1], p), segment_distance(v[1], v[2], p),
                               segment_distance(v[2], v[0], p)});
  const LongVec normal = (v[1] - v[0]).cross(v[2] - v[0]);
  if (!(normal.squaredNorm() > 0)) return best;
  bool inside = true;
  for (std::size_t s = 0; s < 3; ++s) {
    inside = inside && normal.cross(v[(s + 1) % 3] - v[s]).dot(p - v[s]) >= 0;
  }
  return inside ? std::min(best, std::abs(normal.normalized().dot(p - v[0]))) : best;
}

}  // namespace

Patch make_patch(const std::string& name, int ni, int nj,
                 const std::function<Vec3(double, double)>& point) {
  Patch patch{name, "", ni, nj, {}};
  for (int j = 0; j < nj; ++j) {
    for (int i = 0; i < ni; ++i) {
      patch.points_world.push_back(
          point(static_cast<double>(i) / (ni - 1), static_cast<double>(j) / (nj - 1)));
    }
  }
  return patch;
}

Patch rectangle(const std::string& name, std::array<int, 2> points, const Vec3& corner,
                const std::array<Vec3, 2>& sides) {
  return make_patch(name, points[0], points[1],
                    [&](double u, double v) { return Vec3(corner + u * sides[0] + v * sides[1]); });
}

Patches plates(int points, double gap) {
  const Vec3 x = Vec3::UnitX();
  const Vec3 y = Vec3::UnitY();
  return {rectangle("lower", {points, points}, Vec3::Zero(), {x, y}),
          rectangle("upper", {points, points}, Vec3(0, 0, gap), {y, x})};
}

Patches wedge(int points, double angle) {
  const Vec3 y = Vec3::UnitY();
  const Vec3 other(std::cos(angle), 0, std::sin(angle));
  return {rectangle("floor", {points, points}, Vec3::Zero(), {Vec3::UnitX(), y}),
          rectangle("ramp", {points, points}, Vec3::Zero(), {y, other})};
}

Patches wall_at_plane(std::array<int, 2> points, double angle) {
  const Vec3 along(std::sin(angle), 0, std::cos(angle));
  return {rectangle("wall", points, Vec3::Zero(), {along, Vec3::UnitY()})};
}

Patches mapped(Patches patches, const Eigen::Matrix3d& map, const Vec3& shift) {
  for (Patch& patch : patches) {
    for (Vec3& p : patch.points_world) p = map * p + shift;
    if (map.determinant() > 0) continue;
    for (int j = 0; j < patch.nj; ++j) {
      const auto row = patch.points_world.begin() + static_cast<std::ptrdiff_t>(j) * patch.ni;
      std::reverse(row, row + patch.ni);
    }
  }
  return patches;
}

Vec3 random_point(std::mt19937_64& random, const Box& box) {
  std::uniform_real_distribution<double> unit(0, 1);
  const Vec3 f(unit(random), unit(random), unit(random));
  return box.lo + f.cwiseProduct(box.hi - box.lo);
}

namespace {

std::array<LongVec, 3> corners_of(const Wall& wall, const Wall::Triangle& t) {
  std::array<LongVec, 3> v;
  for (std::size_t c = 0; c < 3; ++c) {
    v[c] = wall.vertices()[static_cast<std::size_t>(t[c])].cast<long double>();
  }
  return v;
}

}  // namespace

BruteForce::BruteForce(const Wall& wall) : wall_(wall) {
  for (const auto& t : wall.triangles()) {
    const auto v = corners_of(wall, t);
    const Vec3 centre = ((v[0] + v[1] + v[2]) / 3).cast<double>();
    double radius = 0;
    for (const LongVec& p : v) radius = std::max(radius, (p.cast<double>() - centre).norm());
    balls_.push_back({centre, radius * (1 + 1e-9)});
  }
}

double BruteForce::distance(const Vec3& query) const {
  long double best = std::numeric_limits<long double>::infinity();
  for (std::size_t t = 0; t < balls_.size(); ++t) {
    const double least = (query - balls_[t].centre).norm() - balls_[t].radius;
    if (least > best * (1 + 1e-9L)) continue;
    const auto v = corners_of(wall_, wall_.triangles()[t]);
    best = std::min(best, triangle_distance(v, query.cast<long double>()));
  }
  return static_cast<double>(best);
}

double brute_force_distance(const Wall& wall, const Vec3& query) {
  long double best = std::numeric_limits<long double>::infinity();
  for (const auto& t : wall.triangles()) {
    std::array<LongVec, 3> v;
    for (std::size_t c = 0; c < 3; ++c) {
      v[c] = wall.vertices()[static_cast<std::size_t>(t[c])].cast<long double>();
    }
    best = std::min(best, triangle_distance(v, query.cast<long double>()));
  }
  return static_cast<double>(best);
}

std::optional<std::string> shared_data() {
  const char* given = std::getenv("VDB_OFFSET_SHARED_DATA");
  const std::filesystem::path folder =
      given != nullptr ? std::filesystem::path(given)
                       : std::filesystem::path(VDB_OFFSET_SOURCE_DIR) / ".." / "shared" / "data";
  if (!std::filesystem::is_directory(folder)) return std::nullopt;
  return folder.string();
}

}  // namespace vdb_offset::test
