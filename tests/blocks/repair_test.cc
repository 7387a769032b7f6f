#include "vdb_offset/blocks/repair.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "blocks/window.h"
#include "blocks/window_shape.h"
#include "support/marched.h"
#include "support/shapes.h"
#include "support/threads.h"
#include "vdb_offset/blocks/check_crossings.h"
#include "vdb_offset/core/error.h"
#include "vdb_offset/surface/example.h"

namespace vdb_offset::test {
namespace {

struct Repaired {
  Surface surface;
  MultiBlock before;
  MultiBlock after;
  RepairResult result;
};

Repaired repaired(const char* example, const Case& c, int points = 9) {
  Marched m = marched(make_example(example, {.points = points}), c);
  MultiBlock mesh = build_blocks(m.surface, std::move(m.layers));
  Repaired r{std::move(m.surface), mesh, std::move(mesh), {}};
  r.result = repair(r.surface, r.after);
  return r;
}

const Case kBar{.distance = 0.3, .layers = 16};

}  // namespace

TEST_CASE("repair: an inner edge, where columns merge, is left without a folded cell") {
  const Repaired r = repaired("l-bar", kBar, 17);
  const QualityField marched_quality = judge(r.before);
  CHECK(marched_quality.report.min_scaled_jacobian < 0.1);  // else there is nothing to show
  CHECK(r.result.report.windows > 0);
  CHECK(r.result.report.unmended == 0);
  CHECK(r.result.quality.report.nonpositive_cells == 0);
  CHECK(r.result.quality.report.min_scaled_jacobian > 0.3);
}

TEST_CASE("repair: where there is room, columns that moved end at the distance asked for") {
  const Repaired r = repaired("l-bar", kBar);
  const Layers& layers = r.after.layers;
  CHECK(r.result.report.columns > 0);
  CHECK(r.result.report.beyond < 1e-8);
  for (int n = 0; n < r.after.nodes(); ++n) {
    const double end = r.surface.wall->closest(layers.at(n, layers.levels() - 1)).distance_world;
    CHECK(end == doctest::Approx(kBar.distance).epsilon(1e-8));
  }
}

TEST_CASE("repair: first cells are as high as was asked where they have room, in wedges too") {
  for (const double degrees : {45.0, 30.0}) {
    CAPTURE(degrees);
    ExampleOptions options{.points = 9};
    options.angle = degrees / 180 * std::numbers::pi;
    const Case c{.distance = 0.1, .layers = 16, .first_cell = 1e-3};
    Marched m = marched(make_example("wedge", options), c);
    MultiBlock mesh = build_blocks(m.surface, std::move(m.layers));
    const RepairResult result = repair(m.surface, mesh);
    CHECK(result.report.columns > 0);
    CHECK(result.quality.report.nonpositive_cells == 0);
    for (int n = 0; n < mesh.nodes(); ++n) {
      const Layers& layers = mesh.layers;
      const auto height = [&](int level) {
        return m.surface.wall->closest(layers.at(n, level)).distance_world;
      };
      if (height(layers.levels() - 1) < c.layers * c.first_cell) continue;
      CHECK(height(1) == doctest::Approx(c.first_cell).epsilon(0.01));
    }
  }
}

TEST_CASE("repair: asking for more quality leaves the worst cell no worse") {
  Marched m = marched(make_example("l-bar", {.points = 17}),
                      {.distance = 0.08, .layers = 24, .first_cell = 1e-4});
  const MultiBlock mesh = build_blocks(m.surface, std::move(m.layers));
  double least = 0;
  for (const double quality : {0.2, 0.5}) {
    MultiBlock after = mesh;
    const RepairResult result = repair(m.surface, after, {.quality = quality});
    CHECK(result.report.windows > 0);
    CHECK(result.quality.report.min_scaled_jacobian > 0.999 * least);
    least = result.quality.report.min_scaled_jacobian;
  }
}

TEST_CASE("repair: wall nodes and columns outside of windows keep every bit") {
  const Repaired r = repaired("l-bar", kBar);
  int moved = 0;
  for (int n = 0; n < r.after.nodes(); ++n) {
    CHECK(r.after.layers.at(n, 0) == r.before.layers.at(n, 0));
    bool differs = false;
    for (int k = 1; k < r.after.layers.levels(); ++k) {
      differs = differs || r.after.layers.at(n, k) != r.before.layers.at(n, k);
    }
    moved += differs ? 1 : 0;
  }
  CHECK(moved > 0);
  CHECK(moved <= r.result.report.columns);
  CHECK(r.result.report.columns < r.after.nodes());
}

TEST_CASE("repair: a convex body has nothing to repair") {
  const Repaired r = repaired("cube", kBar);
  CHECK(r.result.report.windows == 0);
  CHECK(r.after.layers.points_world == r.before.layers.points_world);
}

TEST_CASE("repair: the first level, low beside the wall's edges, keeps its distance") {
  const Repaired r = repaired("l-bar", kBar);
  const Layers& layers = r.after.layers;
  for (std::size_t n = 0; n < layers.stop.size(); ++n) {
    CHECK(layers.at(static_cast<int>(n), 1) == r.before.layers.at(static_cast<int>(n), 1));
    CHECK(layers.first_cell_world[n] == doctest::Approx(kBar.first_cell).epsilon(1e-6));
    CHECK(layers.height_world[n] > 0.9 * kBar.distance);
    const Vec3& end = layers.at(static_cast<int>(n), layers.levels() - 1);
    CHECK(layers.height_world[n] ==
          doctest::Approx(r.surface.wall->closest(end).distance_world).epsilon(1e-12));
  }
}

TEST_CASE("repair: nodes on boundary planes stay on them") {
  const Repaired r = repaired("channel", {.distance = 0.3, .layers = 12});
  REQUIRE(r.result.report.windows > 0);
  CHECK(r.result.quality.report.nonpositive_cells == 0);
  int on_planes = 0;
  for (int n = 0; n < r.after.nodes(); ++n) {
    const BoundarySet on = r.surface.boundaries_of(static_cast<std::size_t>(n));
    for (std::size_t b = 0; b < r.surface.boundaries->list().size(); ++b) {
      if ((on >> b & 1U) == 0) continue;
      ++on_planes;
      for (int k = 0; k < r.after.layers.levels(); ++k) {
        CHECK(r.surface.boundaries->list()[b].side(r.after.layers.at(n, k)) == 0);
      }
    }
  }
  CHECK(on_planes > 0);
}

TEST_CASE("repair: ends on an internal surface stay on it, or are on it no longer") {
  Case c = kBar;
  // Over the inner floor, rising: a third of what is asked for.
  c.surface.internals = {
      {"screen",
       {rectangle("screen", {5, 5}, Vec3(-1, 0.6, -1), {Vec3(3, 0.15, 0), Vec3(0, 0, 3)})}}};
  const Repaired r = repaired("l-bar", c);
  CHECK(r.result.report.windows > 0);
  CHECK(r.result.quality.report.nonpositive_cells == 0);
  const Boundary& screen = r.surface.boundaries->list()[0];
  int moved = 0;
  for (int n = 0; n < r.after.nodes(); ++n) {
    const int last = r.after.layers.levels() - 1;
    const bool is_on = r.after.layers.ended_on(n) == 0;
    CHECK(is_on == (r.after.layers.stop[static_cast<std::size_t>(n)] == Stop::Internal));
    if (!is_on) continue;
    CHECK(std::abs(screen.side(r.after.layers.at(n, last))) < 1e-12);
    moved += r.after.layers.at(n, last) != r.before.layers.at(n, last) ? 1 : 0;
  }
  CHECK(moved > 20);
  const auto faces = [](const MultiBlock& mesh) {
    return std::ranges::count(mesh.boundary_faces, "screen", &BoundaryFace::name);
  };
  CHECK(faces(r.before) > 0);
  CHECK(faces(r.after) > 0);
}

TEST_CASE("repair: columns beside an internal surface do not go through it") {
  // From x = 0.7 on alone: columns nearer to the inner corner pass beside it.
  const Vec3 corner(0.7, 0.6, -1);
  const Vec3 along(1.3, 0.15, 0);
  Case c = kBar;
  c.surface.internals = {{"tilted", {rectangle("tilted", {5, 5}, corner, {along, Vec3(0, 0, 3)})}}};
  const Repaired r = repaired("l-bar", c);
  CHECK(r.result.report.windows > 0);
  CHECK(r.result.quality.report.nonpositive_cells == 0);
  // Its plane, and x > 0.7, by formula.
  const auto height = [&](const Vec3& p) {
    return (along.x() * (p.y() - corner.y()) - along.y() * (p.x() - corner.x())) / along.norm();
  };
  int beside = 0;
  int through = 0;
  for (int n = 0; n < r.after.nodes(); ++n) {
    for (int k = 1; k < r.after.layers.levels(); ++k) {
      const Vec3& below = r.after.layers.at(n, k - 1);
      const Vec3& above = r.after.layers.at(n, k);
      const double lo = height(below);
      const double hi = height(above);
      if (!(lo < -1e-9 && hi > 1e-9)) continue;
      const double x = below.x() + lo / (lo - hi) * (above.x() - below.x());
      (x > corner.x() ? through : beside) += 1;
    }
  }
  CHECK(through == 0);
  CHECK(beside > 0);
}

TEST_CASE("repair: sharp wedges end low, but valid") {
  ExampleOptions options{.points = 9};
  options.angle = std::numbers::pi / 6;
  Marched m = marched(make_example("wedge", options), {.distance = 0.5, .layers = 12});
  MultiBlock mesh = build_blocks(m.surface, std::move(m.layers));
  const RepairResult result = repair(m.surface, mesh);
  CHECK(result.quality.report.nonpositive_cells == 0);
  CHECK(result.report.lowered > 0);
}

TEST_CASE(
    "repair: sharp corners that open keep their height, whatever the voxels and the distance") {
  for (const double degrees : {20, 45}) {
    ExampleOptions options{.points = 9};
    options.angle = degrees * std::numbers::pi / 180;
    for (const double distance : {0.28, 0.35}) {
      for (const double coarser : {1.0, 4.0}) {
        const Case c{.distance = distance,
                     .voxel = coarser * distance / 12,
                     .layers = 8,
                     .first_cell = 0.05 * distance / 8};
        Marched m = marched(make_example("wedge", options), c);
        MultiBlock mesh = build_blocks(m.surface, std::move(m.layers));
        const RepairResult result = repair(m.surface, mesh);
        CAPTURE(degrees);
        CAPTURE(distance);
        CAPTURE(coarser);
        CHECK(result.quality.report.nonpositive_cells == 0);
        CHECK(check_crossings(m.surface, mesh).cells == 0);
        CHECK(std::ranges::min(mesh.layers.height_world) > 0.6 * distance);
      }
    }
  }
}

TEST_CASE("repair: first cells of the sharpest corners are lower only where there is no room") {
  const double angle = std::numbers::pi / 18;
  ExampleOptions options{.points = 9};
  options.angle = angle;
  const Case c{.distance = 0.5, .voxel = 0.5 / 6, .layers = 64, .first_cell = 1e-4};
  Marched m = marched(make_example("wedge", options), c);
  MultiBlock mesh = build_blocks(m.surface, std::move(m.layers));
  const RepairResult result = repair(m.surface, mesh);
  CHECK(result.quality.report.nonpositive_cells == 0);
  CHECK(check_crossings(m.surface, mesh).cells == 0);
  const double nearest = 0.125 * std::tan(angle / 2);  // bisector over the nodes next to the edge
  REQUIRE(nearest > c.layers * c.first_cell);
  CHECK(std::ranges::min(mesh.layers.first_cell_world) > 0.95 * c.first_cell);
}

TEST_CASE("repair: columns of sharp wedges are not lowered round after round") {
  ExampleOptions options{.points = 9};
  options.angle = std::numbers::pi / 9;
  const Case c{.distance = 0.5, .layers = 12, .first_cell = 2e-3};
  Marched m = marched(make_example("wedge", options), c);
  MultiBlock mesh = build_blocks(m.surface, std::move(m.layers));
  const RepairResult result = repair(m.surface, mesh);
  CHECK(result.quality.report.nonpositive_cells == 0);
  CHECK(result.quality.report.min_scaled_jacobian > 0.05);
  CHECK(check_crossings(m.surface, mesh).cells == 0);
  CHECK(std::ranges::min(mesh.layers.height_world) > 0.025 * c.distance);  // where it is narrowest
}

TEST_CASE("repair: coarse voxels cost a sharp corner no first cell that has room") {
  ExampleOptions options{.points = 9};
  options.angle = std::numbers::pi / 6;
  const Case c{.distance = 0.5, .voxel = 0.2, .layers = 12, .first_cell = 2e-3};
  Marched m = marched(make_example("wedge", options), c);
  MultiBlock mesh = build_blocks(m.surface, std::move(m.layers));
  const RepairResult result = repair(m.surface, mesh);
  CHECK(result.quality.report.nonpositive_cells == 0);
  const auto& first = mesh.layers.first_cell_world;
  CHECK(std::ranges::min(first) == doctest::Approx(c.first_cell).epsilon(1e-6));
}

TEST_CASE("repair: where the field bends along inner edges, columns go on behind the bend") {
  const Case c{.distance = 0.5, .layers = 12, .first_cell = 1e-3};
  Marched m = marched(make_example("draft-tube", {.points = 9}), c);
  MultiBlock mesh = build_blocks(m.surface, std::move(m.layers));
  const RepairResult result = repair(m.surface, mesh);
  CHECK(result.quality.report.nonpositive_cells == 0);
  CHECK(std::ranges::min(mesh.layers.height_world) > 0.1 * c.distance);
}

TEST_CASE("repair: the same bits on any number of threads") {
  const auto points = [&] { return repaired("l-bar", kBar).after.layers.points_world; };
  CHECK(on_threads(1, points) == on_threads(4, points));
}

TEST_CASE("repair: off leaves blocks as marched, judged") {
  Marched m = marched(make_example("l-bar", {.points = 9}), kBar);
  MultiBlock mesh = build_blocks(m.surface, std::move(m.layers));
  const Vec3List before = mesh.layers.points_world;
  const RepairResult result = repair(m.surface, mesh, {.on = false});
  CHECK(mesh.layers.points_world == before);
  CHECK(result.report.windows == 0);
  CHECK(result.quality.scaled_jacobian.size() == mesh.blocks.size());
}

TEST_CASE("repair: windows that do not fit the memory are refused, and the blocks stay") {
  Marched m = marched(make_example("l-bar", {.points = 9}), kBar);
  MultiBlock mesh = build_blocks(m.surface, std::move(m.layers));
  const Vec3List before = mesh.layers.points_world;
  CHECK_THROWS_AS(repair(m.surface, mesh, {.memory_bytes = 100000}), LimitError);
  CHECK(mesh.layers.points_world == before);
}

TEST_CASE("repair: options out of range are refused") {
  for (const double quality : {-0.1, 1.0, std::numeric_limits<double>::quiet_NaN()}) {
    CHECK_THROWS_AS((RepairOptions{.quality = quality}.validate()), InputError);
  }
}

TEST_CASE("windows: a part that is cut out and put back changes its free columns alone") {
  const Repaired r = repaired("l-bar", kBar, 5);
  const ColumnGraph graph(r.before);
  const std::vector<bool> all(static_cast<std::size_t>(r.before.nodes()), true);
  WindowShape whole = make_shape(r.before, find_windows(graph, all).front(), 0.2);
  const ColumnGraph slots(whole.window.faces, whole.window.nodes.size());
  std::vector<bool> some(all.size(), false);
  some[3] = some[4] = true;
  const Window part = find_windows(slots, some).front();
  WindowShape cut = cut_out(whole, part);
  REQUIRE(part.free >= 1);
  CHECK(cut.window.nodes[0] == whole.window.nodes[static_cast<std::size_t>(part.nodes[0])]);
  const ColumnVector before = whole.points_world;
  const Vec3 moved(1, 2, 3);
  for (std::size_t s = 0; s < part.nodes.size(); ++s) cut.points_world.set(s, 2, moved);
  put_back(cut, part, whole);
  for (std::size_t s = 0; s < whole.window.nodes.size(); ++s) {
    const auto end = part.nodes.begin() + static_cast<std::ptrdiff_t>(part.free);
    const bool is_free = std::find(part.nodes.begin(), end, static_cast<int>(s)) != end;
    CHECK(whole.points_world.get(s, 2) == (is_free ? moved : before.get(s, 2)));
    CHECK(whole.points_world.get(s, 1) == before.get(s, 1));
  }
}

TEST_CASE("windows: marked columns that touch are one, with the faces around them") {
  const Repaired r =
      repaired("cube", {.distance = 0.1, .voxel = 0.05, .layers = 2, .first_cell = 0.04}, 5);
  const ColumnGraph graph(r.before);
  std::vector<bool> marked(static_cast<std::size_t>(r.before.nodes()), false);
  const Block& block = r.before.blocks[0];
  const Block& other = r.before.blocks[1];
  marked[static_cast<std::size_t>(block.column(2, 2))] = true;
  marked[static_cast<std::size_t>(other.column(2, 2))] = true;
  std::vector<Window> windows = find_windows(graph, marked);
  REQUIRE(windows.size() == 2);
  CHECK(windows[0].free == 1);
  CHECK(windows[0].faces.size() == 4);
  CHECK(windows[0].nodes.size() == 9);
  widen(graph, 1, marked);
  windows = find_windows(graph, marked);
  REQUIRE(windows.size() == 2);
  CHECK(windows[0].free == 9);
  CHECK(windows[0].faces.size() == 16);
  widen(graph, 5, marked);
  CHECK(find_windows(graph, marked).size() == 1);  // they meet
}

}  // namespace vdb_offset::test
