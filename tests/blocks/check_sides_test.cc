#include "vdb_offset/blocks/check_sides.h"

#include <doctest/doctest.h>

#include "support/marched.h"
#include "support/shapes.h"

namespace vdb_offset::test {
namespace {

constexpr int kCells = 4;  // along each side of a plate of length 1
constexpr int kLayers = 6;
constexpr double kDistance = 0.3;

/// A plate at z = 0, columns upright.
Marched plate(SurfaceOptions surface) {
  surface.open_edges = OpenEdges::Splay;
  Case c{.distance = kDistance, .layers = kLayers, .first_cell = 0.03, .surface = surface};
  c.march.splay = 0;
  return marched(
      {rectangle("plate", {kCells + 1, kCells + 1}, Vec3::Zero(), {Vec3::UnitX(), Vec3::UnitY()})},
      c);
}

Patch sheet_at(double x, double top) {
  return rectangle("sheet", {3, 3}, Vec3(x, -1, -0.1), {Vec3(0, 3, 0), Vec3(0, 0, top + 0.1)});
}

}  // namespace

TEST_CASE("check_sides: a sheet between grid lines cuts the cells of a strip, as high as it is") {
  SurfaceOptions surface;
  surface.internals = {{"sheet", {sheet_at(0.6, 1)}}};
  Marched m = plate(surface);
  MultiBlock mesh = build_blocks(m.surface, std::move(m.layers));
  const SidesReport report = check_sides(m.surface, mesh);
  CHECK(report.beyond.empty());
  REQUIRE(report.cut.size() == 1);
  CHECK(report.cut[0].name == "sheet");
  CHECK(report.cut[0].count == kCells * kLayers);
  CHECK(report.cut[0].place_world.x() == doctest::Approx(0.6));
}

TEST_CASE("check_sides: a sheet on a grid line cuts nothing") {
  SurfaceOptions surface;
  surface.internals = {{"sheet", {sheet_at(0.5, 1)}}};
  Marched m = plate(surface);
  CHECK(check_sides(m.surface, build_blocks(m.surface, std::move(m.layers))).cut.empty());
}

TEST_CASE("check_sides: a point beyond a boundary is counted, with how far it is") {
  SurfaceOptions surface;
  surface.planes = {{"side", {Vec3::Zero(), Vec3::UnitX()}}};
  Marched m = plate(surface);
  MultiBlock mesh = build_blocks(m.surface, std::move(m.layers));
  CHECK(check_sides(m.surface, mesh).beyond.empty());
  int inner = 0;  // a node off the plane
  while (m.surface.nodes_world[static_cast<std::size_t>(inner)].x() < 0.1) ++inner;
  mesh.layers.points_world[static_cast<std::size_t>(inner * (kLayers + 1) + 2)].x() = -0.01;
  const SidesReport report = check_sides(m.surface, mesh);
  REQUIRE(report.beyond.size() == 1);
  CHECK(report.beyond[0].name == "side");
  CHECK(report.beyond[0].count == 1);
  CHECK(report.beyond[0].farthest_world == doctest::Approx(0.01));
}

}  // namespace vdb_offset::test
