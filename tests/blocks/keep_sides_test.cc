#include "blocks/keep_sides.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "support/marched.h"
#include "vdb_offset/blocks/repair.h"

namespace vdb_offset::test {
namespace {

constexpr double kRadius = 0.5;

/// A cylinder, marched outward, between z = 0 and the plane z = 1 + x, which it meets at angles
/// down to 45 degrees.
Patch cut_cylinder() {
  Patch patch;
  patch.name = "cylinder";
  patch.ni = 49;
  patch.nj = 17;
  for (int j = 0; j < patch.nj; ++j) {
    for (int i = 0; i < patch.ni; ++i) {
      const double angle = 2 * std::numbers::pi * (i % (patch.ni - 1)) / (patch.ni - 1);
      const double x = kRadius * std::cos(angle);
      patch.points_world.emplace_back(x, kRadius * std::sin(angle), (1 + x) * j / (patch.nj - 1));
    }
  }
  return patch;
}

}  // namespace

TEST_CASE("repair: no point beside an oblique boundary plane gets beyond it") {
  Case c{.distance = 0.4, .layers = 10, .first_cell = 0.02};
  Marched m = marched({cut_cylinder()}, c);
  REQUIRE(m.surface.boundaries->list().size() == 2);
  MultiBlock mesh = build_blocks(m.surface, std::move(m.layers));
  const RepairResult result = repair(m.surface, mesh);
  REQUIRE(result.report.windows > 0);
  CHECK(result.quality.report.nonpositive_cells == 0);
  double farthest = 0;
  for (const Vec3& p : mesh.layers.points_world) {
    farthest = std::max({farthest, -p.z(), (p.z() - 1 - p.x()) / std::sqrt(2.0)});
  }
  CHECK(farthest < 1e-12);
}

TEST_CASE("moved_inside: beside a plane a tenth of the distance is left, on it points slide") {
  Surface surface;
  Boundaries boundaries;
  boundaries.add({"floor", Plane{Vec3::Zero(), Vec3::UnitZ()}});
  boundaries.add({"side", Plane{Vec3::Zero(), Vec3::UnitX()}});
  surface.boundaries = std::make_shared<const Boundaries>(boundaries);
  const Vec3 from(1, 0, 2);
  CHECK(moved_inside(surface, 0, from, Vec3(3, 4, 1)) == Vec3(3, 4, 1));
  const Vec3 beside = moved_inside(surface, 0, from, Vec3(-1, 4, -3));
  CHECK((beside - Vec3(0.1, 4, 0.2)).norm() < 1e-12);
  const Vec3 on_floor = moved_inside(surface, 1, Vec3(1, 0, 0), Vec3(-1, 4, 0.5));
  CHECK((on_floor - Vec3(0.1, 4, 0)).norm() < 1e-12);
}

}  // namespace vdb_offset::test
