#include "vdb_offset/surface/boundary.h"

#include <doctest/doctest.h>

#include <Eigen/Geometry>
#include <numbers>
#include <random>

#include "support/shapes.h"
#include "vdb_offset/core/error.h"
#include "vdb_offset/io/plot3d.h"
#include "vdb_offset/surface/example.h"
#include "vdb_offset/surface/surface.h"

using namespace vdb_offset;
using namespace vdb_offset::test;

namespace {

constexpr double kEps = 1e-15;

/// A strip of wall, 1 x 1, whose side i = 0 lies in x = 0 at `angle` to it, measured in the flow
/// above; normals up.
Patch strip(double angle) {
  const Vec3 up(std::sin(angle), 0, std::cos(angle));
  return rectangle("strip", {5, 4}, Vec3::Zero(), {up, Vec3::UnitY()});
}

std::vector<std::string> names(const Surface& surface) {
  std::vector<std::string> result;
  if (!surface.boundaries) return result;
  for (const Boundary& boundary : surface.boundaries->list()) result.push_back(boundary.name());
  return result;
}

int edges_left(const Surface& surface) {
  int left = surface.free_edges();
  for (std::size_t b = 0; b < names(surface).size(); ++b) {
    left -= surface.free_edges_on(static_cast<int>(b));
  }
  return left;
}

/// The quarter x >= 0, y >= 0 of a cylinder's mantle, with its lid, of radius 1.
Patches quarter_can(int points) {
  const double right = std::numbers::pi / 2;
  Patches patches{make_patch("mantle", points, points, [&](double u, double v) -> Vec3 {
    return {std::cos(right * u), std::sin(right * u), v};
  })};
  patches.push_back(make_patch("lid", points, points, [&](double u, double v) -> Vec3 {
    const double r = 1 - 0.8 * v;
    return {r * std::cos(right * u), r * std::sin(right * u), 1};
  }));
  for (Patch& patch : patches) {
    for (int j = 0; j < points; ++j) {
      patch.at(0, j).y() = 0;
      patch.at(points - 1, j).x() = 0;
    }
  }
  return patches;
}

}  // namespace

TEST_CASE("boundary: a short piece of a smooth rim is on no plane, however near to one it lies") {
  // Half a hull, keel in y = 0, cut at both ends; its upper rim is twisted. The first patch, 0.1
  // long, deviates from the plane that fits its rim by a fifth of what passes as flat.
  const auto hull = [](double from, double to, int points) {
    Patch patch = make_patch("hull", points, 9, [&](double u, double v) -> Vec3 {
      const double x = from + (to - from) * u;
      const double turn = std::numbers::pi / 3 * v;
      const double r = 0.3 * (1 - 0.5 * x * x);
      const double rise = 0.05 * x * x - 0.02 * x * x * x;
      return {x, r * std::sin(turn), v * rise - r * std::cos(turn)};
    });
    for (int i = 0; i < points; ++i) patch.at(i, 0).y() = 0;
    return patch;
  };
  const Surface surface = build_surface({hull(-1, -0.9, 4), hull(-0.9, 1, 60)});
  CHECK(names(surface) == std::vector<std::string>{"symmetry", "symmetry 2", "symmetry 3"});
  for (const Boundary& boundary : surface.boundaries->list()) {
    CHECK(std::abs(boundary.plane().normal.x()) + std::abs(boundary.plane().normal.y()) ==
          doctest::Approx(1));
  }
  CHECK(edges_left(surface) == 3 + 59);
}

TEST_CASE("boundary: a point folded into the domain unfolds to where it came from") {
  Boundaries walls;
  walls.add({"x", Plane{Vec3(0.3, 0, 0), Vec3::UnitX()}});
  walls.add({"y", Plane{Vec3(0, -0.2, 0), Vec3::UnitY()}});
  walls.add({"slab", Plane{Vec3(2, 0, 0), -Vec3::UnitX()}});
  std::mt19937_64 random(7);
  Box box;
  box.add(Vec3::Constant(-2));
  box.add(Vec3::Constant(4));
  int moved = 0;
  for (int n = 0; n < 1000; ++n) {
    const Vec3 p = random_point(random, box);
    const Folded folded = walls.fold(p);
    CHECK(walls.side(folded.point_world()) >= -kEps);
    CHECK((folded.unfold(folded.point_world()) - p).norm() < 1e-14);
    moved += folded.moved() ? 1 : 0;
    CHECK(folded.moved() == (walls.side(p) < 0));
    // A reflection keeps lengths: what is next to the image stands next to the point.
    const Vec3 beside = folded.point_world() + Vec3(0.1, 0.2, -0.3);
    CHECK((folded.unfold(beside) - p).norm() == doctest::Approx(std::sqrt(0.14)).epsilon(1e-12));
  }
  CHECK(moved > 500);
}

TEST_CASE("boundary: on several planes a point is held on their common line") {
  Boundaries walls;
  const double angle = 1.1;
  walls.add({"a", Plane{Vec3(1, 2, 3), Vec3::UnitX()}});
  walls.add({"b", Plane{Vec3(1, 2, 3), Vec3(std::cos(angle), std::sin(angle), 0)}});
  const Vec3 held = walls.hold(3, Vec3(1.1, 2.2, 5));
  CHECK((held - Vec3(1, 2, 5)).norm() < 1e-14);
  const Vec3 along = walls.along(3, held, Vec3(0.5, 0.2, -0.3).normalized());
  CHECK((along + Vec3::UnitZ()).norm() < 1e-14);
  CHECK(walls.along(3, held, Vec3::UnitX()).norm() == 0);
}

TEST_CASE("boundary: between planes at a sharp angle points are led back inside all of them") {
  std::mt19937_64 random(11);
  Box box;
  box.add(Vec3::Constant(-1));
  box.add(Vec3::Constant(1));
  for (const double degrees : {5.0, 20.0, 35.0, 90.0, 145.0}) {
    CAPTURE(degrees);
    const double half = 0.5 * degrees * std::numbers::pi / 180;
    Boundaries wedge;
    wedge.add({"a", {Vec3::Zero(), Vec3(std::sin(half), -std::cos(half), 0)}});
    wedge.add({"b", {Vec3::Zero(), Vec3(std::sin(half), std::cos(half), 0)}});
    for (int n = 0; n < 1000; ++n) {
      const Vec3 point = random_point(random, box);
      const Vec3 inside = wedge.contain(point);
      CHECK(wedge.side(inside) > -kEps);
      if (wedge.side(point) >= 0) CHECK(inside == point);
      const Vec3 on_a = wedge.contain(point, 1);
      CHECK(std::abs(wedge.list()[0].side(on_a)) < kEps);
      CHECK(wedge.side(on_a) > -kEps);
    }
  }
}

TEST_CASE("boundary: planes are found where a wall stands upright or oblique on them") {
  for (const double degrees : {60.0, 90.0, 120.0}) {
    CAPTURE(degrees);
    SurfaceOptions options;
    const Surface surface =
        build_surface({strip((90 - degrees + 90) * std::numbers::pi / 180)}, options);
    // Its four sides: x = 0, the far side, and the two across.
    REQUIRE(surface.boundaries);
    CHECK(edges_left(surface) == 0);
    CHECK(surface.report.boundary_distance_max_world <= kEps);
  }
}

TEST_CASE("boundary: a quarter model has two symmetry planes, and nodes on both") {
  for (const double turn : {0.0, 0.4}) {
    CAPTURE(turn);
    const Eigen::Matrix3d map =
        Eigen::AngleAxisd(turn, Vec3(1, 2, 3).normalized()).toRotationMatrix();
    SurfaceOptions options;
    const Surface surface =
        build_surface(mapped(quarter_can(9), map, Vec3(0.1, 0.2, 0.3)), options);
    REQUIRE(surface.boundaries);
    const Vec3 x = map.col(0);
    const Vec3 y = map.col(1);
    int with_x = 0;
    int with_y = 0;
    for (const Boundary& boundary : surface.boundaries->list()) {
      with_x += std::abs(boundary.plane().normal.dot(x)) > 1 - 1e-9 ? 1 : 0;
      with_y += std::abs(boundary.plane().normal.dot(y)) > 1 - 1e-9 ? 1 : 0;
      for (const Vec3& node : surface.nodes_world) CHECK(boundary.side(node) > -1e-12);
    }
    CHECK(with_x == 1);
    CHECK(with_y == 1);
    CHECK(surface.report.boundary_distance_max_world < 1e-14);
  }
}

TEST_CASE("boundary: a plate's own plane, and a shallow cap's, are none") {
  const Surface plate =
      build_surface({rectangle("plate", {4, 4}, Vec3::Zero(), {Vec3::UnitX(), Vec3::UnitY()})});
  for (const Boundary& boundary : plate.boundaries->list()) {
    CHECK(std::abs(boundary.plane().normal.z()) < 1e-12);
  }
  CHECK(plate.boundaries->list().size() == 4);

  const Surface cap = build_surface({make_patch("cap", 9, 9, [](double u, double v) -> Vec3 {
    const double t = 2 * std::numbers::pi * u;
    const double a = 0.3 + 0.3 * v;  // 17 to 34 degrees from the pole
    return {std::sin(a) * std::cos(t), std::sin(a) * std::sin(t), std::cos(a)};
  })});
  CHECK(names(cap).empty());
}

TEST_CASE("boundary: openings around the flow are told from symmetry planes around a body") {
  const Surface duct = build_surface(make_example("draft-tube", {.points = 9}));
  CHECK(names(duct) == std::vector<std::string>{"opening", "opening 2"});
  CHECK(edges_left(duct) == 0);
  const Surface wing = build_surface(make_example("naca0012-wing", {.points = 9}));
  CHECK(names(wing) == std::vector<std::string>{"symmetry"});
  CHECK(wing.boundaries->list()[0].plane().normal.isApprox(Vec3::UnitY(), 0));
}

TEST_CASE("boundary: named planes come first, keep their names, and turn towards the surface") {
  SurfaceOptions options;
  options.planes = {{"outlet", {Vec3(3.6, 0, 0), Vec3::UnitX()}},
                    {"", {Vec3(0, 0, -0.1), Vec3::UnitZ()}}};
  const Surface duct = build_surface(make_example("draft-tube", {.points = 9}), options);
  CHECK(names(duct) == std::vector<std::string>{"outlet", "opening"});
  for (const Boundary& boundary : duct.boundaries->list()) {
    for (const Vec3& node : duct.nodes_world) CHECK(boundary.side(node) >= 0);
  }
  options.planes = {{"across", {Vec3(1, 0, 0), Vec3::UnitX()}}};
  CHECK_THROWS_WITH_AS(build_surface(make_example("draft-tube", {.points = 9}), options),
                       doctest::Contains("x = 1 cuts the surface"), InputError);
}

TEST_CASE("boundary: each sheet of a shape has the wall before it, whichever way it is given") {
  // Both ends of a channel, of one name, in all orientations.
  const auto sheet = [](double x, bool is_turned) {
    const std::array<Vec3, 2> sides{Vec3(3 * Vec3::UnitY()), Vec3(3 * Vec3::UnitZ())};
    return rectangle("sheet", {5, 5}, Vec3(x, -1, -1),
                     is_turned ? std::array<Vec3, 2>{sides[1], sides[0]} : sides);
  };
  for (const bool first : {false, true}) {
    for (const bool second : {false, true}) {
      CAPTURE(first);
      CAPTURE(second);
      SurfaceOptions options;
      options.shapes = {{"ends", {sheet(0, first), sheet(4, second)}}};
      const Surface channel = build_surface(make_example("channel", {.points = 9}), options);
      CHECK(channel.free_edges_on(0) == 16);
      const Boundary& ends = channel.boundaries->list()[0];
      for (const double x : {0.5, 1.5, 2.5, 3.5}) {
        CHECK(ends.side({x, 0.2, 0.5}) == doctest::Approx(std::min(x, 4 - x)));
      }
      for (const double x : {-0.5, 4.5}) CHECK(ends.side({x, 0.2, 0.5}) == doctest::Approx(-0.5));
    }
  }
}

TEST_CASE("boundary: open edges may be left to splay, or refused by the names of their sides") {
  SurfaceOptions options;
  options.open_edges = OpenEdges::Splay;
  CHECK(!build_surface(make_example("naca0012-wing", {.points = 9}), options).boundaries);
  options.open_edges = OpenEdges::Refuse;
  CHECK_NOTHROW(build_surface(make_example("naca0012-wing", {.points = 9}), options));
  // A saddle's sides are curves in no plane.
  const Patch saddle = make_patch("saddle", 5, 7, [](double u, double v) -> Vec3 {
    return {u + 0.2 * std::sin(4 * v), v + 0.1 * u * u * u, u * v + std::sin(3 * (u + v))};
  });
  CHECK_THROWS_WITH_AS(build_surface({saddle}, options),
                       doctest::Contains("'saddle', side imin, points 1 to 7"), InputError);
}

TEST_CASE("boundary: half models by others end on their symmetry plane to the last bit") {
  const auto data = shared_data();
  if (!data) {
    MESSAGE("skipped: no shared data beside this clone");
    return;
  }
  for (const char* file : {"bwb.fmt", "m6_small.fmt"}) {
    CAPTURE(file);
    const Surface surface = build_surface(read_plot3d(*data + "/plot3d/" + file));
    CHECK(names(surface) == std::vector<std::string>{"symmetry"});
    CHECK(edges_left(surface) == 0);
    int on = 0;
    for (std::size_t n = 0; n < surface.nodes_world.size(); ++n) {
      if (surface.boundaries_of(n) == 0) continue;
      ++on;
      CHECK(surface.boundaries->list()[0].side(surface.nodes_world[n]) == 0);
    }
    CHECK(on > 100);
  }
}

TEST_CASE("boundary: names that faces have, or boundaries already, are refused") {
  SurfaceOptions options;
  options.planes = {{"wall", {Vec3(0, 0, 0), Vec3::UnitY()}}};
  const auto build = [&] {
    return build_surface(make_example("naca0012-wing", {.points = 9}), options);
  };
  CHECK_THROWS_WITH_AS(build(), doctest::Contains("cannot be called 'wall'"), InputError);
  options.planes = {{"a", {Vec3(0, 0, 0), Vec3::UnitY()}}, {"a", {Vec3(0, -9, 0), Vec3::UnitY()}}};
  CHECK_THROWS_WITH_AS(build(), doctest::Contains("a boundary already"), InputError);
  for (const double size : {1e200, 1e-200}) {
    options.planes = {{"root", {Vec3(0, 0, 0), Vec3(0, size, 0)}}};
    CHECK(build().free_edges_on(0) == build().free_edges());
  }
}

TEST_CASE("boundary: names that are not given count on from those that are, without holes") {
  // The channel is open along four planes: two at its sides, two at its ends.
  SurfaceOptions options;
  options.planes = {{"", {Vec3(0, 0, 0), Vec3::UnitY()}},
                    {"symmetry", {Vec3(0, 0.5, 0), Vec3::UnitY()}}};
  const Patches channel = make_example("channel", {.points = 9});
  CHECK(names(build_surface(channel, options)) ==
        std::vector<std::string>{"symmetry 2", "symmetry", "opening", "opening 2"});
  options.planes[1].name = "side";
  CHECK(names(build_surface(channel, options)) ==
        std::vector<std::string>{"symmetry", "side", "opening", "opening 2"});
  options.planes.clear();
  options.internals = {{"opening", make_example("fuselage", {.points = 9})}};
  CHECK(names(build_surface(channel, options)) ==
        std::vector<std::string>{"symmetry", "symmetry 2", "opening 2", "opening 3", "opening"});
}
