#include "vdb_offset/surface/splayed_edges.h"

#include <doctest/doctest.h>

#include <Eigen/Geometry>
#include <numbers>

#include "support/polygons.h"
#include "support/shapes.h"

using namespace vdb_offset;
using namespace vdb_offset::test;

namespace {

/// The cube [0, 1]^3 in triangles, two for each of n x n squares of a face, normals outward; every
/// point once, by its place.
Patch cube(int n) {
  Patch patch;
  patch.name = "cube";
  std::map<std::array<int, 3>, int> points;
  const auto point = [&](const std::array<int, 3>& at) {
    const auto [found, is_new] = points.try_emplace(at, static_cast<int>(points.size()));
    if (is_new) patch.points_world.push_back(Vec3(at[0], at[1], at[2]) / n);
    return found->second;
  };
  for (std::size_t axis = 0; axis < 3; ++axis) {
    for (const int end : {0, n}) {
      for (int cell = 0; cell < n * n; ++cell) {
        std::array<int, 4> q{};
        for (std::size_t c = 0; c < 4; ++c) {
          std::array<int, 3> at{};
          const std::size_t turn = end == n ? c : 3 - c;
          at[axis] = end;
          at[(axis + 1) % 3] = cell % n + (turn == 1 || turn == 2 ? 1 : 0);
          at[(axis + 2) % 3] = cell / n + (turn >= 2 ? 1 : 0);
          q[c] = point(at);
        }
        patch.faces.insert(patch.faces.end(), {{q[0], q[1], q[2], q[2]}, {q[0], q[2], q[3], q[3]}});
      }
    }
  }
  patch.ni = static_cast<int>(patch.points_world.size());
  return patch;
}

/// A point in the middle of one side of a triangle, which that triangle alone uses.
Patch with_junction(Patch patch, std::size_t face, std::size_t side) {
  const std::array<int, 4> f = patch.faces[face];
  const std::array<int, 3> t{f[side], f[(side + 1) % 3], f[(side + 2) % 3]};
  const auto at = [&](int n) { return patch.points_world[static_cast<std::size_t>(n)]; };
  const Vec3 middle = 0.5 * (at(t[0]) + at(t[1]));
  patch.points_world.push_back(middle);
  patch.faces[face] = {t[0], patch.ni, t[2], t[2]};
  patch.faces.push_back({patch.ni, t[1], t[2], t[2]});
  ++patch.ni;
  return patch;
}

Patch turned(Patch patch, const Eigen::Matrix3d& turn) {
  for (Vec3& p : patch.points_world) p = turn * p;
  return patch;
}

}  // namespace

TEST_CASE("splayed edges: any one triangle missing of a cube is a hole in it, and on no boundary") {
  const Patch whole = cube(3);
  for (std::size_t f = 0; f < whole.faces.size(); ++f) {
    Patch patch = whole;
    patch.faces.erase(patch.faces.begin() + static_cast<std::ptrdiff_t>(f));
    const Surface surface = build_surface({patch});
    const SplayedEdges splayed = splayed_edges(surface);
    CAPTURE(f);
    CHECK(surface.boundaries == nullptr);
    CHECK(splayed.edges == 3);
    REQUIRE(splayed.small_holes.size() == 1);
    CHECK_FALSE(splayed.small_holes[0].is_slit);
    Vec3 missing = Vec3::Zero();
    Vec3 named = Vec3::Zero();
    for (std::size_t c = 0; c < 3; ++c) {
      missing += whole.points_world[static_cast<std::size_t>(whole.faces[f][c])] / 3;
      named += splayed.small_holes[0].corners_world[c] / 3;
    }
    CHECK((missing - named).norm() < 1e-15);
  }
}

TEST_CASE("splayed edges: a T-junction is a slit, and on no boundary, however the cube is turned") {
  const Patch whole = cube(2);
  // At 45 degrees edges of the cube are ridges that stand up alike from the plane above them.
  const std::array<Eigen::Matrix3d, 2> turns{
      Eigen::Matrix3d::Identity(),
      Eigen::AngleAxisd(std::numbers::pi / 4, Vec3::UnitX()).toRotationMatrix()};
  for (const Eigen::Matrix3d& turn : turns) {
    for (std::size_t n = 0; n < 3 * whole.faces.size(); ++n) {
      const Surface surface = build_surface({turned(with_junction(whole, n / 3, n % 3), turn)});
      const SplayedEdges splayed = splayed_edges(surface);
      CAPTURE(n);
      CHECK(surface.boundaries == nullptr);
      CHECK(splayed.edges == 3);
      REQUIRE(splayed.small_holes.size() == 1);
      CHECK(splayed.small_holes[0].is_slit);
    }
  }
}

TEST_CASE("splayed edges: an open cube ends on a plane, and a triangle alone is no hole") {
  Patch open = cube(3);
  open.faces.resize(open.faces.size() - 2 * 3 * 3);
  const Surface surface = build_surface({open});
  REQUIRE(surface.boundaries != nullptr);
  CHECK(surface.free_edges_on(0) == 4 * 3);
  CHECK(splayed_edges(surface).edges == 0);

  Patch one;
  one.points_world = {Vec3::Zero(), Vec3::UnitX(), Vec3::UnitY()};
  one.faces = {{0, 1, 2, 2}};
  one.ni = 3;
  const SplayedEdges rim = splayed_edges(build_surface({one}));
  CHECK(rim.edges == 3);
  CHECK(rim.small_holes.empty());
}
