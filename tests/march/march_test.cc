#include "vdb_offset/march/march.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>

#include "support/marched.h"
#include "support/shapes.h"
#include "support/threads.h"
#include "vdb_offset/core/error.h"
#include "vdb_offset/surface/example.h"

using namespace vdb_offset;
using namespace vdb_offset::test;

namespace {

Marched run(Patches patches, Case c, SurfaceOptions options = {}) {
  options.open_edges = OpenEdges::Splay;  // boundaries have tests of their own
  c.surface = std::move(options);
  // Columns as they are: without margins to facing walls, leans or regard for their neighbours.
  c.march = {.gap_margin = 0, .splay = 0, .graded = false};
  return marched(std::move(patches), c);
}

/// Worst relative miss of the true distance over all levels of all columns that reached.
double level_error(const Marched& m) {
  double worst = 0;
  for (std::size_t n = 0; n < m.layers.stop.size(); ++n) {
    if (m.layers.stop[n] != Stop::Reached) continue;
    for (int k = 1; k < m.layers.levels(); ++k) {
      const double height =
          m.surface.wall->closest(m.layers.at(static_cast<int>(n), k)).distance_world;
      const double wanted = m.layers.spacing.heights_world[static_cast<std::size_t>(k)];
      worst = std::max(worst, std::abs(height / wanted - 1));
    }
  }
  return worst;
}

/// Farthest that an end point strays across the radius of a sphere about `centre`.
double drift(const Marched& m, const Vec3& centre) {
  double worst = 0;
  for (int n = 0; n < m.layers.report.nodes; ++n) {
    const Vec3 radius = (m.layers.at(n, 0) - centre).normalized();
    const Vec3 end = m.layers.at(n, m.layers.levels() - 1) - centre;
    worst = std::max(worst, (end - radius * radius.dot(end)).norm());
  }
  return worst;
}

Patches sphere_at(const Vec3& centre, int points) {
  return mapped(make_example("sphere", {.points = points}), Eigen::Matrix3d::Identity(), centre);
}

int total(const MarchReport& r) { return r.reached + r.collided + r.left_band; }

}  // namespace

TEST_CASE("march: off a sphere columns end at the distance, along the radius, levels in place") {
  const Vec3 centre(0.11, -0.23, 0.37);
  double last = 1e9;
  for (const double h : {1.0 / 8, 1.0 / 16, 1.0 / 32}) {
    CAPTURE(h);
    const Marched m = run(sphere_at(centre, 17), {.voxel = h});
    CHECK(m.layers.report.reached == m.layers.report.nodes);
    CHECK(m.layers.report.distance_error_max < 1e-6);
    CHECK(level_error(m) < 1e-6);
    const double strayed = drift(m, centre);
    CHECK(strayed < 0.5 * h);
    CHECK(strayed <= last);  // equal where columns are straight, whatever the voxels
    last = strayed;
  }
}

TEST_CASE("march: off convex bodies columns are straight, however coarse the field") {
  for (const char* name : {"sphere", "cube"}) {
    CAPTURE(name);
    const Marched m = run(make_example(name, {.points = 17}), {.distance = 0.5, .voxel = 0.04});
    const int last = m.layers.levels() - 1;
    for (int n = 0; n < m.layers.report.nodes; ++n) {
      const Vec3 foot = m.layers.at(n, 0);
      const Vec3 line = m.layers.at(n, last) - foot;
      double bend = 0;
      for (int k = 1; k < last; ++k) {
        const double part = m.layers.spacing.heights_world[static_cast<std::size_t>(k)] / 0.5;
        bend = std::max(bend, (m.layers.at(n, k) - foot - part * line).norm());
      }
      CHECK(bend < 1e-12);
    }
  }
}

TEST_CASE("march: levels lie at their true distances off a wing and in a duct with piers too") {
  ExampleOptions options;
  options.points = 17;
  CHECK(level_error(run(make_example("naca0012-wing", options),
                        {.distance = 0.4, .layers = 32, .first_cell = 1e-5})) < 1e-6);
  CHECK(level_error(run(make_example("draft-tube", options), {.distance = 0.05})) < 1e-6);
}

TEST_CASE("march: huge and tiny worlds give the same columns") {
  const Marched unit =
      run(make_example("cube", {.points = 9}), {.distance = 0.5, .first_cell = 1e-3});
  for (const double scale : {1e-6, 1e6}) {
    CAPTURE(scale);
    SurfaceOptions options;
    options.scale = scale;
    const Marched m = run(make_example("cube", {.points = 9}),
                          {.distance = 0.5 * scale, .first_cell = 1e-3 * scale}, options);
    CHECK(m.layers.report.reached == m.layers.report.nodes);
    double worst = 0;
    for (std::size_t n = 0; n < m.layers.points_world.size(); ++n) {
      worst =
          std::max(worst, (m.layers.points_world[n] / scale - unit.layers.points_world[n]).norm());
    }
    CHECK(worst < 1e-5);
  }
}

TEST_CASE("march: first cells far below a voxel keep their height") {
  const Marched m =
      run(sphere_at({5, 5, 5}, 9), {.distance = 0.5, .layers = 64, .first_cell = 1e-8});
  for (const double first : m.layers.first_cell_world) {
    CHECK(std::abs(first / 1e-8 - 1) < 1e-6);
  }
}

TEST_CASE("march: columns between two plates stop half way, to a tenth of a voxel") {
  for (const double voxels_in_gap : {30.0, 7.3, 1.9, 0.4}) {
    CAPTURE(voxels_in_gap);
    const double gap = 0.2;
    const double h = gap / voxels_in_gap;
    const Marched m = run(plates(9, gap), {.distance = 0.5, .voxel = h});
    int inner = 0;
    for (int n = 0; n < m.layers.report.nodes; ++n) {
      // Near the rim columns may leave the gap sideways.
      if ((m.layers.at(n, 0) - Vec3(0.5, 0.5, 0)).head<2>().cwiseAbs().maxCoeff() > 0.26) continue;
      ++inner;
      CHECK(m.layers.stop[static_cast<std::size_t>(n)] == Stop::Collided);
      const double height = m.layers.height_world[static_cast<std::size_t>(n)];
      CHECK(std::abs(height - 0.5 * gap) < 0.1 * std::min(h, gap));
      const double z = m.layers.at(n, m.layers.levels() - 1).z();
      CHECK(std::abs(z - 0.5 * gap) < 0.1 * std::min(h, gap));
    }
    CHECK(inner == 50);
  }
}

TEST_CASE(
    "march: facing columns of two spheres stop on the plane between them, the others do not") {
  for (const auto& [gap, distance, voxel] : {std::array{0.4, 0.5, 0.04},
                                             {0.05, 0.5, 0.04},
                                             {0.001, 0.5, 0.04},
                                             {0.4, 1.0, 0.06},
                                             {0.01, 2.0, 0.1},
                                             {0.4, 5.0, 0.2}}) {
    CAPTURE(gap);
    CAPTURE(distance);
    ExampleOptions options;
    options.points = 17;
    options.gap = gap;
    const Marched m =
        run(make_example("sphere-pair", options), {.distance = distance, .voxel = voxel});
    int facing = 0;
    for (int n = 0; n < m.layers.report.nodes; ++n) {
      const Vec3 foot = m.layers.at(n, 0);
      const Vec3 centre(foot.x() > 0 ? 1 + 0.5 * gap : -1 - 0.5 * gap, 0, 0);
      const Vec3 radius = (foot - centre).normalized();
      // Along the radius the plane x = 0 is this far from the wall.
      const double free = std::abs(radius.x()) > 1e-9 ? -centre.x() / radius.x() - 1 : -1;
      // Where phi rises by 0.95 along the plane a coarse sphere's facets hide the kink.
      const bool flat = std::abs(radius.x()) < std::sqrt(1 - 0.95 * 0.95);
      if (free < 0 || flat || std::abs(free - distance) < m.voxel) {
        if (free < 0) CHECK(m.layers.stop[static_cast<std::size_t>(n)] == Stop::Reached);
        continue;
      }
      const bool meets = free < distance;
      facing += meets ? 1 : 0;
      CAPTURE(radius);
      CHECK(m.layers.stop[static_cast<std::size_t>(n)] == (meets ? Stop::Collided : Stop::Reached));
      if (!meets) continue;
      const Vec3 end = m.layers.at(n, m.layers.levels() - 1);
      CHECK(std::abs(end.x()) < 0.1 * m.voxel);
      // Half a voxel across the radius is more along a plane that is met at a flat angle.
      const double strayed = 0.5 * m.voxel / std::abs(radius.x());
      CHECK((end - (centre + (1 + free) * radius)).norm() < strayed);
      CHECK(std::abs(m.layers.height_world[static_cast<std::size_t>(n)] - free) < strayed);
    }
    CHECK(facing > 100);
  }
}

TEST_CASE("march: no column gets through a wall, however thin the gap") {
  for (const double gap : {1e-2, 1e-3, 1e-6}) {
    for (const int points : {5, 17}) {
      CAPTURE(gap);
      CAPTURE(points);
      SurfaceOptions options;
      options.weld = 1e-9;  // the default would weld the plates into one
      const Marched m = run(plates(points, gap), {.distance = 0.5, .voxel = 0.05}, options);
      for (int n = 0; n < m.layers.report.nodes; ++n) {
        const Vec3 foot = m.layers.at(n, 0);
        if ((foot - Vec3(0.5, 0.5, 0)).head<2>().cwiseAbs().maxCoeff() > 0.4) continue;
        CHECK(m.layers.stop[static_cast<std::size_t>(n)] == Stop::Collided);
        const Vec3 end = m.layers.at(n, m.layers.levels() - 1);
        CHECK(std::abs(end.z() - 0.5 * gap) < 0.01 * gap);
        CHECK((end - foot).norm() < gap);
      }
    }
  }
}

TEST_CASE("march: no column of a narrowing duct ends beyond the distance or its own height") {
  for (const double distance : {0.15, 0.3}) {
    CAPTURE(distance);
    const Marched m =
        run(make_example("draft-tube", {.points = 17}), {.distance = distance, .voxel = 0.0125});
    CHECK(m.layers.report.collided > 1000);
    for (int n = 0; n < m.layers.report.nodes; ++n) {
      const double height = m.layers.height_world[static_cast<std::size_t>(n)];
      const Vec3& end = m.layers.at(n, m.layers.levels() - 1);
      CHECK(height <= distance * (1 + 1e-12));
      CHECK(std::abs(m.surface.wall->closest(end).distance_world - height) < 1e-12 * distance);
    }
  }
}

TEST_CASE("march: an inner corner's edge marches along the bisector, its height is the true one") {
  for (const double angle : {30.0, 60.0, 90.0, 120.0}) {
    CAPTURE(angle);
    const double a = angle * 3.14159265358979 / 180;
    const Marched m = run(wedge(17, a), {.distance = 0.25, .voxel = 0.02, .first_cell = 1e-4});
    const Vec3 bisector(std::cos(a / 2), 0, std::sin(a / 2));
    int on_edge = 0;
    for (int n = 0; n < m.layers.report.nodes; ++n) {
      const Vec3 foot = m.layers.at(n, 0);
      if (std::hypot(foot.x(), foot.z()) > 0 || foot.y() < 0.3 || foot.y() > 0.7) continue;
      ++on_edge;
      CHECK(m.layers.stop[static_cast<std::size_t>(n)] == Stop::Reached);
      const Vec3 end = m.layers.at(n, m.layers.levels() - 1) - foot;
      CHECK((end - bisector * bisector.dot(end)).norm() < 0.5 * m.voxel);
      CHECK(end.dot(bisector) == doctest::Approx(0.25 / std::sin(a / 2)).epsilon(0.01));
      CHECK(m.layers.first_cell_world[static_cast<std::size_t>(n)] ==
            doctest::Approx(1e-4).epsilon(1e-6));
    }
    CHECK(on_edge == 7);
  }
}

TEST_CASE("march: columns of a corner too sharp for the grid go out along the bisector") {
  ExampleOptions options{.points = 9};
  options.angle = 3.14159265358979 / 18;
  const double slope = 1.001 * std::tan(options.angle / 2);
  for (const double voxel : {0.02, 0.04, 0.08}) {
    CAPTURE(voxel);
    const Case c{.distance = 0.5, .voxel = voxel, .first_cell = 1e-4};
    const Marched m = run(make_example("wedge", options), c);
    int inside = 0;
    for (int n = 0; n < m.layers.report.nodes; ++n) {
      const Vec3 foot = m.layers.at(n, 0);
      if (std::abs(foot.y()) > slope * foot.x() + 1e-9 || std::abs(foot.z() - 0.5) > 0.3) continue;
      ++inside;
      CHECK(m.layers.room_world[static_cast<std::size_t>(n)] > 0.45);  // it could leave the corner
    }
    CHECK(inside == 5 * 9);  // the edge and four nodes on each side
  }
}

TEST_CASE("march: a body thinner than a voxel gets its columns on both faces") {
  Patches plate = make_example("cube", {.points = 17});
  const double thickness = 1e-3;
  for (Patch& patch : plate) {
    for (Vec3& x : patch.points_world) x.z() *= thickness;
  }
  for (const double shift : {0.0, 0.013, 0.027}) {
    CAPTURE(shift);
    const Marched m = run(mapped(plate, Eigen::Matrix3d::Identity(), {0, 0, shift}),
                          {.distance = 0.3, .voxel = 0.05});
    CHECK(m.layers.report.reached == m.layers.report.nodes);
    CHECK(m.layers.report.distance_error_max < 1e-6);
    const Box& box = m.surface.wall->bounds();
    const Vec3 middle = 0.5 * (box.lo + box.hi);
    int inner = 0;
    for (int n = 0; n < m.layers.report.nodes; ++n) {
      const Vec3 foot = m.layers.at(n, 0);
      if ((foot - middle).head<2>().cwiseAbs().maxCoeff() > 0.49) continue;
      ++inner;
      const Vec3 end = m.layers.at(n, m.layers.levels() - 1);
      CHECK((end - foot).z() * (foot.z() > middle.z() ? 1 : -1) ==
            doctest::Approx(0.3).epsilon(1e-3));
    }
    CHECK(inner == 2 * 15 * 15);
  }
}

TEST_CASE("march: both sides of a sheet are mirror images") {
  SurfaceOptions options;
  options.side = MarchSide::Both;
  const Marched m = run({rectangle("sheet", {9, 9}, Vec3::Zero(), {Vec3::UnitX(), Vec3::UnitY()})},
                        {.distance = 0.2, .voxel = 0.02}, options);
  CHECK(m.layers.report.nodes == 162);
  CHECK(m.layers.report.reached == 162);
  for (int n = 0; n < 81; ++n) {
    for (int k = 0; k < m.layers.levels(); ++k) {
      const Vec3& up = m.layers.at(n, k);
      const Vec3& down = m.layers.at(n + 81, k);
      CHECK((up - Vec3(down.x(), down.y(), -down.z())).norm() < 0.05 * m.voxel);
    }
  }
}

TEST_CASE("march: levels of one column never go back") {
  for (const char* name : {"u-slot", "l-bar"}) {
    CAPTURE(name);
    const Marched m = run(make_example(name, {.points = 9}), {.distance = 0.4, .layers = 40});
    CHECK(total(m.layers.report) == m.layers.report.nodes);
    for (int n = 0; n < m.layers.report.nodes; ++n) {
      double last = 0;
      for (int k = 1; k < m.layers.levels(); ++k) {
        const double height = m.surface.wall->closest(m.layers.at(n, k)).distance_world;
        CHECK(height > last);
        last = height;
      }
    }
  }
}

TEST_CASE("march: one thread and two give the same bytes") {
  const auto march_all = [] {
    return run(make_example("u-slot", {.points = 9}), {.distance = 0.4}).layers.points_world;
  };
  const Vec3List one = on_threads(1, march_all);
  const Vec3List two = on_threads(2, march_all);
  REQUIRE(one.size() == two.size());
  CHECK(std::memcmp(one.data(), two.data(), one.size() * sizeof(Vec3)) == 0);
}

TEST_CASE("march: a step out of range is refused by name") {
  CHECK_THROWS_WITH(MarchOptions{.step_voxels = std::nan("")}.validate(),
                    "step = nan, but must be in [0.01, 2] voxels");
  CHECK_THROWS_WITH(MarchOptions{.step_voxels = 1e-9}.validate(),
                    "step = 1e-09, but must be in [0.01, 2] voxels");
  CHECK_NOTHROW(MarchOptions{.step_voxels = 0.01}.validate());
}
