// Layers over whole faces keep from facing walls and their layers, not at nodes alone.

#include "vdb_offset/march/face_room.h"

#include <doctest/doctest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "support/inside.h"
#include "support/layers.h"
#include "support/polygons.h"
#include "support/shapes.h"
#include "support/threads.h"
#include "vdb_offset/surface/example.h"

using namespace vdb_offset;
using namespace vdb_offset::test;

namespace {

const Eigen::Matrix3d kAsItIs = Eigen::Matrix3d::Identity();

/// A box with as many cells along each edge as said, from its least corner.
Patches box(const std::string& name, const Vec3& size, std::array<int, 3> cells) {
  const Vec3 x = size.x() * Vec3::UnitX();
  const Vec3 y = size.y() * Vec3::UnitY();
  const Vec3 z = size.z() * Vec3::UnitZ();
  const auto [i, j, k] = cells;
  const Vec3 none = Vec3::Zero();
  return {rectangle(name + " 1", {j + 1, i + 1}, none, {y, x}),
          rectangle(name + " 2", {i + 1, j + 1}, z, {x, y}),
          rectangle(name + " 3", {i + 1, k + 1}, none, {x, z}),
          rectangle(name + " 4", {k + 1, i + 1}, y, {z, x}),
          rectangle(name + " 5", {k + 1, j + 1}, none, {z, y}),
          rectangle(name + " 6", {j + 1, k + 1}, x, {y, z})};
}

Patches sphere(double radius, int points, const Vec3& centre) {
  Patches patches = make_example("sphere", {.points = points});
  for (Patch& patch : patches) patch.name += " of the sphere";
  return mapped(std::move(patches), radius * kAsItIs, centre);
}

Patches both(Patches one, const Patches& other) {
  one.insert(one.end(), other.begin(), other.end());
  return one;
}

/// The height of the lowest column of a range of blocks.
double lowest(const MultiBlock& mesh, std::size_t first, std::size_t end) {
  double height = 1e300;
  for (std::size_t b = first; b < end; ++b) {
    for (const int column : mesh.blocks[b].columns) {
      height = std::min(height, mesh.layers.height_world[static_cast<std::size_t>(column)]);
    }
  }
  return height;
}

struct Bodies {
  std::string name;
  Patches first, second;
  double distance;
  double gap;
};

/// Bodies whose faces are wide beside the gap between them.
std::vector<Bodies> bodies() {
  const Patches cube = box("cube", Vec3::Constant(0.5), {1, 1, 1});
  const Patches plate = box("plate", {1, 1, 0.2}, {1, 1, 1});
  const Eigen::Matrix3d turn = Eigen::AngleAxisd(0.15, Vec3::UnitX()).toRotationMatrix();
  const Eigen::Matrix3d across = Eigen::AngleAxisd(0.6, Vec3::UnitZ()).toRotationMatrix();
  return {{"a sphere over a cube's face", cube, sphere(0.1, 9, {0.27, 0.22, 0.65}), 0.2, 0.05},
          {"a sphere over a large one", sphere(1, 17, {0, 0, -1}),
           sphere(0.1, 9, {0.01, 0.02, 0.12}), 0.2, 0.02},
          {"a pole without nodes over a plate", plate,
           mapped(box("pole", {3, 0.02, 0.02}, {1, 1, 1}), across, {-0.8, -0.3, 0.25}), 0.2, 0.05},
          {"a pole that stands upright over a plate", plate,
           mapped(box("pole", {0.02, 0.02, 1}, {1, 1, 4}), kAsItIs, {0.53, 0.48, 0.25}), 0.2, 0.05},
          {"plates of unlike faces", plate,
           mapped(box("upper", {1, 1, 0.2}, {8, 8, 2}), kAsItIs, {0.03, 0.01, 0.23}), 0.2, 0.03},
          {"plates at an angle", plate,
           mapped(box("upper", {1, 1, 0.2}, {8, 8, 2}), turn, {0.03, 0.01, 0.23}), 0.2, 0.03},
          {"a small box over the middle of a face", plate,
           mapped(box("small", Vec3::Constant(0.1), {4, 4, 4}), kAsItIs, {0.45, 0.5, 0.24}), 0.2,
           0.04}};
}

}  // namespace

TEST_CASE("face room: no point of one body or its layers lies in the layers of another") {
  for (const Bodies& pair : bodies()) {
    CAPTURE(pair.name);
    PipelineOptions options = options_for(pair.distance, 0.02);
    options.spacing.layers = 4;
    const MeshResult result = make_mesh(both(pair.first, pair.second), options);
    CHECK(result.crossings.cells == 0);
    CHECK(samples_inside(result.mesh, 0, pair.first.size()) == 0);
    CHECK(result.quality.report.nonpositive_cells == 0);
    // What is free between two walls is shared, and no more is taken away than margin and rounding.
    const double least = 0.98 * 0.9 * 0.5 * pair.gap;
    CHECK(lowest(result.mesh, 0, pair.first.size()) > least);
    CHECK(lowest(result.mesh, pair.first.size(), result.mesh.blocks.size()) > least);
  }
}

TEST_CASE("face room: columns that the repair moved keep their faces from facing ones too") {
  PipelineOptions options = options_for(0.15, 0);
  options.spacing.layers = 8;
  options.march.gap_margin = 0;
  const MeshResult result = make_mesh(make_example("u-slot", {.points = 7}), options);
  CHECK(result.repair.columns > 0);
  CHECK(result.quality.report.nonpositive_cells == 0);
  CHECK(result.crossings.cells == 0);
  // Patches 3 and 4 are one wall of the slot and the face beside it.
  CHECK(samples_inside(result.mesh, 2, 4) == 0);
}

TEST_CASE("face room: polygons are kept apart as grids are") {
  for (const Bodies& pair : {bodies()[0], bodies()[6]}) {
    CAPTURE(pair.name);
    PipelineOptions options = options_for(pair.distance, 0.02);
    options.spacing.layers = 4;
    Patches first;
    for (const Patch& patch : pair.first) first.push_back(as_triangles(patch));
    const MeshResult result = make_mesh(both(first, as_polygons(pair.second)), options);
    CHECK(result.crossings.cells == 0);
    CHECK(samples_inside(result.mesh, 0, first.size()) == 0);
    CHECK(lowest(result.mesh, 0, first.size()) > 0.98 * 0.9 * 0.5 * pair.gap);
  }
}

TEST_CASE("face room: the margin is left between a wide face's layers and a small sphere's") {
  const double gap = 0.05;
  for (const double margin : {0.1, 0.3}) {
    CAPTURE(margin);
    PipelineOptions options = options_for(0.2, 0.02);
    options.spacing.layers = 4;
    options.march.gap_margin = margin;
    const Patches cube = box("cube", Vec3::Constant(0.5), {1, 1, 1});
    const MeshResult result = make_mesh(both(cube, sphere(0.1, 9, {0.25, 0.25, 0.65})), options);
    // Columns at the cube's corners lean by the same angle all: its layers over the face are even,
    // and as high as from the points of their ends to the face.
    const double room = 0.5 * gap;
    const Layers& layers = result.mesh.layers;
    int capped = 0;
    for (std::size_t n = 0; n < layers.stop.size(); ++n) {
      if (!(layers.at(static_cast<int>(n), 0).z() == 0.5) ||
          layers.at(static_cast<int>(n), 0).x() > 0.5)
        continue;
      ++capped;
      const double height = layers.at(static_cast<int>(n), layers.levels() - 1).z() - 0.5;
      CHECK(height <= (1 - margin) * room * (1 + 1e-2));
      CHECK(height > 0.98 * (1 - margin) * room);
      CHECK(layers.stop[n] == Stop::Collided);
    }
    CHECK(capped == 4);
  }
}

TEST_CASE("face room: in two dimensions a needle stays out of the layers over a long edge") {
  const auto loop = [](const std::string& name, const Vec3List& corners, int cells) {
    Patch curve{name, "", 1, 1, {}};
    for (std::size_t c = 0; c < corners.size(); ++c) {
      const Vec3& to = corners[(c + 1) % corners.size()];
      for (int n = 0; n < cells; ++n) {
        curve.points_world.push_back(corners[c] + (to - corners[c]) * n / cells);
      }
    }
    curve.points_world.push_back(corners.front());
    curve.ni = static_cast<int>(curve.points_world.size());
    return curve;
  };
  for (const int cells : {1, 2, 4}) {
    CAPTURE(cells);
    const double tip = cells == 1 ? 0.25 : 0.5 - 0.25 / cells;
    const Patches curves{
        loop("square", {{0, 0, 0}, {0.5, 0, 0}, {0.5, 0.5, 0}, {0, 0.5, 0}}, cells),
        loop("needle", {{tip, 0.6, 0}, {tip + 0.08, 1, 0}, {tip + 0.04, 1, 0}}, 16)};
    const MeshResult result = make_mesh(curves, options_for(0.2, 0.02));
    CHECK(result.crossings.cells == 0);
    // Along the outer level over the top edge: below the tip by its part of the gap.
    const Block& square = result.mesh.blocks[0];
    double highest = 0;
    for (int i = 0; i + 1 < square.ni; ++i) {
      const Vec3& from = result.mesh.point(square, i, 0, square.nk - 1);
      const Vec3& to = result.mesh.point(square, i + 1, 0, square.nk - 1);
      if ((from.x() - tip) * (to.x() - tip) > 0 || from.y() < 0.5 || to.y() < 0.5) continue;
      const double part = (tip - from.x()) / (to.x() - from.x());
      highest = std::max(highest, from.y() + part * (to.y() - from.y()));
    }
    CHECK(highest < 0.5 + 1.01 * 0.9 * 0.05);
    CHECK(highest > 0.5 + 0.98 * 0.9 * 0.05);
  }
}

TEST_CASE("face room: layers that are far from all others are as they were, wide faces too") {
  const Patches cube = box("cube", Vec3::Constant(0.5), {1, 1, 1});
  const PipelineOptions options = options_for(0.2, 0.02);
  const Layers alone = make_mesh(cube, options).mesh.layers;
  const Layers beside =
      make_mesh(both(cube, sphere(0.1, 9, {0.25, 0.25, 1.05})), options).mesh.layers;
  for (std::size_t p = 0; p < alone.points_world.size(); ++p) {
    CHECK(alone.points_world[p] == beside.points_world[p]);
  }
}

TEST_CASE("face room: the same for any number of threads") {
  const Bodies pair = bodies()[1];
  const auto once = [&] {
    return make_mesh(both(pair.first, pair.second), options_for(pair.distance, 0.03))
        .mesh.layers.points_world;
  };
  CHECK(on_threads(1, once) == on_threads(2, once));
}
