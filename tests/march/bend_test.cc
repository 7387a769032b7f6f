// Ducts that come round again: their walls pass the planes that they begin and end on.

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>

#include "support/shapes.h"
#include "vdb_offset/core/error.h"
#include "vdb_offset/pipeline.h"

using namespace vdb_offset;
using namespace vdb_offset::test;

namespace {

constexpr double kPi = std::numbers::pi;

/// Where a section's point at distance r from the axis is, at a part of the way through the duct.
using Way = std::function<Vec3(double part, double r)>;

/// The walls of a duct of square section 1 x 1, r from r0, z from -0.5; normals inward.
Patches duct(const Way& way, double r0, int along) {
  const auto wall = [&](const char* name, const std::function<std::array<double, 2>(double)>& at) {
    return make_patch(name, along, 9, [&](double u, double v) -> Vec3 {
      const auto [r, z] = at(v);
      return way(u, r) + z * Vec3::UnitZ();
    });
  };
  return {wall("inner",
               [&](double v) {
                 return std::array{r0, v - 0.5};
               }),
          wall("roof",
               [&](double v) {
                 return std::array{r0 + v, 0.5};
               }),
          wall("outer",
               [&](double v) {
                 return std::array{r0 + 1, 0.5 - v};
               }),
          wall("floor", [&](double v) {
            return std::array{r0 + 1 - v, -0.5};
          })};
}

/// Round the z axis from y = 0.
Patches bend(double angle) {
  const Way way = [=](double part, double r) {
    return Vec3(r * std::cos(part * angle), r * std::sin(part * angle), 0);
  };
  return duct(way, 1, static_cast<int>(std::lround(angle / kPi * 32)) + 1);
}

/// Up along x > 0 from y = 0 to 1, round, and down along x < 0 to y = -0.5, a hair beside.
Patches narrow_bend(double gap) {
  const double turn = kPi * (0.5 * gap + 0.5);
  const Way way = [=](double part, double r) {
    const double s = part * (2.5 + turn);
    if (s < 1) return Vec3(r, s, 0);
    if (s > 1 + turn) return Vec3(-r, 2 + turn - s, 0);
    const double angle = kPi * (s - 1) / turn;
    return Vec3(r * std::cos(angle), 1 + r * std::sin(angle), 0);
  };
  return duct(way, 0.5 * gap, 65);
}

PipelineOptions options_for(double distance, double voxel) {
  PipelineOptions options;
  options.distance_world = distance;
  options.rasterize.voxel_world = voxel;
  options.spacing.layers = 8;
  options.spacing.first_cell_world = 2e-3;
  options.surface.open_edges = OpenEdges::Refuse;
  return options;
}

MeshResult mesh_of(Patches patches, const PipelineOptions& options) {
  MeshResult result = make_mesh(std::move(patches), options);
  CHECK(result.quality.report.nonpositive_cells == 0);
  CHECK(result.mesh.layers.report.left_band == 0);
  return result;
}

/// Visits all points of columns: the node's number, and each level's point.
template <typename Visit>
void for_points(const MeshResult& result, const Visit& visit) {
  const Layers& layers = result.mesh.layers;
  for (int n = 0; n < layers.report.nodes; ++n) {
    for (int k = 0; k < layers.levels(); ++k) visit(n, layers.at(n, k));
  }
}

/// How far points of nodes on planes are off these.
double off_planes(const MeshResult& result) {
  double off = 0;
  for_points(result, [&](int n, const Vec3& p) {
    const BoundarySet on = result.surface.boundaries_of(static_cast<std::size_t>(n));
    const std::vector<Boundary>& list = result.surface.boundaries->list();
    for (std::size_t b = 0; b < list.size(); ++b) {
      const Plane& plane = list[b].plane();
      if ((on >> b & 1U) != 0)
        off = std::max(off, std::abs(plane.normal.dot(p - plane.point_world)));
    }
  });
  return off;
}

/// Angle about z, in [0, 2 pi) but for rounding below 0.
double turn_of(const Vec3& p) {
  const double angle = std::atan2(p.y(), p.x());
  return angle < -1e-3 ? angle + 2 * kPi : angle;
}

}  // namespace

TEST_CASE("bend: a duct of 225 or 270 degrees ends on both its planes, and passes them elsewhere") {
  for (const double angle : {1.25 * kPi, 1.5 * kPi}) {
    for (const double h : {0.05, 0.03}) {
      CAPTURE(angle);
      CAPTURE(h);
      const MeshResult result = mesh_of(bend(angle), options_for(0.2, h));
      const std::vector<Boundary>& list = result.surface.boundaries->list();
      REQUIRE(list.size() == 2);
      CHECK(list[0].name() == "opening");
      CHECK(list[1].name() == "opening 2");
      for (const Boundary& boundary : list) CHECK(boundary.is_local());
      CHECK(result.surface.free_edges_on(0) == 32);
      CHECK(result.surface.free_edges_on(1) == 32);
      CHECK(off_planes(result) < 1e-12);
      double low = 0;
      double high = 0;
      for_points(result, [&](int, const Vec3& p) {
        low = std::max(low, -turn_of(p));
        high = std::max(high, turn_of(p) - angle);
      });
      CHECK(low < 1e-12);
      CHECK(high < 1e-12);
    }
  }
}

TEST_CASE("bend: at its inlet a duct of 225 degrees has the columns of one of 180") {
  // That one lies on one side of y = 0, where both its ends are.
  PipelineOptions options = options_for(0.2, 0.04);
  options.repair.on = false;  // its windows are as long as the corners
  const MeshResult half = make_mesh(bend(kPi), options);
  const MeshResult more = make_mesh(bend(1.25 * kPi), options);
  REQUIRE(half.surface.boundaries->list().size() == 2);  // an opening each
  for (const Boundary& end : half.surface.boundaries->list()) CHECK(!end.is_local());
  const Layers& a = half.mesh.layers;
  const Layers& b = more.mesh.layers;
  int same = 0;
  double worst = 0;
  for (int n = 0; n < a.report.nodes; ++n) {
    if (turn_of(a.at(n, 0)) > 0.25 * kPi) continue;
    for (int m = 0; m < b.report.nodes; ++m) {
      if ((a.at(n, 0) - b.at(m, 0)).norm() > 1e-9) continue;
      ++same;
      for (int k = 0; k < a.levels(); ++k)
        worst = std::max(worst, (a.at(n, k) - b.at(m, k)).norm());
    }
  }
  CHECK(same == 9 * 32);
  CHECK(worst < 1e-6 * 0.2);
}

TEST_CASE("bend: where the other leg passes close by, the inlet's plane ends the one leg alone") {
  for (const double gap : {0.2, 0.1}) {
    CAPTURE(gap);
    const MeshResult result = mesh_of(narrow_bend(gap), options_for(0.2, 0.03));
    const std::vector<Boundary>& list = result.surface.boundaries->list();
    REQUIRE(list.size() == 2);
    CHECK(std::count_if(list.begin(), list.end(), [](const Boundary& b) { return b.is_local(); }) ==
          1);
    CHECK(off_planes(result) < 1e-12);
    int passed = 0;
    double beyond = 0;
    for_points(result, [&](int, const Vec3& p) {
      if (p.x() > 0) beyond = std::max(beyond, -p.y());
      passed += p.x() < 0 && p.y() < -0.2 ? 1 : 0;
    });
    CHECK(beyond < 1e-12);
    CHECK(passed > 1000);
  }
}

TEST_CASE("bend: planes may be named where they hold an opening, and are refused where they cut") {
  PipelineOptions options = options_for(0.2, 0.05);
  options.surface.planes = {{"inlet", {Vec3::Zero(), -Vec3::UnitY()}}};
  const Surface surface = build_surface(bend(1.25 * kPi), options.surface);
  const std::vector<Boundary>& list = surface.boundaries->list();
  REQUIRE(list.size() == 2);
  CHECK(list[0].name() == "inlet");
  CHECK(list[0].plane().normal == Vec3::UnitY());
  CHECK(surface.free_edges_on(0) == 32);
  CHECK(list[1].name() == "opening");
  options.surface.planes = {{"inlet", {Vec3(0, 0.5, 0), Vec3::UnitY()}}};
  CHECK_THROWS_WITH_AS(build_surface(bend(1.25 * kPi), options.surface),
                       doctest::Contains("cuts the surface"), InputError);
}

TEST_CASE("bend: edges of a sheet that is cut by their plane are left as they are") {
  // Three squares in the shape of an L: the planes at its inner corner cut it.
  const auto square = [](double x, double y) {
    return rectangle("square", {5, 5}, Vec3(x, y, 0), {Vec3::UnitX(), Vec3::UnitY()});
  };
  const Surface surface = build_surface({square(0, 0), square(1, 0), square(0, 1)});
  CHECK(surface.boundaries->list().size() == 4);
  int left = surface.free_edges();
  for (int b = 0; b < 4; ++b) left -= surface.free_edges_on(b);
  CHECK(left == 8);
}
