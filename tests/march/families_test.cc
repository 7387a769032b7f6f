// Families of the wall with layers of their own, or none.

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "support/layers.h"
#include "support/shapes.h"
#include "vdb_offset/core/error.h"
#include "vdb_offset/march/march.h"
#include "vdb_offset/surface/example.h"

using namespace vdb_offset;
using namespace vdb_offset::test;

TEST_CASE("families: families have a distance and a first cell of their own, tapered") {
  Patches cube = make_example("cube", {.points = 17});
  cube[0].family = "lid";
  PipelineOptions options = options_for(0.3, 0.03);
  options.march.families = {{"lid", 0.1, 5e-4}};
  const MeshResult result = make_mesh(cube, options);
  const Layers& layers = result.mesh.layers;
  CHECK(result.quality.report.nonpositive_cells == 0);
  for (const int n : result.surface.patch_nodes[0]) {
    const auto at = static_cast<std::size_t>(n);
    CHECK(layers.height_world[at] == doctest::Approx(0.1).epsilon(1e-6));
    CHECK(layers.first_cell_world[at] == doctest::Approx(5e-4).epsilon(1e-6));
    CHECK(result.mesh.coverage(n) == doctest::Approx(1).epsilon(1e-6));
  }
  CHECK(*std::max_element(layers.height_world.begin(), layers.height_world.end()) ==
        doctest::Approx(0.3).epsilon(1e-6));
  CHECK(*std::max_element(layers.first_cell_world.begin(), layers.first_cell_world.end()) ==
        doctest::Approx(1e-3).epsilon(1e-6));
  // A larger distance too: the band reaches as far.
  options.march.families = {{"lid", 0.5, std::nullopt}};
  const MeshResult larger = make_mesh(cube, options);
  CHECK(*std::max_element(larger.mesh.layers.height_world.begin(),
                          larger.mesh.layers.height_world.end()) ==
        doctest::Approx(0.5).epsilon(1e-6));
  options.march.families = {{"no such", 0.5, std::nullopt}};
  CHECK_THROWS_WITH_AS(make_mesh(cube, options), doctest::Contains("'no such'"), InputError);
}

TEST_CASE("families: a family without layers is what its neighbours' layers end on") {
  Patches tube = make_example("draft-tube", {.points = 9, .closed = true});
  PipelineOptions options = options_for(0.05, 0.02);
  options.march.families = {{"inlet", {}, {}, true}, {"outlet", {}, {}, true}};
  const MeshResult result = make_mesh(tube, options);
  CHECK(result.surface.boundaries->list().size() == 2);
  CHECK(result.surface.boundaries->list()[0].name() == "inlet");
  const Layers& layers = result.mesh.layers;
  int on = 0;
  for (int n = 0; n < layers.report.nodes; ++n) {
    const BoundarySet bits = result.surface.boundaries_of(static_cast<std::size_t>(n));
    if (bits == 0) continue;
    ++on;
    const Vec3 end = layers.at(n, layers.levels() - 1);
    if ((bits & 1U) != 0) CHECK(std::abs(end.z() + 0.1) < 1e-12);
    if ((bits & 2U) != 0) CHECK(std::abs(end.x() - 3.6) < 1e-12);
  }
  CHECK(on > 40);
}

TEST_CASE("families: openings of a channel keep their names when its roof has no layers") {
  PipelineOptions options = options_for(0.2, 0.05);
  options.march.families = {{"upper", {}, {}, true}};
  const MeshResult result = make_mesh(make_example("channel", {.points = 9}), options);
  std::vector<std::string> names;
  for (const Boundary& boundary : result.surface.boundaries->list()) {
    names.push_back(boundary.name());
  }
  std::ranges::sort(names);
  CHECK(names ==
        std::vector<std::string>{"opening", "opening 2", "symmetry", "symmetry 2", "upper"});
}

TEST_CASE("families: whichever side of a bar has no layers, the others have theirs") {
  constexpr std::size_t kSides = 6;  // the ends are several patches
  const std::size_t faces = make_example("l-bar", {.points = 9}).size();
  for (std::size_t bare = 0; bare < kSides; ++bare) {
    CAPTURE(bare);
    Patches bar = make_example("l-bar", {.points = 9});
    for (Patch& patch : bar) patch.family = "body";
    bar[bare].family = "bare";
    PipelineOptions options = options_for(0.3, 0.025);
    options.march.families = {{"bare", {}, {}, true}};
    const MeshResult result = make_mesh(bar, options);
    CHECK(result.mesh.blocks.size() == faces - 1);
    CHECK(result.quality.report.nonpositive_cells == 0);
    CHECK(result.quality.report.first_cell_min ==
          doctest::Approx(result.mesh.layers.spacing.first_cell_world).epsilon(1e-6));
    const std::vector<double>& heights = result.mesh.layers.height_world;
    CHECK(*std::min_element(heights.begin(), heights.end()) > 0.09);
  }
}

TEST_CASE("families: a wing without layers on one side has them on the other") {
  PipelineOptions options = options_for(0.3, 0.025);
  Patches wing = make_example("naca0012-wing", {.points = 9});
  options.march.families = {{wing[0].name, {}, {}, true}};
  const MeshResult result = make_mesh(wing, options);
  CHECK(result.quality.report.nonpositive_cells == 0);
  int high = 0;
  for (const double height : result.mesh.layers.height_world) high += height > 0.29 ? 1 : 0;
  CHECK(high > 0.6 * result.mesh.nodes());
}

TEST_CASE(
    "families: a wing's tip without layers, smooth ahead and sharp behind, leaves cells positive") {
  PipelineOptions options = options_for(0.3, 0.025);
  options.spacing.layers = 32;
  const Patches wing = make_example("naca0012-wing", {.points = 33});
  options.march.families = {{wing[4].name, {}, {}, true}};
  const MeshResult result = make_mesh(wing, options);
  CHECK(result.quality.report.nonpositive_cells == 0);
  CHECK(result.surface.report.taper_edges > 0);
}

TEST_CASE("families: a body without layers is where the columns of another end") {
  Patches bodies = make_example("cube", {.points = 9});
  for (Patch& patch : bodies) patch.family = "body";
  for (Patch patch :
       mapped(make_example("cube", {.points = 9}), Eigen::Matrix3d::Identity(), Vec3(1.3, 0, 0))) {
    patch.family = "other";
    bodies.push_back(patch);
  }
  double face = 1e9;  // where the other body begins
  for (const Patch& patch : bodies) {
    if (patch.family != "other") continue;
    for (const Vec3& p : patch.points_world) face = std::min(face, p.x());
  }
  PipelineOptions options = options_for(0.5, 0.05);
  options.march.families = {{"other", {}, {}, true}};
  const MeshResult result = make_mesh(bodies, options);
  const Layers& layers = result.mesh.layers;
  CHECK(result.mesh.blocks.size() == 6);
  CHECK(layers.report.internal > 20);
  for (int n = 0; n < layers.report.nodes; ++n) {
    const Vec3 end = layers.at(n, layers.levels() - 1);
    if (layers.stop[static_cast<std::size_t>(n)] != Stop::Internal) continue;
    CHECK(end.x() < face + 1e-9);
    CHECK(layers.room_world[static_cast<std::size_t>(n)] == doctest::Approx(0.3).epsilon(0.1));
  }
}

TEST_CASE("families: boundary planes have the same names with layers everywhere and without some") {
  const auto names = [](const std::string& off) {
    PipelineOptions options = options_for(0.2, 0.05);
    if (!off.empty()) options.march.families = {{off, {}, {}, true}};
    const MeshResult result = make_mesh(make_example("channel", {.points = 9}), options);
    std::map<std::string, Plane> planes;
    for (const Boundary& boundary : result.surface.boundaries->list()) {
      if (boundary.is_plane()) planes[boundary.name()] = boundary.plane();
    }
    return planes;
  };
  const std::map<std::string, Plane> all = names("");
  CHECK(all.size() == 4);
  for (const char* off : {"step", "upper", "lower downstream"}) {
    CAPTURE(off);
    for (const auto& [name, plane] : names(off)) {
      CAPTURE(name);
      REQUIRE(all.contains(name));
      CHECK(all.at(name).normal == plane.normal);
      CHECK(std::abs((all.at(name).point_world - plane.point_world).dot(plane.normal)) < 1e-12);
    }
  }
}

TEST_CASE("families: planes keep their numbers whichever wall of a corner has no layers") {
  const Vec3 x = Vec3::UnitX();
  const Vec3 y = 1.1 * Vec3::UnitY();
  const Vec3 z = Vec3::UnitZ();
  const Patches corner{rectangle("top", {6, 6}, z, {x, y}), rectangle("end", {6, 6}, x, {y, z}),
                       rectangle("side", {6, 6}, y, {z, x})};
  // Without the side, or the end, other planes have the longest edges.
  for (const char* off : {"", "top", "end", "side"}) {
    CAPTURE(off);
    PipelineOptions options = options_for(0.2, 0.05);
    if (*off != 0) options.march.families = {{off, {}, {}, true}};
    const Surface surface = plan_mesh(corner, options).surface;
    std::map<std::string, std::string> planes;
    for (const Boundary& boundary : surface.boundaries->list()) {
      if (boundary.is_plane()) planes[boundary.name()] = describe(boundary.plane());
    }
    const std::map<std::string, std::string> all{
        {"symmetry", "x = 0"}, {"symmetry 2", "z = 0"}, {"symmetry 3", "y = 0"}};
    CHECK(planes == all);
  }
}

TEST_CASE(
    "families: families that contradict themselves or the spacing are refused before any work") {
  const Patches cube = make_example("cube", {.points = 5});
  const auto refusal = [&](const std::vector<FamilyLayers>& families) -> std::string {
    PipelineOptions options = options_for(0.3, 0);
    options.spacing.max_growth = 2;
    options.march.families = families;
    try {
      plan_mesh(cube, options);
    } catch (const InputError& error) {
      return error.what();
    }
    return "";
  };
  CHECK(refusal({{"cube", 0.2, {}}}).empty());
  CHECK(refusal({{"nope", 0.2, {}}}).find("'nope'; there are: ") != std::string::npos);
  CHECK(refusal({{"cube", 0.2, {}}, {"cube", 0.1, {}}}).find("given twice") != std::string::npos);
  CHECK(refusal({{"cube", {}, 0.5}}).find("family 'cube'") != std::string::npos);
  CHECK(refusal({{"cube", {}, 1e-30}}).find("family 'cube'") != std::string::npos);
  CHECK(refusal({{"cube", 0.2, {}, true}}).find("leaves nothing") != std::string::npos);
}
