#include "surface/crossing.h"

#include <doctest/doctest.h>

#include <Eigen/Geometry>
#include <random>

#include "support/shapes.h"
#include "vdb_offset/surface/example.h"
#include "vdb_offset/surface/surface.h"

using namespace vdb_offset;
using namespace vdb_offset::test;

namespace {

/// A closed body, turned so that none of its facets is along an axis.
Surface turned(const std::string& example) {
  const Eigen::Matrix3d map = Eigen::AngleAxisd(0.7, Vec3(1, 2, 3).normalized()).toRotationMatrix();
  return build_surface(mapped(make_example(example, {.points = 9}), map, Vec3(0.1, -0.2, 0.3)));
}

/// The unit square at a height.
Surface sheet_at(double z) {
  SurfaceOptions open;
  open.open_edges = OpenEdges::Splay;
  return build_surface({rectangle("sheet", {4, 4}, Vec3(0, 0, z), {Vec3::UnitX(), Vec3::UnitY()})},
                       open);
}

/// A body's vertices, and places on its edges.
Vec3List seams(const Wall& wall) {
  Vec3List places = wall.vertices();
  for (const Wall::Triangle& t : wall.triangles()) {
    const auto corner = [&](std::size_t c) {
      return wall.vertices()[static_cast<std::size_t>(t[c % 3])];
    };
    for (std::size_t c = 0; c < 3; ++c) {
      places.emplace_back(0.3 * corner(c) + 0.7 * corner(c + 1));
    }
  }
  return places;
}

}  // namespace

TEST_CASE("crossing: nothing leaves a closed surface through its edges and vertices") {
  for (const char* name : {"sphere", "cube"}) {
    CAPTURE(name);
    const Surface surface = turned(name);
    const Wall& wall = *surface.wall;
    const Vec3 centre = 0.5 * (wall.bounds().lo + wall.bounds().hi);
    std::mt19937_64 random(4);
    Box near;
    near.add(Vec3::Constant(-0.1));
    near.add(Vec3::Constant(0.1));
    int leaks = 0;
    int knots = 0;
    for (const Vec3& seam : seams(wall)) {
      const Vec3 inside = centre + random_point(random, near);
      const Vec3 outside = inside + 3 * wall.bounds().size() * (seam - inside).normalized();
      // Inside to outside goes through, by Jordan; so does a path with a knot on the seam.
      leaks += first_crossing(wall, {inside, outside}, EndsCount::Yes) ? 0 : 1;
      leaks += first_crossing(wall, {inside, outside}, EndsCount::No) ? 0 : 1;
      const bool is_met = first_crossing(wall, {inside, seam}, EndsCount::Yes) ||
                          first_crossing(wall, {seam, outside}, EndsCount::Yes);
      leaks += is_met ? 0 : 1;
      ++knots;
    }
    CHECK(knots > 300);
    CHECK(leaks == 0);
  }
}

TEST_CASE("crossing: of a plane sheet it is where the plane is, and beside its rim there is none") {
  const Surface sheet = sheet_at(0.25);
  const Wall& wall = *sheet.wall;
  std::mt19937_64 random(5);
  Box below;
  below.add(Vec3(-0.5, -0.5, -1));
  below.add(Vec3(1.5, 1.5, 0.2));
  Box above;
  above.add(Vec3(-0.5, -0.5, 0.3));
  above.add(Vec3(1.5, 1.5, 1));
  int through = 0;
  for (int n = 0; n < 2000; ++n) {
    const Vec3 from = random_point(random, below);
    const Vec3 to = random_point(random, above);
    const double part = (0.25 - from.z()) / (to.z() - from.z());
    const Vec3 place = from + part * (to - from);
    const bool is_over = (place.head<2>().array() > 0).all() && (place.head<2>().array() < 1).all();
    for (const EndsCount ends : {EndsCount::Yes, EndsCount::No}) {
      const auto found = first_crossing(wall, {from, to}, ends);
      REQUIRE(found.has_value() == is_over);
      if (found) CHECK(*found == doctest::Approx(part).epsilon(1e-12));
    }
    through += is_over ? 1 : 0;
    CHECK(!first_crossing(wall, {from, from + 0.05 * (to - from)}, EndsCount::No).has_value() ==
          !(is_over && part < 0.05));
  }
  CHECK(through > 400);
}

TEST_CASE("crossing: ends on the wall count where they are to, and along it nothing goes through") {
  const Surface sheet = sheet_at(0);
  const Segment onto{Vec3(0.4, 0.3, -1), Vec3(0.4, 0.3, 0)};
  CHECK(*first_crossing(*sheet.wall, onto, EndsCount::Yes) == 1);
  CHECK(!first_crossing(*sheet.wall, onto, EndsCount::No));
  const Segment within{Vec3(0.1, 0.3, 0), Vec3(0.8, 0.4, 0)};
  CHECK(!first_crossing(*sheet.wall, within, EndsCount::No));
  const Segment over_rim{Vec3(1, 0.3, -1), Vec3(1, 0.3, 1)};
  CHECK(first_crossing(*sheet.wall, over_rim, EndsCount::Yes).has_value());
}
