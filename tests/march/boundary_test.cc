// Columns on and beside boundaries.

#include <doctest/doctest.h>

#include <Eigen/Geometry>
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

/// Columns at free edges do not lean.
const MarchOptions kUpright{.splay = 0};

/// With the sweep's last bit: symmetric input gives symmetric columns.
Marched run(Patches patches, Case c) {
  c.sweep = {.tolerance_voxels = 0, .max_sweeps = 1000};
  return marched(std::move(patches), c);
}

/// How far points of any level lie beyond a boundary, and those of nodes on one off it.
struct Misfit {
  double beyond = 0;
  double off = 0;
};
Misfit misfit(const Marched& m) {
  Misfit worst;
  for (int n = 0; n < m.layers.report.nodes; ++n) {
    for (int k = 0; k < m.layers.levels(); ++k) {
      const Vec3& p = m.layers.at(n, k);
      worst.beyond = std::max(worst.beyond, -m.surface.boundaries->side(p));
      for (std::size_t b = 0; b < m.surface.boundaries->list().size(); ++b) {
        if ((m.on(n) >> b & 1U) == 0) continue;
        worst.off = std::max(worst.off, std::abs(m.surface.boundaries->list()[b].side(p)));
      }
    }
  }
  return worst;
}

/// Worst relative miss of the end point's true distance.
double end_error(const Marched& m) {
  double worst = 0;
  for (int n = 0; n < m.layers.report.nodes; ++n) {
    const double height = m.surface.wall->closest(m.end(n)).distance_world;
    worst =
        std::max(worst, std::abs(height / m.layers.asked_world[static_cast<std::size_t>(n)] - 1));
  }
  return worst;
}

/// The part of patches with coordinate `axis` >= 0; a grid line lies on 0.
Patches half(const Patches& patches, int axis) {
  Patches kept;
  for (const Patch& patch : patches) {
    int lo[2] = {patch.ni, patch.nj};
    int hi[2] = {-1, -1};
    for (int j = 0; j < patch.nj; ++j) {
      for (int i = 0; i < patch.ni; ++i) {
        if (patch.at(i, j)[axis] < -1e-12) continue;
        lo[0] = std::min(lo[0], i);
        hi[0] = std::max(hi[0], i);
        lo[1] = std::min(lo[1], j);
        hi[1] = std::max(hi[1], j);
      }
    }
    if (hi[0] <= lo[0] || hi[1] <= lo[1]) continue;
    Patch part = patch;
    part.ni = hi[0] - lo[0] + 1;
    part.nj = hi[1] - lo[1] + 1;
    part.points_world.clear();
    for (int j = lo[1]; j <= hi[1]; ++j) {
      for (int i = lo[0]; i <= hi[0]; ++i) part.points_world.push_back(patch.at(i, j));
    }
    kept.push_back(part);
  }
  return kept;
}

/// Largest distance of any level between columns of `part` and those of `whole` on the same node.
double difference(const Marched& part, const Marched& whole) {
  double worst = 0;
  for (int n = 0; n < part.layers.report.nodes; ++n) {
    int same = -1;
    for (int w = 0; w < whole.layers.report.nodes; ++w) {
      if ((whole.layers.at(w, 0) - part.layers.at(n, 0)).norm() < 1e-12) same = w;
    }
    REQUIRE(same >= 0);
    for (int k = 0; k < part.layers.levels(); ++k) {
      worst = std::max(worst, (whole.layers.at(same, k) - part.layers.at(n, k)).norm());
    }
  }
  return worst;
}

}  // namespace

TEST_CASE("boundary march: a half and a quarter of a sphere give those parts of the whole") {
  const Patches sphere = make_example("sphere", {.points = 17});
  const double radius = sphere[0].at(0, 0).norm();
  const Case c{.distance = radius, .voxel = radius / 8};
  const Marched whole = run(sphere, c);
  const Marched halved = run(half(sphere, 0), c);
  const Marched quarter = run(half(half(sphere, 0), 1), c);
  CHECK(halved.surface.boundaries->list().size() == 1);
  CHECK(quarter.surface.boundaries->list().size() == 2);
  CHECK(halved.layers.report.reached == halved.layers.report.nodes);
  CHECK(difference(halved, whole) < 1e-9 * radius);
  CHECK(difference(quarter, whole) < 1e-9 * radius);
  CHECK(misfit(halved).off == 0);
  CHECK(misfit(quarter).off == 0);
  CHECK(misfit(quarter).beyond == 0);
}

TEST_CASE("boundary march: an oblique symmetry plane is kept to rounding, and the distance too") {
  const Eigen::Matrix3d map = Eigen::AngleAxisd(0.7, Vec3(1, 2, 3).normalized()).toRotationMatrix();
  for (const double h : {0.08, 0.04}) {
    CAPTURE(h);
    const Marched m =
        run(mapped(half(make_example("sphere", {.points = 17}), 0), map, Vec3(0.11, -0.23, 0.37)),
            {.distance = 0.5, .voxel = h});
    CHECK(m.layers.report.reached == m.layers.report.nodes);
    CHECK(end_error(m) < 1e-6);
    CHECK(misfit(m).off < 1e-15);
    CHECK(misfit(m).beyond < 1e-15);
    // On and beside the plane columns run along the radius as elsewhere.
    const Vec3 centre(0.11, -0.23, 0.37);
    double strayed = 0;
    for (int n = 0; n < m.layers.report.nodes; ++n) {
      const Vec3 radius = (m.layers.at(n, 0) - centre).normalized();
      const Vec3 end = m.end(n) - centre;
      strayed = std::max(strayed, (end - radius * radius.dot(end)).norm());
    }
    CHECK(strayed < 0.5 * h);
  }
}

TEST_CASE(
    "boundary march: walls at 60, 90 and 120 degrees to the plane keep to the distance there") {
  for (const double degrees : {60.0, 90.0, 120.0}) {
    for (const double h : {0.05, 0.03, 0.017}) {
      CAPTURE(degrees);
      CAPTURE(h);
      const double lean = (degrees - 90) * std::numbers::pi / 180;
      const Vec3 along(std::cos(lean), 0, -std::sin(lean));
      SurfaceOptions options;
      options.open_edges = OpenEdges::Splay;
      options.planes = {{"plane", {Vec3::Zero(), Vec3::UnitX()}}};
      const Marched m =
          run({rectangle("wall", {21, 5}, Vec3(0, 0, 0), {Vec3(2 * along), Vec3::UnitY()})},
              {.distance = 0.4, .voxel = h, .surface = options, .march = kUpright});
      CHECK(misfit(m).off == 0);
      CHECK(misfit(m).beyond == 0);
      for (int n = 0; n < m.layers.report.nodes; ++n) {
        const double y = m.layers.at(n, 0).y();
        if (m.on(n) == 0 || y < 0.01 || y > 0.99) continue;  // the wall splays at its ends
        const double height = m.surface.wall->closest(m.end(n)).distance_world;
        CHECK(height == doctest::Approx(0.4).epsilon(1e-6));
        // The law on the plane is that of the wall and its image: at 60 degrees the way along the
        // plane is longer than the distance, at 120 the edge itself is nearest.
        const double length = (m.end(n) - m.layers.at(n, 0)).norm();
        const double expected =
            degrees < 90 ? 0.4 / std::sin(degrees * std::numbers::pi / 180) : 0.4;
        CHECK(length == doctest::Approx(expected).epsilon(1e-6));
      }
    }
  }
}

TEST_CASE(
    "boundary march: walls at 90 and 120 degrees to a plane give no inverted cell, at 60 a few") {
  for (const double degrees : {60.0, 90.0, 120.0}) {
    for (const double h : {0.05, 0.03, 0.017}) {
      CAPTURE(degrees);
      CAPTURE(h);
      SurfaceOptions options;
      options.open_edges = OpenEdges::Splay;
      options.planes = {{"plane", {Vec3::Zero(), Vec3::UnitX()}}};
      const Marched m =
          run(wall_at_plane({21, 5}, degrees * std::numbers::pi / 180),
              {.distance = 0.4, .voxel = h, .layers = 12, .surface = options, .march = kUpright});
      const QualityReport quality = judge(build_blocks(m.surface, m.layers)).report;
      MESSAGE(degrees, " degrees, voxel ", h, ": non-positive cells ", quality.nonpositive_cells);
      // In the acute corner columns merge on the plane, so cells thin out there, and some fold.
      CHECK(quality.nonpositive_cells <= (degrees < 90 ? 4 : 0));
      if (degrees >= 90) CHECK(quality.min_scaled_jacobian > 0.8);
    }
  }
}

TEST_CASE("boundary march: in a duct with piers sides lie in the openings, and nothing beyond") {
  for (const double h : {0.02, 0.013}) {
    const Marched m =
        run(make_example("draft-tube", {.points = 9}), {.distance = 0.06, .voxel = h});
    CHECK(misfit(m).off == 0);
    CHECK(misfit(m).beyond == 0);
    CHECK(m.layers.report.left_band == 0);
  }
}

TEST_CASE("boundary march: the same columns for any number of threads") {
  const auto once = [] {
    return run(half(make_example("torus", {.points = 9}), 0), {.distance = 0.2})
        .layers.points_world;
  };
  const auto one = on_threads(1, once);
  const auto two = on_threads(2, once);
  CHECK(one == two);
}

TEST_CASE("boundary march: a body off a plane meets its own image half way") {
  // A sphere of radius 1 whose middle is 1.2 off the plane: 0.2 of room at its nearest.
  SurfaceOptions options;
  options.planes = {{"ground", {Vec3(-1.2, 0, 0), Vec3::UnitX()}}};
  const Marched m = run(make_example("sphere", {.points = 17}),
                        {.distance = 0.4, .voxel = 0.03, .surface = options});
  CHECK(misfit(m).beyond <= 0);
  CHECK(m.layers.report.collided > 10);
  for (int n = 0; n < m.layers.report.nodes; ++n) {
    if (m.layers.at(n, 0).x() > -0.9999) continue;
    CHECK(m.layers.room_world[static_cast<std::size_t>(n)] ==
          doctest::Approx(0.2).epsilon(0.1 * m.voxel / 0.2));
  }
}

TEST_CASE("boundary march: a wing's root marches within the fuselage that it stands on") {
  SurfaceOptions options;
  options.shapes = {{"body", make_example("fuselage", {.points = 17})}};
  const Marched m = run(make_example("wing-on-cylinder", {.points = 17}),
                        {.distance = 0.2, .voxel = 0.03, .surface = options});
  REQUIRE(m.surface.boundaries->list().size() == 1);
  const Boundary& body = m.surface.boundaries->list()[0];
  int on = 0;
  double off = 0;
  double beyond = 0;
  for (int n = 0; n < m.layers.report.nodes; ++n) {
    for (int k = 0; k < m.layers.levels(); ++k) {
      const double side = body.side(m.layers.at(n, k));
      beyond = std::max(beyond, -side);
      if (m.on(n) != 0) off = std::max(off, std::abs(side));
    }
    on += m.on(n) != 0 ? 1 : 0;
  }
  CHECK(on > 40);
  CHECK(off < 1e-12);
  CHECK(beyond < 1e-12);
  CHECK(m.layers.report.reached == m.layers.report.nodes);
  CHECK(end_error(m) < 1e-6);
  // The root's nodes had to move onto the fuselage's facets by no more than their sagitta.
  CHECK(m.surface.report.boundary_distance_max_world < 5e-4);

  options.shapes = {{"elsewhere", mapped(make_example("fuselage", {.points = 9}),
                                         Eigen::Matrix3d::Identity(), Vec3(0, 5, 0))}};
  CHECK_THROWS_WITH_AS(build_surface(make_example("wing-on-cylinder", {.points = 9}), options),
                       doctest::Contains("no free edge of the surface lies on the boundary"),
                       InputError);
}

TEST_CASE("boundary march: columns from both sides end on an internal surface between two plates") {
  SurfaceOptions options;
  options.open_edges = OpenEdges::Splay;
  // Nearer to the lower plate; wavy, and larger than the plates.
  const auto height = [](double x, double y) { return 0.15 + 0.02 * std::sin(3 * x + 2 * y); };
  options.internals = {{"disk", {make_patch("disk", 41, 41, [&](double u, double v) -> Vec3 {
                          const double x = 3 * u - 1;
                          const double y = 3 * v - 1;
                          return {x, y, height(x, y)};
                        })}}};
  const Marched m =
      run(plates(9, 0.5), {.distance = 0.4, .voxel = 0.02, .surface = options, .march = kUpright});
  const Boundary& disk = m.surface.boundaries->list()[0];
  int ended = 0;
  for (int n = 0; n < m.layers.report.nodes; ++n) {
    const Vec3 foot = m.layers.at(n, 0);
    const bool is_low = foot.z() < 0.25;
    const double side = disk.side(foot);
    for (int k = 0; k < m.layers.levels(); ++k) {
      CHECK(disk.side(m.layers.at(n, k)) * side > -1e-12);  // none crosses it
    }
    const bool is_on = m.layers.ended_on(n) == 0;
    CHECK(is_on == (m.layers.stop[static_cast<std::size_t>(n)] == Stop::Internal));
    if (!is_on) continue;
    CHECK(std::abs(disk.side(m.end(n))) < 1e-12);
    ++ended;
    CHECK(is_low);  // from above, the middle between the plates comes first
    const double length = m.layers.room_world[static_cast<std::size_t>(n)];
    CHECK(length == doctest::Approx(height(foot.x(), foot.y())).epsilon(0.02));
  }
  CHECK(ended > 60);
  CHECK(m.layers.report.internal == ended);
}

TEST_CASE(
    "boundary march: wall nodes on an internal surface march within it, the interface named") {
  SurfaceOptions options;
  options.open_edges = OpenEdges::Splay;
  // Two patches side by side; the internal surface stands on their common side and leans.
  const Patches wall{rectangle("left", {9, 9}, Vec3(-1, 0, 0), {Vec3::UnitX(), Vec3::UnitY()}),
                     rectangle("right", {9, 9}, Vec3(0, 0, 0), {Vec3::UnitX(), Vec3::UnitY()})};
  const Vec3 lean = Vec3(0.3, 0, 1).normalized();
  options.internals = {
      {"screen",
       {rectangle("screen", {5, 5}, Vec3(0, -1, 0) - 0.1 * lean, {lean, 3 * Vec3::UnitY()})}}};
  const Marched m = run(wall, {.distance = 0.3, .voxel = 0.03, .surface = options});
  const Boundary& screen = m.surface.boundaries->list()[0];
  int on = 0;
  for (int n = 0; n < m.layers.report.nodes; ++n) {
    if (m.on(n) == 0) continue;
    ++on;
    for (int k = 0; k < m.layers.levels(); ++k) {
      CHECK(std::abs(screen.side(m.layers.at(n, k))) < 1e-12);
    }
    const double height = m.surface.wall->closest(m.end(n)).distance_world;
    CHECK(height == doctest::Approx(0.3).epsilon(1e-6));
  }
  CHECK(on == 9);
  const MultiBlock mesh = build_blocks(m.surface, m.layers);
  REQUIRE(mesh.interfaces.size() == 1);
  CHECK(mesh.interfaces[0].name == "screen");
}
