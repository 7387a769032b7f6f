// Columns of fans: several at one place, each with its own way out.

#include <doctest/doctest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "march/room.h"
#include "support/shapes.h"
#include "support/threads.h"
#include "vdb_offset/march/march.h"
#include "vdb_offset/surface/example.h"

using namespace vdb_offset;
using namespace vdb_offset::test;

namespace {

struct Marched {
  Surface surface;
  Layers layers;
};

Marched run(Patches patches, double distance, MarchSide side = MarchSide::Along) {
  SurfaceOptions options;
  options.fans = 4;
  options.side = side;
  Surface surface = build_surface(std::move(patches), options);
  const DistanceField field =
      sweep(rasterize(surface, {.distance_world = distance, .both_sides = surface.both_sides}));
  SpacingOptions spacing;
  spacing.layers = 12;
  spacing.first_cell_world = 1e-3;
  Layers layers = march(surface, field, solve_spacing(distance, spacing));
  return {std::move(surface), std::move(layers)};
}

/// Largest angle between a fan's columns in their first cell and the ways out that they were given.
double worst_start(const Marched& m) {
  double worst = 0;
  for (std::size_t n = 0; n < m.surface.fans.direction.size(); ++n) {
    const Vec3& out = m.surface.fans.direction[n];
    if (out.isZero()) continue;
    const int node = static_cast<int>(n);
    const Vec3 first = m.layers.at(node, 1) - m.layers.at(node, 0);
    worst = std::max(worst, std::atan2(out.cross(first).norm(), out.dot(first)));
  }
  return worst;
}

}  // namespace

TEST_CASE(
    "fans: columns leave along their own ways, in the open and in a slot, and all stand apart") {
  for (const auto& [name, distance] : {std::pair{"cube", 0.4}, std::pair{"u-slot", 0.3}}) {
    CAPTURE(name);
    const Marched m = run(make_example(name, {.points = 17}), distance);
    CHECK(worst_start(m) < 1e-6);
    for (std::size_t p = 0; p < m.surface.patches.size(); ++p) {
      if (!m.surface.is_fan(p)) continue;
      const Patch& patch = m.surface.patches[p];
      for (int j = 0; j < patch.nj; ++j) {
        for (int i = 1; i < patch.ni; ++i) {
          const int a = m.surface.node(static_cast<int>(p), i - 1, j);
          const int b = m.surface.node(static_cast<int>(p), i, j);
          CHECK(m.layers.at(a, 0) == m.layers.at(b, 0));
          if (a != b) CHECK(m.layers.at(a, 1) != m.layers.at(b, 1));
        }
      }
    }
  }
}

TEST_CASE(
    "fans: against the normals an edge that is concave along them opens, and meets the distance") {
  const auto groove = [](double u, double v) { return Vec3(2 * u - 1, v, std::abs(2 * u - 1)); };
  const Patches sheet{make_patch("groove", 17, 9, groove)};
  CHECK(run(sheet, 0.2).surface.report.fans == 0);
  for (const MarchSide side : {MarchSide::Against, MarchSide::Both}) {
    const Marched m = run(sheet, 0.2, side);
    CHECK(m.surface.report.fans == 1);
    CHECK(worst_start(m) < 1e-6);
    CHECK(m.layers.report.reached == m.layers.report.nodes);
    CHECK(m.layers.report.distance_error_max < 1e-6);
    for (std::size_t n = 0; n < m.surface.fans.direction.size(); ++n) {
      const Vec3& out = m.surface.fans.direction[n];
      if (!out.isZero()) CHECK(m.layers.at(static_cast<int>(n), 12).z() < -0.1);
    }
  }
}

TEST_CASE("fans: heights at one place differ by no more than the ratio from column to column") {
  SurfaceOptions options;
  options.fans = 4;
  const Surface surface = build_surface(make_example("cube", {.points = 9}), options);
  for (std::size_t p = 0; p < surface.patches.size(); ++p) {
    if (surface.patches[p].name != "fan 1") continue;
    std::vector<double> values(surface.nodes_world.size(), 1.0);
    const auto node = [&](int i) {
      return static_cast<std::size_t>(surface.node(static_cast<int>(p), i, 4));
    };
    values[node(0)] = 0.25;
    grade(links_of(surface), kOfHeights, values);
    for (int i = 0; i < 5; ++i) {
      CHECK(values[node(i)] == doctest::Approx(0.25 * std::pow(1.2, i)).epsilon(1e-12));
    }
  }
}

TEST_CASE("fans: columns are the same bit by bit for any number of threads") {
  const auto points = [] {
    return run(make_example("cube", {.points = 7}), 0.4).layers.points_world;
  };
  CHECK(on_threads(1, points) == on_threads(3, points));
}
