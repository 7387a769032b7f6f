#include "vdb_offset/surface/fans.h"

#include <doctest/doctest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <set>

#include "support/shapes.h"
#include "vdb_offset/core/error.h"
#include "vdb_offset/surface/example.h"
#include "vdb_offset/surface/surface.h"

using namespace vdb_offset;
using namespace vdb_offset::test;

namespace {

constexpr double kPi = std::numbers::pi;

Surface opened(Patches patches, int fans, MarchSide side = MarchSide::Along) {
  SurfaceOptions options;
  options.fans = fans;
  options.side = side;
  return build_surface(std::move(patches), options);
}

int count(const Surface& surface, EdgeKind kind) {
  return static_cast<int>(std::ranges::count(surface.topology.edges, kind, &Edge::kind));
}

const Vec3& direction(const Surface& surface, int node) {
  return surface.fans.direction[static_cast<std::size_t>(node)];
}

double angle(const Vec3& a, const Vec3& b) { return std::atan2(a.cross(b).norm(), a.dot(b)); }

/// Patches that are fans of N + 1 points across, corners left out.
std::vector<int> fans_of(const Surface& surface) {
  std::vector<int> result;
  for (int p = 0; p < static_cast<int>(surface.patches.size()); ++p) {
    const Patch& patch = surface.patches[static_cast<std::size_t>(p)];
    if (patch.name.starts_with("fan ")) result.push_back(p);
  }
  return result;
}

/// Each row of each fan stands at one place, and turns by `whole` in equal angles, outward.
void check_rows(const Surface& surface, double whole) {
  for (const int fan : fans_of(surface)) {
    CAPTURE(fan);
    const Patch& patch = surface.patches[static_cast<std::size_t>(fan)];
    for (int j = 0; j < patch.nj; ++j) {
      std::set<int> nodes;
      for (int i = 0; i < patch.ni; ++i) {
        const int node = surface.node(fan, i, j);
        nodes.insert(node);
        CHECK(patch.at(i, j) == patch.at(0, j));
        if (i == 0) continue;
        const double step =
            angle(direction(surface, surface.node(fan, i - 1, j)), direction(surface, node));
        CHECK(step == doctest::Approx(whole / (patch.ni - 1)).epsilon(1e-12));
      }
      CHECK(nodes.size() == static_cast<std::size_t>(patch.ni));
    }
    // i x j points outward: right-handed blocks.
    const int row = patch.nj / 2 - (patch.nj == 2 ? 1 : 0);
    const Vec3 across = direction(surface, surface.node(fan, patch.ni - 1, row)) -
                        direction(surface, surface.node(fan, 0, row));
    const Vec3 along = patch.at(0, row + 1) - patch.at(0, row);
    CHECK(across.cross(along).dot(direction(surface, surface.node(fan, 1, row))) > 0);
  }
}

/// The four long sides of a bar of square section along y, open at both ends.
Patches square_tube(int points) {
  const std::array<int, 2> size{points, points};
  return {rectangle("right", size, {1, 0, 0}, {Vec3(0, 1, 0), Vec3(0, 0, 1)}),
          rectangle("top", size, {1, 0, 1}, {Vec3(0, 1, 0), Vec3(-1, 0, 0)}),
          rectangle("left", size, {0, 0, 1}, {Vec3(0, 1, 0), Vec3(0, 0, -1)}),
          rectangle("bottom", size, {0, 0, 0}, {Vec3(0, 1, 0), Vec3(1, 0, 0)})};
}

/// A can: its mantle is one ring, each lid a disc about a pole.
Patches can(int round) {
  const auto rim = [](double u, double r, double z) {
    return u == 1 ? Vec3(r, 0, z) : Vec3(r * std::cos(2 * kPi * u), r * std::sin(2 * kPi * u), z);
  };
  return {make_patch("mantle", round + 1, 5, [&](double u, double v) { return rim(u, 1, v); }),
          make_patch("lid", round + 1, 5, [&](double u, double v) { return rim(u, 1 - v, 1); }),
          make_patch("base", round + 1, 5, [&](double u, double v) { return rim(u, v, 0); })};
}

/// One patch bent along its middle line, upward (a roof) or downward, about the axis y.
Patch bent(int points, double rise) {
  return make_patch("sheet", points, points, [&](double u, double v) {
    return Vec3(2 * u - 1, v, rise * (1 - std::abs(2 * u - 1)));
  });
}

}  // namespace

TEST_CASE("fans: a cube's twelve edges and eight corners open, and nothing is left open") {
  const int n = 9;
  for (const int fans : {2, 4, 6}) {
    CAPTURE(fans);
    const Surface surface = opened(make_example("cube", {.points = n}), fans);
    CHECK(surface.report.fans == 12);
    CHECK(surface.report.fan_corners == 8);
    CHECK(surface.patches.size() == 6 + 12 + 8 * 3);
    CHECK(surface.fans.patches == 12 + 8 * 3);
    CHECK(surface.closed);
    CHECK(count(surface, EdgeKind::Degenerate) == 0);
    CHECK(count(surface, EdgeKind::Free) == 0);
    // Long sides of fans; their ends, which two patches of a corner share; a corner's own.
    CHECK(count(surface, EdgeKind::Interface) == 12 * 2 + 24 * 2 + 8 * 3);
    const int half = fans / 2;
    const int corner = 3 * half * (half + 1) + 1;
    CHECK(surface.nodes_world.size() ==
          static_cast<std::size_t>(6 * (n - 2) * (n - 2) + 12 * (n - 2) * (fans + 1) + 8 * corner));
    CHECK(surface.wall_nodes == 6 * (n - 1) * (n - 1) + 2);
    CHECK(surface.wall->area() == doctest::Approx(6).epsilon(1e-12));
    check_rows(surface, kPi / 2);
  }
}

TEST_CASE("fans: the ways out of a fan begin and end at the normals of the two sides") {
  const Surface surface = opened(make_example("cube", {.points = 5}), 4);
  for (const int fan : fans_of(surface)) {
    const Patch& patch = surface.patches[static_cast<std::size_t>(fan)];
    for (int j = 0; j < patch.nj; ++j) {
      for (const int i : {0, patch.ni - 1}) {
        // A face's normal is along an axis, to rounding, and points away from the centre.
        const Vec3& out = direction(surface, surface.node(fan, i, j));
        CHECK(out.cwiseAbs().maxCoeff() == doctest::Approx(1).epsilon(1e-14));
        const Vec3 centre = 0.5 * (surface.wall->bounds().lo + surface.wall->bounds().hi);
        CHECK(out.dot(patch.at(i, j) - centre) == doctest::Approx(0.5).epsilon(1e-12));
      }
    }
  }
}

TEST_CASE("fans: a corner's patches cover the three normals' solid angle once, outward") {
  const Surface surface = opened(make_example("cube", {.points = 5}), 6);
  double solid = 0;
  for (int p = 0; p < static_cast<int>(surface.patches.size()); ++p) {
    const Patch& patch = surface.patches[static_cast<std::size_t>(p)];
    if (!patch.name.starts_with("corner ")) continue;
    CHECK(patch.ni == 4);
    CHECK(patch.nj == 4);
    const auto way = [&](int i, int j) { return direction(surface, surface.node(p, i, j)); };
    const auto add = [&](const Vec3& a, const Vec3& b, const Vec3& c) {
      // van Oosterom and Strackee, The solid angle of a plane triangle, 1983.
      const double volume = a.cross(b).dot(c);
      CHECK(volume > 0);
      solid += 2 * std::atan2(volume, 1 + a.dot(b) + b.dot(c) + c.dot(a));
    };
    for (int j = 0; j + 1 < patch.nj; ++j) {
      for (int i = 0; i + 1 < patch.ni; ++i) {
        add(way(i, j), way(i + 1, j), way(i + 1, j + 1));
        add(way(i, j), way(i + 1, j + 1), way(i, j + 1));
      }
    }
  }
  CHECK(solid == doctest::Approx(4 * kPi).epsilon(1e-12));
}

TEST_CASE("fans: with an odd number corners stay closed, and the angle grows from them") {
  const int n = 13;
  const int fans = 3;
  const Surface surface = opened(make_example("cube", {.points = n}), fans);
  CHECK(surface.report.fans == 12);
  CHECK(surface.report.fan_corners == 0);
  CHECK(surface.closed);
  CHECK(count(surface, EdgeKind::Degenerate) == 24);
  CHECK(surface.nodes_world.size() ==
        static_cast<std::size_t>(6 * (n - 2) * (n - 2) + 12 * (n - 2) * (fans + 1) + 8));
  for (const int fan : fans_of(surface)) {
    for (int j = 0; j < n; ++j) {
      const int steps = std::min(j, n - 1 - j);
      const int first = surface.node(fan, 0, j);
      const int last = surface.node(fan, fans, j);
      if (steps == 0) {
        CHECK(first == last);
        CHECK(direction(surface, first).isZero());
        continue;
      }
      const double part = std::min(1.0, static_cast<double>(steps) / kFanClosing);
      CHECK(angle(direction(surface, first), direction(surface, last)) ==
            doctest::Approx(part * kPi / 2).epsilon(1e-12));
    }
  }
}

TEST_CASE("fans: a fan that ends on a boundary plane stays open there, within the plane") {
  const int n = 7;
  const Surface surface = opened(square_tube(n), 4);
  REQUIRE(surface.boundaries);
  CHECK(surface.report.fans == 4);
  CHECK(count(surface, EdgeKind::Degenerate) == 0);
  CHECK(surface.nodes_world.size() == static_cast<std::size_t>(4 * (n - 2) * n + 4 * 5 * n));
  check_rows(surface, kPi / 2);
  for (const int fan : fans_of(surface)) {
    for (const int j : {0, n - 1}) {
      for (int i = 0; i < 5; ++i) {
        const int node = surface.node(fan, i, j);
        CHECK(surface.boundaries_of(static_cast<std::size_t>(node)) != 0);
        CHECK(std::abs(direction(surface, node).y()) < 1e-14);
      }
    }
  }
  // Every free edge, those of no length among them, lies on one of the two planes.
  CHECK(surface.free_edges() == 2 * (4 * (n - 1) + 4 * 4));
  CHECK(surface.free_edges_on(0) + surface.free_edges_on(1) == surface.free_edges());
}

TEST_CASE("fans: a closed sharp edge has no end, and its fan meets itself") {
  const int round = 24;
  const Surface surface = opened(can(round), 4);
  CHECK(surface.report.fans == 2);
  CHECK(count(surface, EdgeKind::Degenerate) == 2);  // the poles of the lids
  int rings = 0;
  for (const Edge& edge : surface.topology.edges) {
    const bool is_fan = surface.is_fan(static_cast<std::size_t>(edge.first.patch));
    if (is_fan && edge.first.patch == edge.second.patch) ++rings;
  }
  CHECK(rings == 2);
  check_rows(surface, kPi / 2);
}

TEST_CASE("fans: nothing opens where the surface is smooth or turns the concave way") {
  for (const char* name : {"sphere", "torus"}) {
    const Patches patches = make_example(name, {.points = 17});
    const Surface plain = opened(patches, 0);
    const Surface same = opened(patches, 4);
    CHECK(same.report.fans == 0);
    CHECK(same.patches.size() == plain.patches.size());
    CHECK(same.patch_nodes == plain.patch_nodes);
    CHECK(same.fans.direction.empty());
  }
  CHECK(opened(wedge(9, kPi / 2), 4).report.fans == 0);
  CHECK(opened({bent(9, -1)}, 4).report.fans == 0);
}

TEST_CASE("fans: edges open above 40 degrees, and not below") {
  const auto fans_at = [](double degrees) {
    return opened({bent(9, std::tan(0.5 * degrees * kPi / 180))}, 2).report.fans;
  };
  CHECK(fans_at(39.9) == 0);
  CHECK(fans_at(40.1) == 1);
}

TEST_CASE("fans: a patch is split where a sharp edge runs through it") {
  const int n = 9;
  const Surface surface = opened({bent(n, 1)}, 4);
  CHECK(surface.report.split_patches == 1);
  REQUIRE(surface.patches.size() == 3);
  for (const std::size_t p : {0U, 1U}) {
    CHECK(surface.patches[p].ni == 5);
    CHECK(surface.patches[p].nj == n);
    CHECK(surface.patches[p].part_of == "sheet");
  }
  CHECK(surface.patches[0].name != surface.patches[1].name);
  CHECK(surface.nodes_world.size() == static_cast<std::size_t>(n * n + 4 * n));
  check_rows(surface, kPi / 2);
}

TEST_CASE("fans: on both sides of a sheet its edge opens on the convex side alone") {
  const Surface surface = opened({bent(9, 1)}, 2, MarchSide::Both);
  CHECK(surface.report.fans == 1);
  check_rows(surface, kPi / 2);
  for (const int fan : fans_of(surface)) {
    for (int i = 0; i < 3; ++i) CHECK(direction(surface, surface.node(fan, i, 4)).z() > 0.7);
  }
  const Surface other = opened({bent(9, -1)}, 2, MarchSide::Both);
  CHECK(other.report.fans == 1);
  for (const int fan : fans_of(other)) {
    for (int i = 0; i < 3; ++i) CHECK(direction(other, other.node(fan, i, 4)).z() < -0.7);
  }
}

TEST_CASE("fans: a bar's fans close at the ends of its concave edge") {
  const Surface surface = opened(make_example("l-bar", {.points = 17}), 4);
  // Of the twelve corners two are on the concave edge and stay as they are; ten open.
  CHECK(surface.report.fan_corners == 10);
  CHECK(count(surface, EdgeKind::Degenerate) == 4);
  CHECK(surface.closed);
}

TEST_CASE("fans: in two dimensions sharp corners of curves open") {
  ExampleOptions shape{.points = 33};
  shape.closed = true;
  const Surface sharp = opened(make_example("airfoil", shape), 4);
  CHECK(sharp.flat);
  CHECK(sharp.report.fans == 1);
  shape.closed = false;
  const Surface blunt = opened(make_example("airfoil", shape), 4);
  CHECK(blunt.report.fans == 2);
  for (const Surface* surface : {&sharp, &blunt}) {
    for (const int fan : fans_of(*surface)) {
      const Patch& patch = surface->patches[static_cast<std::size_t>(fan)];
      CHECK(patch.ni == 5);
      CHECK(patch.nj == 2);
      CHECK(patch.at(0, 0).z() == 0);
      CHECK(patch.at(0, 1).z() > 0);
      for (int i = 0; i < 5; ++i) {
        CHECK(direction(*surface, surface->node(fan, i, 0)).z() == 0);
        CHECK(surface->boundaries_of(static_cast<std::size_t>(surface->node(fan, i, 0))) == 1);
        CHECK(surface->boundaries_of(static_cast<std::size_t>(surface->node(fan, i, 1))) == 2);
      }
    }
  }
  check_rows(blunt, angle(direction(blunt, blunt.node(fans_of(blunt)[0], 0, 0)),
                          direction(blunt, blunt.node(fans_of(blunt)[0], 4, 0))));
}

TEST_CASE("fans: a number of fans out of range is refused") {
  SurfaceOptions options;
  for (const int fans : {-1, 65}) {
    options.fans = fans;
    CHECK_THROWS_AS(build_surface(make_example("cube"), options), InputError);
  }
  options.fans = 64;
  CHECK_NOTHROW(options.validate());
}
