#include "blocks/lower_inverted.h"

#include <doctest/doctest.h>

#include "blocks/window.h"
#include "support/marched.h"
#include "vdb_offset/blocks/quality.h"
#include "vdb_offset/surface/example.h"

using namespace vdb_offset;
using namespace vdb_offset::test;

TEST_CASE("lower_inverted: columns sink to below the cells that are inverted, and no others") {
  Marched m = marched(make_example("sphere", {.points = 9}), {.distance = 0.2, .layers = 16});
  MultiBlock mesh = build_blocks(m.surface, std::move(m.layers));
  CHECK(lower_inverted(m.surface, ColumnGraph(mesh), mesh) == 0);
  // Half-way up a column goes aside, farther than the next one is.
  const int node = mesh.blocks[0].column(4, 4);
  const int next = mesh.blocks[0].column(5, 4);
  const int far = mesh.blocks[0].column(0, 0);
  const auto levels = static_cast<std::size_t>(mesh.layers.levels());
  const Vec3 aside = 2 * (mesh.layers.at(next, 0) - mesh.layers.at(node, 0));
  for (std::size_t k = levels / 2; k < levels; ++k) {
    mesh.layers.points_world[static_cast<std::size_t>(node) * levels + k] += aside;
  }
  REQUIRE(judge(mesh).report.nonpositive_cells > 0);
  const double half = mesh.layers.heights(static_cast<std::size_t>(node))[levels / 2];
  CHECK(lower_inverted(m.surface, ColumnGraph(mesh), mesh) > 0);
  CHECK(judge(mesh).report.nonpositive_cells == 0);
  CHECK(mesh.layers.height_world[static_cast<std::size_t>(node)] <= half);
  CHECK(mesh.layers.height_world[static_cast<std::size_t>(node)] > 0.25 * half);
  CHECK(mesh.layers.height_world[static_cast<std::size_t>(far)] == doctest::Approx(0.2));
}
