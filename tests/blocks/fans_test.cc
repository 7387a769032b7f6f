// Fan blocks from end to end: connections, validity, and what they are for.

#include <doctest/doctest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <utility>

#include "support/face_ranges.h"
#include "vdb_offset/pipeline.h"
#include "vdb_offset/surface/example.h"

namespace vdb_offset::test {
namespace {

struct Case {
  double distance = 0.5;
  int layers = 24;
  double first_cell = 1e-3;
};

MeshResult meshed(Patches patches, int fans, const Case& c = {}) {
  PipelineOptions options;
  options.distance_world = c.distance;
  options.surface.fans = fans;
  options.spacing.layers = c.layers;
  options.spacing.first_cell_world = c.first_cell;
  return make_mesh(std::move(patches), options);
}

void check_faces(const MultiBlock& mesh) {
  check_covered_once(mesh);
  for (const Interface& face : mesh.interfaces) {
    check_interface(mesh, face);
    CHECK(determinant(face) == 1);
  }
}

/// Cells that `cell_quality` calls not positive.
int bad_cells(const MultiBlock& mesh, const Block& block) {
  int bad = 0;
  for (int k = 0; k + 1 < block.nk; ++k) {
    for (int j = 0; j + 1 < block.nj; ++j) {
      for (int i = 0; i + 1 < block.ni; ++i) {
        std::array<Vec3, 8> corners;
        for (std::size_t n = 0; n < 8; ++n) {
          const std::size_t ring = n % 4;
          corners[n] = mesh.point(block, i + (ring == 1 || ring == 2 ? 1 : 0),
                                  j + (ring >= 2 ? 1 : 0), k + (n >= 4 ? 1 : 0));
        }
        bad += cell_quality(corners).positive ? 0 : 1;
      }
    }
  }
  return bad;
}

/// Largest ratio of two edges of one face of the outer level.
double worst_ratio(const MultiBlock& mesh) {
  double worst = 1;
  for (const Block& block : mesh.blocks) {
    const int k = block.nk - 1;
    for (int j = 0; j + 1 < block.nj; ++j) {
      for (int i = 0; i + 1 < block.ni; ++i) {
        const std::array<Vec3, 4> p{mesh.point(block, i, j, k), mesh.point(block, i + 1, j, k),
                                    mesh.point(block, i + 1, j + 1, k),
                                    mesh.point(block, i, j + 1, k)};
        double least = 1e300;
        double most = 0;
        for (std::size_t n = 0; n < 4; ++n) {
          const double length = (p[(n + 1) % 4] - p[n]).norm();
          least = std::min(least, length);
          most = std::max(most, length);
        }
        worst = std::max(worst, most / least);
      }
    }
  }
  return worst;
}

TEST_CASE("fans: a cube's blocks connect, every cell is positive, and the distance is met") {
  for (const int fans : {2, 3, 4}) {
    CAPTURE(fans);
    const MeshResult result = meshed(make_example("cube", {.points = 9}), fans);
    const MultiBlock& mesh = result.mesh;
    CHECK(mesh.blocks.size() == (fans % 2 == 0 ? 42U : 18U));
    CHECK(mesh.interfaces.size() == (fans % 2 == 0 ? 96U : 24U));
    check_faces(mesh);
    for (const Block& block : mesh.blocks) {
      CAPTURE(block.name);
      CHECK(bad_cells(mesh, block) == 0);
    }
    CHECK(result.quality.report.nonpositive_cells == 0);
    const MarchReport& march = mesh.layers.report;
    CHECK(march.reached == march.nodes);
    CHECK(march.distance_error_max < 1e-6);
  }
}

TEST_CASE("fans: the first level of a fan is degenerate, an edge or a corner; all else is wall") {
  const MeshResult result = meshed(make_example("cube", {.points = 5}), 2, {.layers = 12});
  int edges = 0;
  int corners = 0;
  for (const BoundaryFace& face : result.mesh.boundary_faces) {
    const auto block = static_cast<std::size_t>(face.range.block);
    if (face.range.face != BlockFace::KMin) {
      CHECK(face.kind == BoundaryKind::Outer);
      continue;
    }
    const bool is_fan = result.surface.is_fan(block);
    CHECK((face.kind == BoundaryKind::Degenerate) == is_fan);
    CHECK((face.kind == BoundaryKind::Wall) == !is_fan);
    edges += face.name == "edge" ? 1 : 0;
    corners += face.name == "corner" ? 1 : 0;
  }
  CHECK(edges == 12);
  CHECK(corners == 24);
}

/// Largest miss of equal angles between a cube's fan columns, seen from the edge, at a level.
double worst_angle(const MultiBlock& mesh, int level) {
  double worst = 0;
  for (const Block& block : mesh.blocks) {
    if (!block.name.starts_with("fan ")) continue;
    for (int j = 0; j < block.nj; ++j) {
      for (int i = 1; i < block.ni; ++i) {
        const Vec3 a = mesh.point(block, i - 1, j, level) - mesh.point(block, i - 1, j, 0);
        const Vec3 b = mesh.point(block, i, j, level) - mesh.point(block, i, j, 0);
        const double equal = std::numbers::pi / 2 / (block.ni - 1);
        worst = std::max(worst, std::abs(std::atan2(a.cross(b).norm(), a.dot(b)) - equal));
      }
    }
  }
  return worst;
}

TEST_CASE("fans: columns leave an edge in equal angles, and stay apart in the field") {
  const MultiBlock mesh = meshed(make_example("cube", {.points = 9}), 4).mesh;
  CHECK(worst_angle(mesh, 1) < 1e-9);
  // Near an edge the field's directions are off by up to a third of these angles.
  const double equal = std::numbers::pi / 2 / 4;
  CHECK(worst_angle(mesh, mesh.layers.levels() - 1) < equal / 3);
}

TEST_CASE("fans: they even out the outer level around sharp edges") {
  for (const char* name : {"cube", "naca0012-wing"}) {
    CAPTURE(name);
    const Patches patches = make_example(name, {.points = 17});
    const MeshResult plain = meshed(patches, 0);
    const MeshResult opened = meshed(patches, 4);
    CAPTURE(worst_ratio(plain.mesh));
    CAPTURE(worst_ratio(opened.mesh));
    CHECK(worst_ratio(opened.mesh) < worst_ratio(plain.mesh));
    CHECK(opened.quality.report.nonpositive_cells <= plain.quality.report.nonpositive_cells);
  }
}

TEST_CASE(
    "fans: on a boundary plane they stay within it, and their ends there are boundary faces") {
  const MeshResult result = meshed(make_example("naca0012-wing", {.points = 17}), 4);
  const MultiBlock& mesh = result.mesh;
  check_faces(mesh);
  int ends = 0;
  for (const BoundaryFace& face : mesh.boundary_faces) {
    const auto block = static_cast<std::size_t>(face.range.block);
    if (face.kind != BoundaryKind::Boundary || !result.surface.is_fan(block)) continue;
    ++ends;
    for_points(face.range, [&](const Index3& p) {
      CHECK(mesh.point(mesh.blocks[block], p[0], p[1], p[2]).y() == 0);
    });
  }
  CHECK(ends > 0);
}

TEST_CASE("fans: in two dimensions blocks are one cell thick, positive, and at the distance") {
  ExampleOptions shape{.points = 65};
  for (const bool closed : {true, false}) {
    CAPTURE(closed);
    shape.closed = closed;
    const MeshResult result = meshed(make_example("airfoil", shape), 6);
    const MultiBlock& mesh = result.mesh;
    CHECK(mesh.flat);
    check_faces(mesh);
    CHECK(result.surface.report.fans == (closed ? 1 : 2));
    CHECK(result.quality.report.nonpositive_cells == 0);
    CHECK(mesh.layers.report.reached == mesh.layers.report.nodes);
    CHECK(mesh.layers.report.distance_error_max < 1e-6);
    for (const Block& block : mesh.blocks) CHECK(block.nj == 2);
  }
}

TEST_CASE("fans: layers of a family's own hold across a fan") {
  PipelineOptions options;
  options.distance_world = 0.4;
  options.surface.fans = 4;
  options.spacing.layers = 12;
  options.spacing.first_cell_world = 1e-3;
  Patches patches = make_example("cube", {.points = 9});
  const std::string name = patches[0].name;
  options.march.families.push_back({.name = name, .distance_world = 0.2, .first_cell_world = {}});
  const MeshResult result = make_mesh(patches, options);
  const Layers& layers = result.mesh.layers;
  CHECK(result.quality.report.nonpositive_cells == 0);
  for (std::size_t n = 0; n < layers.asked_world.size(); ++n) {
    CHECK(layers.asked_world[n] == layers.asked_world[result.surface.stands_at(n)]);
  }
}

TEST_CASE("fans: where they close at an inner edge, columns that would merge are mended") {
  for (const auto& [example, fans] : {std::pair{"l-bar", 3}, {"wedge", 4}}) {
    CAPTURE(example);
    CAPTURE(fans);
    const Case sparse{.distance = 0.3, .layers = 16};
    const MeshResult result = meshed(make_example(example, {.points = 9}), fans, sparse);
    const MultiBlock& mesh = result.mesh;
    CHECK(result.repair.columns > 100);
    for (std::size_t b = 0; b < mesh.blocks.size(); ++b) {
      const Block& block = mesh.blocks[b];
      CAPTURE(block.name);
      CHECK(bad_cells(mesh, block) == 0);
      if (result.surface.is_fan(static_cast<std::size_t>(block.patch))) continue;
      // As marched they leave a thousandth.
      CHECK(result.quality.report.patches[b].min_scaled_jacobian > 0.2);
    }
    const Layers& layers = mesh.layers;
    for (std::size_t n = 0; n < layers.height_world.size(); ++n) {
      CHECK(layers.height_world[n] > 0.9 * sparse.distance);
    }
  }
}

}  // namespace
}  // namespace vdb_offset::test
