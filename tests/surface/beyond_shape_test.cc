// Walls that stick out through a boundary surface are refused, with the place.

#include "surface/beyond_shape.h"

#include <doctest/doctest.h>

#include <fmt/format.h>

#include <string>

#include "support/shapes.h"
#include "vdb_offset/core/error.h"
#include "vdb_offset/surface/example.h"

namespace vdb_offset::test {
namespace {

/// A wall that stands on the sheet z = 0, 4 x 4 about the origin, and a ball beside it.
Patches wall_with_ball(double radius, const Vec3& middle) {
  Patches patches{
      rectangle("post", {5, 9}, Vec3(-1, -0.5, 0), {Vec3(Vec3::UnitY()), Vec3(Vec3::UnitZ())})};
  for (Patch& part : mapped(make_example("sphere", {.points = 9}),
                            radius * Eigen::Matrix3d::Identity(), middle)) {
    part.name = "ball " + part.name;
    patches.push_back(std::move(part));
  }
  return patches;
}

SurfaceOptions on_sheet(int points = 5) {
  SurfaceOptions options;
  options.open_edges = OpenEdges::Splay;
  options.shapes = {{"ground",
                     {rectangle("sheet", {points, points}, Vec3(-2, -2, 0),
                                {Vec3(4 * Vec3::UnitX()), Vec3(4 * Vec3::UnitY())})}}};
  return options;
}

/// What is said of it; nothing if it is taken.
std::string refusal(const Patches& patches, const SurfaceOptions& options) {
  try {
    build_surface(patches, options);
  } catch (const InputError& error) {
    return error.what();
  }
  return {};
}

bool holds(const std::string& said, const std::string& part) {
  return said.find(part) != std::string::npos;
}

}  // namespace

TEST_CASE("beyond a shape: a ball that sticks out through it is refused by its farthest point") {
  const double radius = make_example("sphere", {.points = 9})[0].at(0, 0).norm();
  const double scale = 0.25 / radius;
  for (const double z : {0.0625, 0.0, -0.125}) {
    CAPTURE(z);
    const std::string said = refusal(wall_with_ball(scale, Vec3(1, 0.5, z)), on_sheet());
    CAPTURE(said);
    CHECK(holds(said, "beyond the boundary 'ground'"));
    CHECK(holds(said, "'ball "));
    CHECK(holds(said, fmt::format("by {:.3g}, is ", 0.25 - z)));
    CHECK(holds(said, fmt::format("at (1, 0.5, {:g})", z - 0.25)));
  }
  // All of it beyond.
  CHECK(
      holds(refusal(wall_with_ball(scale, Vec3(1, 0.5, -1)), on_sheet()), "the farthest, by 1.25"));
}

TEST_CASE("beyond a shape: what stands before it, on it or past its rim is taken") {
  const double scale = 0.25 / make_example("sphere", {.points = 9})[0].at(0, 0).norm();
  for (const Vec3& middle : {Vec3(1, 0.5, 0.26), Vec3(1, 0.5, 0.25), Vec3(2.3, 0, -1)}) {
    CAPTURE(middle.transpose());
    CHECK(refusal(wall_with_ball(scale, middle), on_sheet()) == "");
  }
  // A root that its shape's facets miss by what they may.
  SurfaceOptions options;
  options.shapes = {{"body", make_example("fuselage", {.points = 5})}};
  CHECK(refusal(make_example("wing-on-cylinder", {.points = 33}), options) == "");
}

TEST_CASE("beyond a shape: in two dimensions too") {
  SurfaceOptions options;
  options.open_edges = OpenEdges::Splay;
  const auto curve = [](const std::string& name, int points, const auto& place) {
    Patch patch{name, "", points, 1, {}};
    for (int i = 0; i < points; ++i) patch.points_world.push_back(place(double(i) / (points - 1)));
    return patch;
  };
  options.shapes = {{"ground", {curve("line", 9, [](double u) -> Vec3 {
                       return {4 * u - 2, 0, 0};
                     })}}};
  const auto post = curve("post", 5, [](double u) -> Vec3 { return {-1, u, 0}; });
  const auto box = [&](double y) {
    const Vec3List corners{{0, y, 0}, {1, y, 0}, {1, y + 1, 0}, {0, y + 1, 0}, {0, y, 0}};
    return curve("box", 5, [&](double u) { return corners[static_cast<std::size_t>(4 * u)]; });
  };
  const std::string said = refusal({post, box(-0.5)}, options);
  CAPTURE(said);
  CHECK(holds(said, "2 of 9 points of the wall"));
  CHECK(holds(said, "by 0.5, is patch 2 'box', point"));
  CHECK(holds(said, ", -0.5)"));
  CHECK(refusal({post, box(0.5)}, options) == "");
}

}  // namespace vdb_offset::test
