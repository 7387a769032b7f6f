// Two dimensions: curves, and one slice of voxels.

#include <doctest/doctest.h>

#include <openvdb/openvdb.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "support/shapes.h"
#include "vdb_offset/core/error.h"
#include "vdb_offset/io/airfoil.h"
#include "vdb_offset/io/obj_curves.h"
#include "vdb_offset/pipeline.h"
#include "vdb_offset/surface/example.h"

using namespace vdb_offset;
using namespace vdb_offset::test;

namespace {

PipelineOptions options_for(double distance, double voxel) {
  PipelineOptions options;
  options.distance_world = distance;
  options.rasterize.voxel_world = voxel;
  options.sweep.tolerance_voxels = 0;
  options.spacing.layers = 32;
  options.spacing.first_cell_world = 1e-4;
  options.spacing.max_growth = 10;
  return options;
}

/// Curves as strips along z, `width` wide, `cells` across.
Patches extruded(const Patches& curves, double width, int cells) {
  Patches strips = curves;
  for (Patch& strip : strips) {
    const Vec3List curve = strip.points_world;
    strip.points_world.clear();
    strip.nj = cells + 1;
    for (int j = 0; j <= cells; ++j) {
      for (const Vec3& p : curve) strip.points_world.emplace_back(p.x(), p.y(), j * width / cells);
    }
  }
  return strips;
}

}  // namespace

TEST_CASE("flat: off a circle columns end at the distance along the radius, in one slice") {
  for (const double h : {0.05, 0.02}) {
    CAPTURE(h);
    const MeshResult result = make_mesh(make_example("circle"), options_for(0.5, h));
    const Layers& layers = result.mesh.layers;
    CHECK(result.surface.flat);
    CHECK(layers.report.reached == layers.report.nodes);
    CHECK(layers.report.distance_error_max < 1e-6);
    double strayed = 0;
    double level_error = 0;
    for (int n = 0; n < layers.report.nodes; ++n) {
      const double z = layers.at(n, 0).z();
      const Vec3 radius = Vec3(layers.at(n, 0) - Vec3(0, 0, z)).normalized();
      for (int k = 0; k < layers.levels(); ++k) {
        CHECK(layers.at(n, k).z() == z);
        const Vec3 p = layers.at(n, k) - Vec3(0, 0, z);
        strayed = std::max(strayed, (p - radius * radius.dot(p)).norm());
        const double height = result.surface.wall->closest(layers.at(n, k)).distance_world;
        const double wanted = layers.spacing.heights_world[static_cast<std::size_t>(k)];
        if (k > 0) level_error = std::max(level_error, std::abs(height / wanted - 1));
      }
    }
    CHECK(strayed < 0.5 * h);
    CHECK(level_error < 1e-6);
    for (auto it = result.field.phi->cbeginValueOn(); it; ++it) REQUIRE(it.getCoord().z() == 0);
    CHECK(result.quality.report.nonpositive_cells == 0);
  }
}

TEST_CASE("flat: an airfoil's columns are those of its extrusion between two planes") {
  double h = 0;
  ExampleOptions shape{.points = 33};
  // Columns of the last one differ from straight ones by about what decides which they are.
  SUBCASE("symmetric") { h = 1.0 / 64; }
  SUBCASE("cambered") {
    h = 0.005;
    shape.naca = "2412";
  }
  const Patches curves = make_example("airfoil", shape);
  const MeshResult plane = make_mesh(curves, options_for(0.1, h));
  const MeshResult space = make_mesh(extruded(curves, 4 * h, 2), options_for(0.1, h));
  CHECK(space.surface.boundaries->list().size() == 2);
  double worst = 0;
  int compared = 0;
  for (int n = 0; n < plane.mesh.layers.report.nodes; ++n) {
    const Vec3 foot = plane.mesh.layers.at(n, 0);
    if (foot.z() != 0) continue;
    for (int m = 0; m < space.mesh.layers.report.nodes; ++m) {
      const Vec3 other = space.mesh.layers.at(m, 0);
      if ((other - foot).head<2>().norm() > 1e-12) continue;
      ++compared;
      for (int k = 0; k < plane.mesh.layers.levels(); ++k) {
        const Vec3 a = plane.mesh.layers.at(n, k);
        const Vec3 b = space.mesh.layers.at(m, k);
        worst = std::max(worst, (a - b).head<2>().norm());
      }
    }
  }
  CHECK(compared == 3 * plane.mesh.layers.report.nodes);
  CHECK(worst < 1e-6);
}

TEST_CASE("flat: a closed curve's block meets itself, an open one's sides are free or cut") {
  const MeshResult ring = make_mesh(make_example("circle", {.points = 9}), options_for(0.2, 0.05));
  REQUIRE(ring.mesh.interfaces.size() == 1);
  CHECK(ring.mesh.interfaces[0].first.block == ring.mesh.interfaces[0].second.block);
  CHECK(ring.mesh.blocks[0].nj == 2);
  Patch line;
  line.name = "line";
  line.ni = 5;
  line.nj = 1;
  for (int i = 0; i < 5; ++i) line.points_world.emplace_back(0.25 * i, 0, 3);
  const MeshResult both = [&] {
    PipelineOptions options = options_for(0.2, 0.05);
    options.surface.side = MarchSide::Both;
    return make_mesh({line}, options);
  }();
  CHECK(both.mesh.blocks.size() == 2);
  CHECK(both.mesh.layers.report.reached == both.mesh.layers.report.nodes);
}

TEST_CASE("flat: a mixture with surfaces, and curves out of one plane, are refused") {
  Patches mixed = make_example("circle", {.points = 9});
  mixed.push_back(make_example("cube", {.points = 5})[0]);
  CHECK_THROWS_WITH_AS(build_surface(mixed), doctest::Contains("is a curve and"), InputError);
  Patches bent = make_example("circle", {.points = 9});
  bent[0].points_world[3].z() = 0.1;
  CHECK_THROWS_WITH_AS(build_surface(bent), doctest::Contains("z = const"), InputError);
}

TEST_CASE("flat: airfoils and outlines by others are meshed as they are") {
  const auto data = shared_data();
  if (!data) {
    MESSAGE("skipped: no shared data beside this clone");
    return;
  }
  int files = 0;
  for (const auto& entry : std::filesystem::directory_iterator(*data + "/airfoil")) {
    const std::string file = entry.path().string();
    CAPTURE(file);
    const bool is_obj = entry.path().extension() == ".obj";
    const Patches curves = is_obj ? read_obj_curves(file) : read_airfoil(file);
    Box box;
    for (const Vec3& p : curves[0].points_world) box.add(p);
    const double chord = box.hi.x() - box.lo.x();
    PipelineOptions options = options_for(0.1 * chord, 0);
    options.spacing.first_cell_world = 1e-4 * chord;
    const MeshResult result = make_mesh(curves, options);
    ++files;
    CHECK(result.mesh.layers.report.left_band == 0);
    if (is_obj) continue;
    // A slender section has no corner that columns could meet in.
    CHECK(result.mesh.layers.report.reached == result.mesh.layers.report.nodes);
    CHECK(result.mesh.layers.report.distance_error_max < 1e-6);
    CHECK(result.quality.report.nonpositive_cells == 0);
  }
  CHECK(files == 9);
}
