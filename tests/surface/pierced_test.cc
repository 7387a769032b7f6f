#include "vdb_offset/surface/pierced.h"

#include <doctest/doctest.h>

#include <cmath>
#include <numbers>

#include "support/shapes.h"
#include "vdb_offset/surface/example.h"

namespace vdb_offset::test {
namespace {

/// A duct of radius 1 along z from 0 to 3, and a ball of radius 0.25.
Surface duct_with_ball(const Vec3& middle) {
  Patches patches{make_patch("duct", 17, 9, [](double u, double v) -> Vec3 {
    const double angle = -2 * std::numbers::pi * (u == 1 ? 0 : u);
    return {std::cos(angle), std::sin(angle), 3 * v};
  })};
  const double radius = make_example("sphere", {.points = 9})[0].at(0, 0).norm();
  for (Patch& part : mapped(make_example("sphere", {.points = 9}),
                            0.25 / radius * Eigen::Matrix3d::Identity(), middle)) {
    patches.push_back(std::move(part));
  }
  return build_surface(patches);
}

}  // namespace

TEST_CASE("pierced: an opening that a body sticks out of is found, with a place on both") {
  for (const double z : {-0.125, 0.0, 0.0625}) {
    CAPTURE(z);
    const Vec3 middle(0.5, 0.125, z);
    const Surface surface = duct_with_ball(middle);
    const std::vector<PiercedOpening> found = find_pierced(surface);
    REQUIRE(found.size() == 1);
    const Boundary& opening =
        surface.boundaries->list()[static_cast<std::size_t>(found[0].boundary)];
    CHECK(opening.name() == "opening");
    CHECK(std::abs(found[0].place_world.z()) < 1e-12);
    // Edges of the ball lie within it, off it by their sagitta at most.
    const double away = (found[0].place_world - middle).norm();
    CHECK(away < 0.25 + 1e-12);
    CHECK(away > 0.25 * std::cos(std::numbers::pi / 16));
  }
}

TEST_CASE("pierced: bodies in a duct, before it and beside it go through no opening") {
  for (const Vec3& middle : {Vec3(0.5, 0.125, 1), Vec3(0.5, 0.125, 0.26), Vec3(0.5, 0.125, -0.26),
                             Vec3(1.5, 0, 0), Vec3(-1, 1, 0.1)}) {
    CAPTURE(middle.transpose());
    CHECK(find_pierced(duct_with_ball(middle)).empty());
  }
  CHECK(find_pierced(build_surface(make_example("draft-tube", {.points = 9}))).empty());
}

}  // namespace vdb_offset::test
