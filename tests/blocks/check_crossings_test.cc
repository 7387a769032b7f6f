#include "vdb_offset/blocks/check_crossings.h"

#include <doctest/doctest.h>

#include <cstddef>
#include <utility>
#include <vector>

#include "support/hand_made.h"
#include "support/shapes.h"
#include "vdb_offset/surface/surface.h"

using namespace vdb_offset;
using namespace vdb_offset::test;

namespace {

constexpr int kPoints = 4;  // along each edge of a plate
constexpr int kCells = 4;   // of a column
constexpr double kGap = 0.1;

/// Plates a gap apart, whose columns have equal cells up to a height; the upper plate is moved.
MultiBlock facing(const Surface& surface, double height) {
  const auto point = [&](int n, int k) {
    const Vec3& foot = surface.nodes_world[static_cast<std::size_t>(n)];
    const double way = foot.z() < 0.5 * kGap ? 1 : -1;
    return Vec3(foot + way * k * height / kCells * Vec3::UnitZ());
  };
  Layers layers = make_layers(static_cast<int>(surface.nodes_world.size()), kCells, point);
  for (std::size_t n = 0; n < layers.stop.size(); ++n) {
    layers.stop[n] = Stop::Collided;
    layers.height_world[n] = height;
  }
  return build_blocks(surface, std::move(layers));
}

/// Cells of one column that reach past a height by more than rounding.
int past(double height, double where) {
  int count = 0;
  for (int k = 1; k <= kCells; ++k) count += k * height / kCells > where + 1e-9 ? 1 : 0;
  return count;
}

}  // namespace

TEST_CASE("crossings: all cells beyond the facing outer level, and no others") {
  const Surface surface = build_surface(plates(kPoints, kGap));
  const int faces = 2 * (kPoints - 1) * (kPoints - 1);
  for (const double height : {0.04, 0.05, 0.0501, 0.08, 0.099, 0.12}) {
    CAPTURE(height);
    const CrossingsReport found = check_crossings(surface, facing(surface, height));
    const int expected = height > 0.5 * kGap ? faces * past(height, kGap - height) : 0;
    CHECK(found.cells == static_cast<std::uint64_t>(expected));
    CHECK(found.wall_points == (height > kGap ? 2 * kPoints * kPoints : 0));
  }
}

TEST_CASE("crossings: the place is on the wall below") {
  Patches two = plates(kPoints, kGap);
  for (Vec3& point : two[1].points_world) point.x() += 0.9;  // over the last faces alone
  const Surface surface = build_surface(two);
  const CrossingsReport found = check_crossings(surface, facing(surface, 0.06));
  // In x 0.9 to 1 they lie over each other: one row of faces of either.
  CHECK(found.cells == 2 * (kPoints - 1) * past(0.06, kGap - 0.06));
  CHECK(found.place_world.x() > 2.0 / 3);
  CHECK(found.place_world.x() < 0.9 + 1.0 / 3);
  CHECK((found.place_world.z() == 0 || found.place_world.z() == kGap));
}

TEST_CASE("crossings: faces that meet on the wall do not count") {
  const MultiBlock plate = wavy_plate(6, 5, 3);
  Surface surface;
  std::vector<int> nodes;
  for (int n = 0; n < plate.nodes(); ++n) nodes.push_back(n);
  add_patch(surface, "plate", 6, 5, nodes);
  for (int n = 0; n < plate.nodes(); ++n) {
    surface.nodes_world[static_cast<std::size_t>(n)] = plate.layers.at(n, 0);
  }
  CHECK(check_crossings(surface, plate).cells == 0);
}
