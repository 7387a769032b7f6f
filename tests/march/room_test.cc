// Heights over the wall: free room, margins, grading, families.

#include "march/room.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

#include "support/layers.h"
#include "support/neighbours.h"
#include "support/shapes.h"
#include "support/threads.h"
#include "vdb_offset/blocks/multi_block.h"
#include "vdb_offset/core/error.h"
#include "vdb_offset/march/march.h"
#include "vdb_offset/march/room_at.h"
#include "vdb_offset/surface/example.h"

using namespace vdb_offset;
using namespace vdb_offset::test;

namespace {

/// The same by relaxing edges until nothing changes.
std::vector<double> graded_slowly(const Surface& surface, const Grading& grading,
                                  std::vector<double> values) {
  bool changed = true;
  const auto relax = [&](std::size_t from, std::size_t to) {
    const double length = edge_length(surface, from, to);
    if (!(length > 0)) return;
    double most = values[from] > 0 ? values[from] * grading.ratio : 1e300;
    if (grading.gentle > 0) {
      most = std::max(values[from] * grading.ratio, values[from] + grading.gentle * length);
    }
    most = std::min(most, values[from] + grading.steepest * length);
    changed = changed || most < values[to];
    values[to] = std::min(values[to], most);
  };
  while (changed) {
    changed = false;
    for_neighbours(surface, [&](std::size_t a, std::size_t b) {
      relax(a, b);
      relax(b, a);
    });
  }
  return values;
}

}  // namespace

TEST_CASE("room: graded values are the largest that do not step") {
  const Surface surface = build_surface(make_example("l-bar", {.points = 9}));
  std::mt19937_64 random(3);
  std::uniform_real_distribution<double> any(0, 1);
  std::vector<double> values(surface.nodes_world.size());
  for (double& value : values) value = any(random) < 0.05 ? 0.2 * any(random) : 1.0;
  values[7] = 0;
  for (const Grading& grading : {Grading{1.2, 0, 1}, Grading{1.5, 0, 0.3}, Grading{3, 0, 10},
                                 Grading{1.2, 0.25, 1}, Grading{1.01, 0.1, 0.2}}) {
    CAPTURE(grading.ratio);
    std::vector<double> graded = values;
    grade(links_of(surface), grading, graded);
    CHECK(graded == graded_slowly(surface, grading, values));
  }
}

TEST_CASE("room: facing spheres keep apart by the margin, and their blocks do not meet") {
  const double distance = 0.5;
  for (const double gap : {0.2 * distance, 0.01 * distance}) {
    CAPTURE(gap);
    ExampleOptions shape{.points = 17};
    shape.gap = gap;
    const PipelineOptions options = options_for(distance, 0.04);
    const MeshResult result = make_mesh(make_example("sphere-pair", shape), options);
    const Layers& layers = result.mesh.layers;
    // The plane between them has x = 0: no point of either reaches it, so no cell does.
    double nearest = 1e9;
    int collided = 0;
    for (int n = 0; n < layers.report.nodes; ++n) {
      const double side = layers.at(n, 0).x() > 0 ? 1 : -1;
      for (int k = 0; k < layers.levels(); ++k) {
        nearest = std::min(nearest, side * layers.at(n, k).x());
      }
      const auto at = static_cast<std::size_t>(n);
      collided += layers.stop[at] == Stop::Collided ? 1 : 0;
      CHECK(layers.height_world[at] <=
            std::max(0.9 * layers.room_world[at], distance) * (1 + 1e-9));
      if (layers.stop[at] == Stop::Collided) {
        CHECK(layers.height_world[at] <= 0.9 * layers.room_world[at] * (1 + 1e-9));
      }
      const double height =
          result.surface.wall->closest(layers.at(n, layers.levels() - 1)).distance_world;
      CHECK(height == doctest::Approx(layers.height_world[at]).epsilon(1e-6));
    }
    CHECK(collided > 100);
    CHECK(nearest > 0.05 * gap * (1 - 1e-6));
    for_neighbours(result.surface, [&](std::size_t a, std::size_t b) {
      const double low = std::min(layers.height_world[a], layers.height_world[b]);
      const double high = std::max(layers.height_world[a], layers.height_world[b]);
      const double length = edge_length(result.surface, a, b);
      const double ratio = std::max(1.2, layers.spacing.growth);
      CHECK(high <= std::max(low * ratio, low + 0.25 * length) * (1 + 1e-9));
      CHECK(high - low <= length * (1 + 1e-9));
    });
  }
}

namespace {

/// Columns of the pair of unit spheres that meet the plane between them, and by how far the free
/// room of one is off at most, in voxels: straight along the radius.
struct PairRoom {
  int met = 0;
  int met_beyond = 0;  ///< farther than the distance asked for
  double error_max_voxels = 0;
};

PairRoom pair_room(double gap, double gap_margin, double voxel) {
  const double distance = 0.5;
  ExampleOptions shape{.points = 17};
  shape.gap = gap;
  PipelineOptions options = options_for(distance, voxel);
  options.march.gap_margin = gap_margin;
  const Layers layers = make_mesh(make_example("sphere-pair", shape), options).mesh.layers;
  const double seen = distance / (1 - gap_margin);
  PairRoom found;
  for (int n = 0; n < layers.report.nodes; ++n) {
    const Vec3 foot = layers.at(n, 0);
    const Vec3 centre(foot.x() > 0 ? 1 + 0.5 * gap : -1 - 0.5 * gap, 0, 0);
    const Vec3 radius = (foot - centre).normalized();
    const bool towards = radius.x() * centre.x() < 0;
    const double free = towards ? -centre.x() / radius.x() - 1 : 2 * seen;
    const auto at = static_cast<std::size_t>(n);
    if (free > seen + 0.1 * voxel) {
      CHECK(layers.room_world[at] == doctest::Approx(distance).epsilon(1e-9));
    }
    if (free > seen - 0.1 * voxel) continue;
    ++found.met;
    found.met_beyond += free > distance ? 1 : 0;
    CHECK(layers.stop[at] == Stop::Collided);
    const double error = std::abs(layers.room_world[at] - free) / voxel;
    found.error_max_voxels = std::max(found.error_max_voxels, error);
  }
  return found;
}

}  // namespace

TEST_CASE("room: on facing spheres the free room is that to the plane between them") {
  const double d = 0.5;
  for (const double gap_margin : {0.0, 0.1, 0.4}) {
    // The last ones: all of the plane is farther than d.
    for (const double gap : {0.2 * d, 0.01 * d, 2.02 * d, 2.15 * d}) {
      if (gap > 2 * d && gap_margin == 0) continue;
      for (const double voxel : {0.04, 0.02}) {
        CAPTURE(gap_margin);
        CAPTURE(gap);
        CAPTURE(voxel);
        const PairRoom found = pair_room(gap, gap_margin, voxel);
        CHECK(found.error_max_voxels < 0.1);
        CHECK(found.met >= (gap > 2 * d ? 10 : 300));
        CHECK((found.met_beyond > 0) == (gap_margin > 0));
      }
    }
  }
}

TEST_CASE("room: without a margin facing columns end on the medial axis, never beyond") {
  const double d = 0.5;
  for (const double gap : {0.2 * d, 0.01 * d, 1.8 * d, 1.96 * d, 2 * d, 2.02 * d}) {
    for (const double voxel : {0.04, 0.02}) {
      CAPTURE(gap);
      CAPTURE(voxel);
      ExampleOptions shape{.points = 17};
      shape.gap = gap;
      PipelineOptions options = options_for(d, voxel);
      options.march.gap_margin = 0;
      options.march.graded = false;
      const MeshResult result = make_mesh(make_example("sphere-pair", shape), options);
      const Layers& layers = result.mesh.layers;
      double beyond = -1;
      double short_of = 0;
      for (int n = 0; n < layers.report.nodes; ++n) {
        const double side = layers.at(n, 0).x() > 0 ? 1 : -1;
        // The plane of symmetry, x = 0: each sphere is as far from it as the other.
        for (int k = 0; k < layers.levels(); ++k) {
          beyond = std::max(beyond, -side * layers.at(n, k).x());
        }
        if (layers.stop[static_cast<std::size_t>(n)] != Stop::Collided) continue;
        short_of = std::max(short_of, side * layers.at(n, layers.levels() - 1).x());
      }
      CHECK(beyond <= 1e-14);
      CHECK(short_of < 0.03 * voxel);
    }
  }
}

TEST_CASE("room: without a margin no column of two plates passes the middle") {
  for (const double gap : {0.1, 0.37}) {
    PipelineOptions options = options_for(0.5, 0.02);
    options.march.gap_margin = 0;
    const Layers layers = make_mesh(plates(9, gap), options).mesh.layers;
    int met = 0;
    for (int n = 0; n < layers.report.nodes; ++n) {
      const double side = layers.at(n, 0).z() > 0.5 * gap ? 1 : -1;
      CHECK(side * (layers.at(n, layers.levels() - 1).z() - 0.5 * gap) >= -1e-15);
      met += layers.stop[static_cast<std::size_t>(n)] == Stop::Collided ? 1 : 0;
    }
    CHECK(met > 20);
  }
}

namespace {

/// Free height of a column of the channel with a step: its floor is at 0.2 up to x = 1, where the
/// lip is, at 0 behind; the roof at 1. Between floor and roof the medial axis is flat; between lip
/// and roof it is a parabola; columns in the corner behind the step go on along its bisector.
double channel_room(const Vec3& foot) {
  const double u = foot.x() - 1;
  if (foot.z() > 0.9) return u <= 0 ? 0.4 : std::min(0.5, 0.4 + u * u / 1.6);
  if (std::abs(u) > 1e-9) return u > 0 ? 0.5 : 0.4;
  return foot.z() < 0.19 ? 0.5
                         : 0.8 / (1 + std::sqrt(0.5));  // the lip's column rises at 45 degrees
}

}  // namespace

TEST_CASE("room: in a channel with a step the free room is that to the medial axis") {
  for (const double h : {0.1, 0.05, 0.025, 0.0125}) {
    CAPTURE(h);
    const MeshResult result =
        make_mesh(make_example("channel", {.points = 17}), options_for(0.6, h));
    const Layers& layers = result.mesh.layers;
    CHECK(layers.report.collided == layers.report.nodes);
    for (int n = 0; n < layers.report.nodes; ++n) {
      const Vec3 foot = layers.at(n, 0);
      CAPTURE(foot.x());
      CAPTURE(foot.z());
      const double room = layers.room_world[static_cast<std::size_t>(n)];
      CHECK(std::abs(room - channel_room(foot)) < 0.1 * h);
    }
  }
}

TEST_CASE("room: columns that the repair moved keep apart from a facing wall by the margin") {
  const Patches channel = make_example("channel", {.points = 17});
  const Surface roof = build_surface({channel[3]});
  const Surface floor = build_surface({channel[0], channel[1], channel[2]});
  for (const double h : {0.1, 0.05, 0.025, 0.0125}) {
    CAPTURE(h);
    const MeshResult result = make_mesh(channel, options_for(0.6, h));
    const Layers& layers = result.mesh.layers;
    CHECK(result.repair.columns > 100);
    CHECK(result.quality.report.nonpositive_cells == 0);
    double nearest = 1e9;
    for (int n = 0; n < layers.report.nodes; ++n) {
      const bool on_roof = layers.at(n, 0).z() > 0.9;
      for (int k = 0; k < layers.levels(); ++k) {
        const Vec3 point = layers.at(n, k);
        const double own = (on_roof ? roof : floor).wall->closest(point).distance_world;
        const double other = (on_roof ? floor : roof).wall->closest(point).distance_world;
        nearest = std::min(nearest, other - own);
      }
    }
    // Where the walls are 0.8 apart a tenth of 0.4 is left on either side.
    CHECK(nearest > 0.9 * 2 * 0.1 * 0.4);
  }
}

TEST_CASE("room: layers squeezed into a gap keep the first cell while they fit") {
  const MeshResult result = make_mesh(plates(9, 0.1), options_for(0.5, 0.02));
  const Layers& layers = result.mesh.layers;
  for (std::size_t n = 0; n < layers.stop.size(); ++n) {
    if (12 * 1e-3 > layers.height_world[n]) continue;
    CHECK(layers.first_cell_world[n] == doctest::Approx(1e-3).epsilon(1e-6));
  }
}

TEST_CASE("room: the same heights for any number of threads") {
  ExampleOptions shape{.points = 9};
  const auto once = [&] {
    return make_mesh(make_example("u-slot", shape), options_for(0.3, 0.05))
        .mesh.layers.points_world;
  };
  CHECK(on_threads(1, once) == on_threads(2, once));
}

TEST_CASE("room: sharp corners have a bisector, wide ones and facing walls have none") {
  const auto wedge = [](double degrees) {
    ExampleOptions options{.points = 9};
    options.angle = degrees * std::numbers::pi / 180;
    return build_surface(make_example("wedge", options));  // its edge is the z axis, x the bisector
  };
  constexpr double kRise = 0.45;
  const double half = std::numbers::pi / 12;
  const Surface sharp = wedge(30);
  for (const double along : {0.02, 0.1, 0.5}) {
    const Vec3 foot(along * std::cos(half), along * std::sin(half), 0.4);
    const Vec3 away(std::sin(half), -std::cos(half), 0);
    const double bisector = along * std::tan(half);
    for (const double part : {0.1, 0.5, 0.9}) {
      const Vec3 place = foot + part * bisector * away;
      const auto found = bisector_at(sharp, place, kRise, 1.1 * bisector);
      REQUIRE(found);
      CHECK(*found == doctest::Approx(bisector).epsilon(2e-3));
      CHECK(!bisector_at(sharp, place, kRise, 0.95 * bisector));
    }
  }
  CHECK(!bisector_at(wedge(90), {0.3, 0.2, 0.4}, kRise, 1));
  const Surface apart = build_surface(make_example("sphere-pair", {.points = 17}));
  const Vec3 between(0.01, 0, 0);
  CHECK(room_at(apart, between, 1));
  CHECK(!bisector_at(apart, between, kRise, 1));
}
