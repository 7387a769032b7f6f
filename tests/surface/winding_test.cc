#include "vdb_offset/surface/winding.h"

#include <doctest/doctest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <random>
#include <utility>
#include <vector>

#include "support/polygons.h"
#include "vdb_offset/core/error.h"
#include "vdb_offset/surface/surface.h"

namespace vdb_offset::test {
namespace {

constexpr double kDipoleError = 0.01;  // that the header promises

Wall wall_of(const Patch& patch) {
  std::vector<Wall::Triangle> triangles;
  for (const auto& [a, b, c, again] : patch.faces) triangles.push_back({a, b, c});
  return {patch.points_world, std::move(triangles)};
}

SurfaceOptions soup(SideRule rule) {
  SurfaceOptions options;
  options.sides = rule;
  return options;
}

/// Lattice points of the cube [-1.5, 1.5]^3 whose side, told with 8^3 of them at once, is not what
/// each says by itself; and how many are inside.
struct Sides {
  int wrong = 0;
  int inside = 0;
};
Sides sides_of(const Winding& winding, double spacing) {
  Sides sides;
  const int end = static_cast<int>(1.5 / spacing);
  const int begin = -(end + kWindingCube - 1) / kWindingCube * kWindingCube;
  const auto look = [&](const std::array<int, 3>& first) {
    const Winding::CubeMask mask = winding.inside_of_cube(first, spacing);
    for (int n = 0; n < 512; ++n) {
      const std::array<int, 3> at{first[0] + n / 64, first[1] + n / 8 % 8, first[2] + n % 8};
      const bool is_inside = (mask[static_cast<std::size_t>(n / 64)] >> (n % 64) & 1U) != 0;
      sides.inside += is_inside ? 1 : 0;
      if (is_inside != winding.is_inside(spacing * Vec3(at[0], at[1], at[2]))) ++sides.wrong;
    }
  };
  for (int x = begin; x < end; x += kWindingCube) {
    for (int y = begin; y < end; y += kWindingCube) {
      for (int z = begin; z < end; z += kWindingCube) look({x, y, z});
    }
  }
  return sides;
}

}  // namespace

TEST_CASE("winding: many points at once are inside as each of them is") {
  std::mt19937 random(11);
  for (const int level : {0, 2, 4}) {
    CAPTURE(level);
    Patch soup = icosphere(level);
    soup.faces.push_back(soup.faces[5]);
    for (const double kept : {1.0, 0.9, 0.5}) {
      CAPTURE(kept);
      // Holes at random, then half of the sphere.
      std::shuffle(soup.faces.begin(), soup.faces.end(), random);
      soup.faces.resize(static_cast<std::size_t>(kept * static_cast<double>(soup.faces.size())));
      for (auto& [a, b, c, again] : soup.faces) {
        if (kept == 0.5 && random() % 4 == 0) std::swap(a, b);
      }
      const Winding winding(wall_of(soup));
      for (const double spacing : {0.3, 0.1}) {
        const Sides sides = sides_of(winding, spacing);
        CHECK(sides.wrong == 0);
        if (kept == 1) CHECK(sides.inside > 2.3 / (spacing * spacing * spacing));
      }
    }
  }
}

TEST_CASE("winding: one inside of a closed surface, none outside, whatever the way there") {
  const Winding winding(wall_of(icosphere(4)));
  std::mt19937 random(5);
  std::uniform_real_distribution<double> any(-2, 2);
  for (int n = 0; n < 2000; ++n) {
    const Vec3 p(any(random), any(random), any(random));
    if (std::abs(p.norm() - 1) < 0.01) continue;  // between sphere and facets
    CHECK(std::abs(winding.number(p) - (p.norm() < 1 ? 1 : 0)) < kDipoleError);
  }
}

TEST_CASE("winding: the middle of half a sphere sees half of all directions covered") {
  Patch half = icosphere(4);
  std::erase_if(half.faces, [&](const std::array<int, 4>& face) {
    double z = 0;
    for (std::size_t c = 0; c < 3; ++c)
      z += half.points_world[static_cast<std::size_t>(face[c])].z();
    return z < 0;
  });
  const Wall wall = wall_of(half);
  double seen = 0;  // its solid angle, by area: facets near enough to the sphere
  for (const TriangleGeometry& t : wall.geometry()) {
    const Vec3 area = 0.5 * t.ab.cross(t.ac);
    const Vec3 middle = t.a + (t.ab + t.ac) / 3;
    seen += area.dot(middle) / std::pow(middle.norm(), 3);
  }
  CHECK(Winding(wall).number(Vec3::Zero()) ==
        doctest::Approx(seen / (4 * std::numbers::pi)).epsilon(1e-2));
  CHECK(Winding(wall).number(Vec3::Zero()) == doctest::Approx(0.5).epsilon(0.02));
}

TEST_CASE("winding: a soup has it, with doubled faces and holes; boundaries it has not") {
  Patch sphere = icosphere(3);
  sphere.faces.erase(sphere.faces.begin() + 17);
  sphere.faces.push_back(sphere.faces[5]);
  CHECK_THROWS_AS(build_surface({sphere}), InputError);  // as a wall for layers
  const Surface surface = build_surface({sphere}, soup(SideRule::Winding));
  REQUIRE(surface.winding != nullptr);
  CHECK(surface.closed);
  CHECK(surface.winding->is_inside({0.1, 0.2, 0.3}));
  CHECK(!surface.winding->is_inside({1.1, 0.2, 0.3}));
  CHECK(build_surface({sphere}, soup(SideRule::Unsigned)).winding == nullptr);
  SurfaceOptions cut = soup(SideRule::Winding);
  cut.planes.push_back({"symmetry", {Vec3::Zero(), Vec3::UnitZ()}});
  CHECK_THROWS_WITH_AS(build_surface({sphere}, cut), doctest::Contains("boundaries"), InputError);
  SurfaceOptions against = soup(SideRule::Winding);
  against.side = MarchSide::Against;
  CHECK_THROWS_WITH_AS(build_surface({sphere}, against), doctest::Contains("against"), InputError);
}

}  // namespace vdb_offset::test
