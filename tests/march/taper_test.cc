// Layers that taper to nothing where a smooth wall goes on without.

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "support/layers.h"
#include "support/neighbours.h"
#include "support/shapes.h"
#include "vdb_offset/march/march.h"
#include "vdb_offset/surface/example.h"

using namespace vdb_offset;
using namespace vdb_offset::test;

namespace {

/// The three patches of a sphere around (1, 1, 1) have layers, the three others have none.
MeshResult half_a_sphere(int points, PipelineOptions options) {
  Patches sphere = make_example("sphere", {.points = points});
  for (Patch& patch : sphere) {
    const bool bare = patch.at(patch.ni / 2, patch.nj / 2).sum() < 0;
    patch.family = bare ? "bare" : "body";
  }
  options.march.families = {{"bare", {}, {}, true}};
  return make_mesh(sphere, options);
}

/// Grid edges that two blocks share, counted at each; and those at the open side.
struct Sides {
  int shared = 0;
  int open = 0;
};
Sides sides_of(const Surface& surface) {
  Sides sides;
  for (const Edge& edge : surface.topology.edges) {
    (edge.kind == EdgeKind::Interface ? sides.shared : sides.open) += edge.first.cells();
  }
  return sides;
}

}  // namespace

TEST_CASE("taper: where a smooth wall goes on without layers they taper to nothing, smoothly") {
  const double d = 0.4;
  for (const int points : {9, 33}) {
    CAPTURE(points);
    PipelineOptions options = options_for(d, 0.04);
    options.repair.on = false;
    options.surface.open_edges = OpenEdges::Refuse;
    const MeshResult result = half_a_sphere(points, options);
    const Surface& surface = result.surface;
    const Layers& layers = result.mesh.layers;
    CHECK(surface.boundaries == nullptr);  // nor a plane through what is left open
    CHECK(surface.report.taper_edges == 6 * (points - 1));
    CHECK(sides_of(surface).shared == 3 * (points - 1));
    CHECK(sides_of(surface).open == 6 * (points - 1));
    CHECK(result.quality.report.nonpositive_cells == 0);
    CHECK(result.quality.report.min_scaled_jacobian > 0.5);
    const std::vector<int>& ends = surface.taper_nodes;
    REQUIRE(ends.size() == 6 * static_cast<std::size_t>(points - 1));
    double way_error = 0;
    for (int n = 0; n < layers.report.nodes; ++n) {
      const auto at = static_cast<std::size_t>(n);
      const double height = layers.height_world[at];
      const double real = surface.wall->closest(layers.at(n, layers.levels() - 1)).distance_world;
      CHECK(real == doctest::Approx(height).epsilon(1e-6));
      double way = 1e9;
      for (const int end : ends)
        way = std::min(way, edge_length(surface, at, static_cast<std::size_t>(end)));
      if (way == 0) CHECK(height == doctest::Approx(kTaperEnd * d).epsilon(1e-9));
      // Straight ways are shorter than those along grid lines.
      const double part = std::min(1.0, way / (kTaperLength * d));
      way_error = std::max(way_error, (0.99 * part * part * (3 - 2 * part) + 0.01) * d - height);
    }
    CHECK(way_error < 1e-6 * d);
    CHECK(layers.report.reached > 0);
    for_neighbours(surface, [&](std::size_t a, std::size_t b) {
      const double step = std::abs(layers.height_world[a] - layers.height_world[b]);
      CHECK(step <= 1.5 / kTaperLength * edge_length(surface, a, b) * (1 + 1e-9));
    });
  }
}

TEST_CASE("taper: first cells stay as they are where layers taper, if all of them fit") {
  PipelineOptions options = options_for(0.4, 0.04);
  options.spacing.first_cell_world = 2e-4;  // twelve of them are 0.0024: less than 1 % of 0.4
  const MeshResult result = half_a_sphere(17, options);
  CHECK(result.quality.report.nonpositive_cells == 0);
  CHECK(result.quality.report.first_cell_min == doctest::Approx(2e-4).epsilon(1e-6));
  CHECK(result.quality.report.first_cell_max == doctest::Approx(2e-4).epsilon(1e-6));
  for (const int n : result.surface.taper_nodes) {
    CHECK(result.mesh.layers.height_world[static_cast<std::size_t>(n)] ==
          doctest::Approx(12 * 2e-4).epsilon(1e-9));
  }
}

TEST_CASE("taper: along one edge layers taper up to 26 degrees and march on the ramp beyond") {
  // A floor in x > 0; behind its edge x = 0 a ramp without layers, level at y = 0, steep at y = 1.
  const double steepest = 1.2;
  Patches wall{rectangle("floor", {25, 25}, Vec3(0, 0, 0), {Vec3::UnitX(), Vec3::UnitY()}),
               make_patch("ramp", 25, 25, [&](double u, double v) -> Vec3 {
                 const double x = 1 - u;
                 return {-x * std::cos(steepest * v), v, x * std::sin(steepest * v)};
               })};
  PipelineOptions options = options_for(0.2, 0.02);
  options.surface.planes = {{"x = 1", {Vec3(1, 0, 0), Vec3::UnitX()}}};
  options.march.families = {{"ramp", {}, {}, true}};
  const MeshResult result = make_mesh(wall, options);
  const Layers& layers = result.mesh.layers;
  CHECK(result.quality.report.nonpositive_cells == 0);
  REQUIRE(result.surface.boundaries->list().size() == 4);  // those at both sides too
  const Boundary& ramp = result.surface.boundaries->list()[1];
  CHECK(ramp.name() == "ramp");
  int tapering = 0;
  int on = 0;
  for (int n = 0; n < layers.report.nodes; ++n) {
    const Vec3 foot = layers.at(n, 0);
    if (foot.x() != 0) continue;
    const auto at = static_cast<std::size_t>(n);
    const double angle = steepest * foot.y();
    if (angle < 0.40) {
      ++tapering;
      CHECK(layers.height_world[at] < 0.0101 * 0.2);
    } else if (angle > 0.52) {
      ++on;
      CHECK((result.surface.boundaries_of(at) >> 1U & 1U) == 1);
      for (int k = 0; k < layers.levels(); ++k) CHECK(std::abs(ramp.side(layers.at(n, k))) < 1e-9);
    }
  }
  CHECK(tapering >= 8);
  CHECK(on >= 12);
}

TEST_CASE("taper: in two dimensions half a circle tapers to nothing at both its ends") {
  const auto half = [](const char* name, double from) {
    Patch patch;
    patch.name = name;
    patch.ni = 65;
    patch.nj = 1;
    for (int i = 0; i < patch.ni; ++i) {
      const double angle = std::numbers::pi * (from - i / 64.0);
      patch.points_world.emplace_back(2 * std::cos(angle), 2 * std::sin(angle), 0);
    }
    return patch;
  };
  PipelineOptions options = options_for(0.4, 0.04);
  options.march.families = {{"lower", {}, {}, true}};
  const MeshResult result = make_mesh({half("upper", 1), half("lower", 2)}, options);
  CHECK(result.quality.report.nonpositive_cells == 0);
  REQUIRE(result.surface.taper_nodes.size() == 4);  // two, and their copies
  const Layers& layers = result.mesh.layers;
  for (const int n : result.surface.taper_nodes) {
    CHECK(layers.height_world[static_cast<std::size_t>(n)] ==
          doctest::Approx(kTaperEnd * 0.4).epsilon(1e-9));
  }
  CHECK(layers.report.reached > 0);
  CHECK(*std::max_element(layers.height_world.begin(), layers.height_world.end()) ==
        doctest::Approx(0.4).epsilon(1e-6));
}

TEST_CASE("taper: in two dimensions too columns end on a part without layers that is at an angle") {
  const auto line = [](const char* name, const Vec3& from, const Vec3& to) {
    Patch patch;
    patch.name = name;
    patch.ni = 17;
    patch.nj = 1;
    for (int i = 0; i < patch.ni; ++i) patch.points_world.push_back(from + i / 16.0 * (to - from));
    return patch;
  };
  for (const double lean : {-0.1, 0.0, 0.2}) {
    CAPTURE(lean);
    PipelineOptions options = options_for(0.2, 0.02);
    options.march.families = {{"side", {}, {}, true}};
    const Vec3 foot(1, 0, 0);
    const Vec3 top(1 + lean, 0.8, 0);
    const MeshResult result =
        make_mesh({line("floor", foot, Vec3(0, 0, 0)), line("side", foot, top)}, options);
    CHECK(result.surface.taper_nodes.empty());
    CHECK(result.quality.report.nonpositive_cells == 0);
    const Layers& layers = result.mesh.layers;
    // Leaning away, what is on the side is nearest to the foot.
    const double high = lean > 0 ? 0.2 * 0.8 / std::hypot(0.8, lean) : 0.2;
    int on = 0;
    for (int n = 0; n < static_cast<int>(layers.stop.size()); ++n) {
      if (std::abs(layers.at(n, 0).x() - 1) > 1e-12) continue;
      ++on;
      const Vec3 end = layers.at(n, layers.levels() - 1);
      CHECK(std::abs((end.x() - 1) * 0.8 - end.y() * lean) < 1e-12);
      CHECK(end.y() == doctest::Approx(high).epsilon(1e-6));
    }
    CHECK(on == 2);
  }
}
