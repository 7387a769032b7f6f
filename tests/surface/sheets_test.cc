#include "vdb_offset/surface/sheets.h"

#include <doctest/doctest.h>

#include "support/shapes.h"
#include "vdb_offset/surface/surface.h"

namespace vdb_offset {
namespace {

constexpr int kCells = 4;
const Vec3 kX = Vec3::UnitX();
const Vec3 kY = Vec3::UnitY();
const Vec3 kZ = Vec3::UnitZ();

/// The unit cube and a sheet of kCells x kCells cells.
Surface cube_and(const Vec3& corner, const std::array<Vec3, 2>& sides,
                 MarchSide side = MarchSide::Along) {
  const std::array<int, 2> points{kCells + 1, kCells + 1};
  const Vec3 o = Vec3::Zero();
  SurfaceOptions options;
  options.side = side;
  options.open_edges = OpenEdges::Splay;
  return build_surface(
      {test::rectangle("floor", points, o, {kY, kX}), test::rectangle("roof", points, kZ, {kX, kY}),
       test::rectangle("front", points, o, {kX, kZ}), test::rectangle("back", points, kY, {kZ, kX}),
       test::rectangle("left", points, o, {kZ, kY}), test::rectangle("right", points, kX, {kY, kZ}),
       test::rectangle("sheet", points, corner, sides)},
      options);
}

TEST_CASE("sheets: one in a solid is found with all its triangles, one in a room is not") {
  const Vec3 corner(0.2, 0.3, 0.45);
  const Surface body = cube_and(corner, {0.5 * kX, 0.5 * kY});
  const std::vector<Sheet> sheets = find_sheets(body);
  REQUIRE(sheets.size() == 1);
  CHECK(body.patches[static_cast<std::size_t>(sheets[0].patch)].name == "sheet");
  CHECK(body.patches[static_cast<std::size_t>(sheets[0].other)].name == "left");
  CHECK(sheets[0].faces == 2 * kCells * kCells);
  CHECK(sheets[0].edges == 0);
  CHECK(sheets[0].place_world.z() == corner.z());
  CHECK(find_sheets(cube_and(corner, {0.5 * kX, 0.5 * kY}, MarchSide::Against)).empty());
  CHECK(find_sheets(cube_and(corner, {0.5 * kX, 0.5 * kY}, MarchSide::Both)).empty());
}

TEST_CASE("sheets: of one that goes through a solid the part within counts") {
  // Two of its four columns of cells, from x = 0 to 1.
  const std::vector<Sheet> sheets = find_sheets(cube_and({-0.5, 0.25, 0.55}, {2 * kX, 0.5 * kY}));
  REQUIRE(sheets.size() == 1);
  CHECK(sheets[0].faces == 2 * 2 * kCells);
}

TEST_CASE("sheets: one that stands on a face or an edge is found with its edges there") {
  const std::array<Vec3, 2> upright{0.7 * kX, kZ};
  const auto at_y = [&](double y, double above) {
    return find_sheets(cube_and({0.1, y, 1 + above}, upright));
  };
  for (const double y : {0.0, 0.45}) {
    const std::vector<Sheet> sheets = at_y(y, 0);
    REQUIRE(sheets.size() == 1);
    CHECK(sheets[0].faces == 0);
    CHECK(sheets[0].edges == kCells);
  }
  const double reach = kOnShape * 0.7 / kCells;
  CHECK(at_y(0.45, 0.9 * reach).size() == 1);
  CHECK(at_y(0.45, 1.1 * reach).empty());
}

}  // namespace
}  // namespace vdb_offset
