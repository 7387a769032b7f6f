#include "vdb_offset/surface/surface.h"

#include <doctest/doctest.h>

#include <array>
#include <cmath>
#include <numbers>

#include "support/shapes.h"
#include "vdb_offset/core/error.h"

using namespace vdb_offset;
using namespace vdb_offset::test;

namespace {

/// A box 1 x 1 of some height, of patches that meet to the bit, 1/8 between points.
Patches thin_box(double height, bool has_lid) {
  const Vec3 x = Vec3::UnitX();
  const Vec3 y = Vec3::UnitY();
  const Vec3 z = height * Vec3::UnitZ();
  Patches box{
      rectangle("floor", {9, 9}, Vec3::Zero(), {y, x}), rectangle("roof", {9, 9}, z, {x, y}),
      rectangle("y = 0", {9, 2}, Vec3::Zero(), {x, z}),
      rectangle("x = 0", {2, 9}, Vec3::Zero(), {z, y}), rectangle("y = 1", {2, 9}, y, {z, x})};
  if (has_lid) box.push_back(rectangle("x = 1", {9, 2}, x, {y, z}));
  return box;
}

}  // namespace

TEST_CASE("weld: two sides of a thin body stay apart, also at its open rim") {
  constexpr double kHeight = 1e-4;  // of which 81 points of each side are within 0.01 of 1/8
  const Surface body = build_surface(thin_box(kHeight, true));
  CHECK(body.nodes_world.size() == 2 * 81);
  CHECK(body.closed);
  CHECK(body.report.weld_distance_max_world == 0);
  const Surface half = build_surface(thin_box(kHeight, false));
  CHECK(half.nodes_world.size() == 2 * 81);
  CHECK(half.free_edges() == 8 + 8 + 2);  // around x = 1
  Patches plates = thin_box(kHeight, false);
  plates.resize(2);
  CHECK(build_surface(plates).free_edges() == 2 * 32);  // their corners too
}

TEST_CASE(
    "weld: rims of two thin sheets stay apart where rows behind do not stand over each other") {
  const Vec3 x = Vec3::UnitX();
  const Vec3 y = Vec3::UnitY();
  for (const int rows : {4, 8, 21}) {
    const Patches plates{rectangle("floor", {9, 9}, Vec3::Zero(), {y, x}),
                         rectangle("roof", {rows, 9}, 1e-4 * Vec3::UnitZ(), {x, y})};
    CHECK(build_surface(plates).free_edges() == 2 * (8 + 8) + 2 * (8 + rows - 1));
  }
}

TEST_CASE("weld: two sides of a thin plate in two dimensions stay apart") {
  constexpr int kCells = 20;
  Patch plate;
  plate.name = "plate";
  plate.ni = 2 * kCells + 3;
  plate.nj = 1;
  for (int n = 0; n <= kCells; ++n) plate.points_world.emplace_back(1 - n * 0.05, 5e-5, 0);
  for (int n = 0; n <= kCells; ++n) plate.points_world.emplace_back(n * 0.05, -5e-5, 0);
  plate.points_world.push_back(plate.points_world.front());
  const Surface surface = build_surface({plate});
  CHECK(surface.flat);
  CHECK(surface.free_edges() == 0);
  // Where it narrows to an edge it is closed.
  plate.points_world.pop_back();
  plate.ni -= 1;
  for (Vec3& p : plate.points_world) p.y() *= 100 * (1 + 1e-4 - p.x());
  CHECK(build_surface({plate}).free_edges() == 0);
}

TEST_CASE("weld: a thin body that narrows to an edge is closed there, whatever rounding left") {
  for (const double gap : {1e-15, 1e-12, 1e-5}) {
    Patches wedge = thin_box(4e-3, true);
    wedge.pop_back();  // x = 1
    if (gap > 1e-8) {
      wedge.erase(wedge.begin() + 4);  // edges of patches across the gap say that it is one
      wedge.erase(wedge.begin() + 2);
    }
    for (Patch& patch : wedge) {
      for (Vec3& p : patch.points_world) p.z() *= (1 - p.x()) + p.x() * gap / 4e-3;
    }
    const Surface body = build_surface(wedge);
    CHECK(body.closed == (gap < 1e-8));
    CHECK(body.nodes_world.size() == 2 * 81 - 9);
  }
}

TEST_CASE("weld: what is one but for rounding is welded within the surface too") {
  Patches doubled = thin_box(1, true);
  for (Patch patch : thin_box(1, true)) {
    for (Vec3& p : patch.points_world) p.x() += 1e-13;
    doubled.push_back(patch);
  }
  CHECK_THROWS_AS(build_surface(doubled), InputError);
}

TEST_CASE("weld: patches beside each other are welded where the body is no thin one") {
  constexpr double kGap = 1e-4;
  Patches box = thin_box(1, true);
  for (Vec3& p : box[1].points_world) p.z() += kGap;  // the roof floats
  for (Vec3& p : box[5].points_world) p.x() += kGap;
  const Surface body = build_surface(box);
  CHECK(body.closed);
  CHECK(body.nodes_world.size() == 2 * 81);
  CHECK(body.report.weld_distance_max_world == doctest::Approx(std::sqrt(2) * kGap).epsilon(0.5));
}

TEST_CASE("weld: seams off by single precision in both sides of a thin body close") {
  constexpr double kHeight = 5e-4;
  constexpr double kOff = 3e-8;
  const Vec3 x = Vec3::UnitX();
  const Vec3 y = Vec3::UnitY();
  Patches box = thin_box(kHeight, true);
  const auto halve = [&](std::size_t n, const Vec3& corner, bool x_first) {
    const std::array<Vec3, 2> sides = {0.5 * x, y};
    const auto part = [&](const char* name, const Vec3& from) {
      return x_first ? rectangle(name, {5, 9}, from, {sides[0], sides[1]})
                     : rectangle(name, {9, 5}, from, {sides[1], sides[0]});
    };
    Patch second = part("second", corner + 0.5 * x);
    for (std::size_t p = 0; p < second.points_world.size(); ++p) {
      second.points_world[p] += kOff * std::sin(7.0 * static_cast<double>(p + n)) * Vec3(1, 1, 1);
    }
    box[n] = part(n == 0 ? "floor 1" : "roof 1", corner);
    box.push_back(second);
    box.back().name = n == 0 ? "floor 2" : "roof 2";
  };
  halve(0, Vec3::Zero(), false);
  halve(1, kHeight * Vec3::UnitZ(), true);
  const Surface body = build_surface(box);
  CHECK(body.closed);
  CHECK(body.nodes_world.size() == 2 * 81);
}

TEST_CASE("weld: poles of a file in single precision are points") {
  double shift = 0;
  SUBCASE("about the origin") {}
  SUBCASE("far from it, where they are rounded more") { shift = 10; }
  Patch sphere;
  sphere.name = "sphere";
  sphere.ni = 17;
  sphere.nj = 33;
  for (int j = 0; j < sphere.nj; ++j) {
    for (int i = 0; i < sphere.ni; ++i) {
      const float theta = std::numbers::pi_v<float> * static_cast<float>(i) / 16;
      const float angle = std::numbers::pi_v<float> * static_cast<float>(j) / 16;
      const float off = i == 16 && j % 3 == 0 ? 1e-7F * static_cast<float>(shift) : 0;
      sphere.points_world.emplace_back(
          static_cast<float>(shift) + std::sin(theta) * std::cos(angle) + off,
          std::sin(theta) * std::sin(angle), std::cos(theta));
    }
  }
  REQUIRE(sphere.at(16, 0) != sphere.at(16, 8));
  const Surface surface = build_surface({sphere});
  CHECK(surface.closed);
  CHECK(surface.nodes_world.size() == 15 * 32 + 2);
}

TEST_CASE("weld: the tolerance that is advised leaves the fewest free edges") {
  const Vec3 y = Vec3::UnitY();
  Patches halves{rectangle("left", {9, 9}, -Vec3::UnitX(), {Vec3::UnitX(), y}),
                 rectangle("right", {9, 9}, Vec3::Zero(), {Vec3::UnitX(), y})};
  for (int j = 0; j < 9; ++j) halves[1].at(0, j).x() += (j % 2 == 0 ? 0.005 : 0.015) / 8;
  CHECK_THROWS_WITH_AS(build_surface(halves), doctest::Contains("or take --weld 0.02"), InputError);
}

TEST_CASE("weld: noise is joined also where cells at a blunt trailing edge are short") {
  constexpr double kEdge = 1e-4;
  constexpr double kNoise = 5e-9;
  const Vec3 x(1, 0, 0.5 * kEdge);
  const Vec3 y = Vec3::UnitY();
  const Vec3 up = Vec3(0, 0, 0.1);
  Patches wedge{rectangle("upper", {11, 5}, up, {Vec3(x - up), y}),
                rectangle("lower", {5, 11}, -up, {y, Vec3(1, 0, 0.1 - 0.5 * kEdge)}),
                rectangle("edge", {5, 2}, Vec3(1, 0, -0.5 * kEdge), {y, kEdge * Vec3::UnitZ()}),
                rectangle("nose", {2, 5}, -up, {Vec3(2 * up), y})};
  double sign = 1;
  for (Patch& patch : wedge) {
    for (Vec3& p : patch.points_world) p.y() += (sign = -sign) * kNoise;
  }
  for (const double weld : {0.001, 0.003, 0.01, 0.05}) {
    CAPTURE(weld);
    SurfaceOptions options;
    options.weld = weld;
    const Surface surface = build_surface(wedge, options);
    CHECK(surface.nodes_world.size() == 2 * 11 * 5);
    CHECK(surface.free_edges() == 2 * 22);
  }
}
