// Columns at free edges that lie on no boundary: they lean outward, and so do those beside.

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "support/marched.h"
#include "support/shapes.h"
#include "support/threads.h"
#include "vdb_offset/blocks/multi_block.h"
#include "vdb_offset/blocks/quality.h"
#include "vdb_offset/core/error.h"
#include "vdb_offset/march/march.h"
#include "vdb_offset/surface/example.h"

using namespace vdb_offset;
using namespace vdb_offset::test;

namespace {

constexpr double kPi = std::numbers::pi;

Marched run(Patches patches, Case c) {
  c.surface.open_edges = OpenEdges::Splay;
  return marched(std::move(patches), c);
}

Patch plate(const std::string& name, int points, const Vec3& corner, double size) {
  return rectangle(name, {points, points}, corner, {size * Vec3::UnitX(), size * Vec3::UnitY()});
}

/// A part of a cylinder of radius 1 about y, normals outward.
Patches strip(int points) {
  return {make_patch("strip", points, points, [](double u, double v) -> Vec3 {
    const double angle = 0.6 * kPi * (0.5 - v);
    return {std::sin(angle), 2 * u, std::cos(angle)};
  })};
}

/// A plate with a round hole of radius 0.5, in four patches.
Patches ring(int points) {
  Patches patches;
  for (int n = 0; n < 4; ++n) {
    patches.push_back(make_patch("quarter", points, points, [&](double u, double v) -> Vec3 {
      const double angle = 0.5 * kPi * (n + v);
      const double radius = 0.5 + u;
      return {radius * std::cos(angle), radius * std::sin(angle), 0};
    }));
  }
  return patches;
}

/// Worst relative miss of true distances: of the ends, and of all levels.
struct Miss {
  double end = 0;
  double level = 0;
};
Miss miss_of(const Marched& m) {
  Miss miss;
  for (int n = 0; n < m.layers.report.nodes; ++n) {
    for (int k = 1; k < m.layers.levels(); ++k) {
      const double asked = m.layers.spacing.heights_world[static_cast<std::size_t>(k)];
      const double height = m.surface.wall->closest(m.layers.at(n, k)).distance_world;
      const double off = std::abs(height / asked - 1);
      miss.level = std::max(miss.level, off);
      if (k + 1 == m.layers.levels()) miss.end = std::max(miss.end, off);
    }
  }
  return miss;
}

int node_at(const Marched& m, const Vec3& foot) {
  for (int n = 0; n < m.layers.report.nodes; ++n) {
    if ((m.layers.at(n, 0) - foot).norm() < 1e-9) return n;
  }
  FAIL("no node there");
  return -1;
}

}  // namespace

TEST_CASE(
    "splay: a plate's edges lean 30 degrees, its corners as much across both, its middle not") {
  const double d = 0.3;
  const double slope = std::tan(kPi / 6);
  const Marched m = run({plate("plate", 41, Vec3(0, 0, 0), 4)}, {.distance = d, .voxel = 0.03});
  const auto end_of = [&](const Vec3& foot) { return m.end(node_at(m, foot)); };
  const auto leaning = [&](const Vec3& foot, const Vec3& lean) {
    return Vec3(foot + d * (Vec3::UnitZ() + lean).normalized());
  };
  const Vec3 middle(2, 2, 0);
  CHECK((end_of(middle) - leaning(middle, Vec3::Zero())).norm() < 1e-9);
  for (const double y : {0.6, 2.0, 3.4}) {
    const Vec3 side(0, y, 0);
    CHECK((end_of(side) - leaning(side, {-slope, 0, 0})).norm() < 1e-9);
  }
  for (const double x : {0.0, 4.0}) {
    for (const double y : {0.0, 4.0}) {
      const Vec3 corner(x, y, 0);
      const Vec3 out(x > 0 ? slope : -slope, y > 0 ? slope : -slope, 0);
      CHECK((end_of(corner) - leaning(corner, out)).norm() < 1e-9);
    }
  }
}

TEST_CASE("splay: all levels keep their true distances, and no cell is bad") {
  const Patches angle{plate("a", 17, Vec3(0, 0, 0), 1), plate("b", 17, Vec3(1, 0, 0), 1),
                      plate("c", 17, Vec3(0, 1, 0), 1)};
  struct Shape {
    std::string name;
    Patches patches;
    MarchSide side;
  };
  const std::vector<Shape> shapes{
      {"plate", {plate("plate", 17, Vec3(0, 0, 0), 1)}, MarchSide::Both},
      {"inner corner", angle, MarchSide::Along},
      {"hole", ring(17), MarchSide::Along},
      {"strip, outside", strip(17), MarchSide::Along},
      {"strip, inside", strip(17), MarchSide::Against}};
  for (const Shape& shape : shapes) {
    for (const double h : {0.04, 0.02}) {
      CAPTURE(shape.name);
      CAPTURE(h);
      Case c{.distance = 0.3, .voxel = h};
      c.surface.side = shape.side;
      const Marched m = run(shape.patches, c);
      CHECK(m.layers.report.reached == m.layers.report.nodes);
      const Miss miss = miss_of(m);
      CHECK(miss.end < 1e-6);
      CHECK(miss.level < 1e-6);
      const QualityReport quality = judge(build_blocks(m.surface, m.layers)).report;
      CHECK(quality.nonpositive_cells == 0);
      CHECK(quality.min_scaled_jacobian > 0.7);
      MESSAGE(shape.name, ", voxel ", h, ": least scaled Jacobian ", quality.min_scaled_jacobian,
              ", side growth ", quality.side_growth_max, ", miss ", miss.level);
    }
  }
}

TEST_CASE("splay: the outer level spreads beyond the edge smoothly") {
  const double d = 0.3;
  const Marched m = run({plate("plate", 41, Vec3(0, 0, 0), 2)}, {.distance = d, .voxel = 0.03});
  Vec3List ends;
  for (int i = 0; i <= 20; ++i) ends.push_back(m.end(node_at(m, {0.05 * i, 1, 0})));
  CHECK(ends[0].x() == doctest::Approx(-0.5 * d).epsilon(1e-9));
  CHECK(ends[20].x() == doctest::Approx(1).epsilon(1e-9));
  double before = 0;
  for (std::size_t i = 0; i + 1 < ends.size(); ++i) {
    CHECK(ends[i + 1].x() > ends[i].x());
    const double stretch = (ends[i + 1] - ends[i]).norm() / 0.05;
    CHECK(stretch > 0.9);
    CHECK(stretch < 1.5);
    if (i > 0) CHECK(std::max(stretch / before, before / stretch) < 1.25);
    before = stretch;
  }
}

TEST_CASE("splay: without it columns stand upright on a plate, to its edges") {
  Case c{.distance = 0.3, .voxel = 0.03};
  c.march.splay = 0;
  const Marched m = run({plate("plate", 9, Vec3(0, 0, 0), 1)}, c);
  // All but the bend that the grid's differences give the field at an edge.
  for (int n = 0; n < m.layers.report.nodes; ++n) {
    const Vec3 foot = m.layers.at(n, 0);
    const double strays = (m.end(n) - foot - 0.3 * Vec3::UnitZ()).norm();
    CHECK(strays < 2 * m.voxel);
    const double inside = std::min({foot.x(), 1 - foot.x(), foot.y(), 1 - foot.y()});
    if (inside > 0.1) CHECK(strays < 1e-12);
  }
  for (const double no : {-0.1, 1.1, std::nan("")}) {
    CHECK_THROWS_WITH_AS(MarchOptions{.splay = no}.validate(), doctest::Contains("splay = "),
                         InputError);
  }
}

TEST_CASE("splay: the same columns for any number of threads") {
  const auto once = [] { return run(strip(9), {.distance = 0.3}).layers.points_world; };
  CHECK(on_threads(1, once) == on_threads(2, once));
}
