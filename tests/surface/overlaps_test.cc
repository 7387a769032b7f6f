#include "vdb_offset/surface/overlaps.h"

#include <doctest/doctest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <utility>
#include <vector>

#include "support/polygons.h"
#include "vdb_offset/core/error.h"
#include "vdb_offset/surface/clean_polygons.h"
#include "vdb_offset/surface/example.h"

using namespace vdb_offset;
using namespace vdb_offset::test;

namespace {

/// A sphere of triangles.
Patch ball(const char* name, double radius, const Vec3& centre, bool inward = false) {
  Patch patch = icosphere(2);
  patch.name = name;
  for (Vec3& p : patch.points_world) p = centre + radius * p;
  for (std::array<int, 4>& face : patch.faces) {
    if (inward) face = {face[0], face[2], face[1], face[1]};
  }
  return patch;
}

/// The same as polygons of one file, and as clean_polygons leaves them.
Patches cleaned(const Patches& patches) {
  PolygonMesh mesh;
  for (const Patch& patch : patches) {
    const auto shift = static_cast<int>(mesh.points_world.size());
    mesh.points_world.insert(mesh.points_world.end(), patch.points_world.begin(),
                             patch.points_world.end());
    for (const auto& face : patch.faces) {
      for (std::size_t c = 0; c < 3; ++c) mesh.corners.push_back(face[c] + shift);
      mesh.first.push_back(mesh.corners.size());
    }
  }
  return face_patches(clean_polygons(mesh).mesh);
}

}  // namespace

TEST_CASE("overlaps: bodies apart have none, and those that cross are named with their faces") {
  const Patch a = ball("a", 1, Vec3::Zero());
  CHECK(find_overlaps(build_surface({a, ball("b", 1, {2.5, 0, 0})})).empty());
  // Boxes that meet are no bodies that do.
  CHECK(find_overlaps(build_surface({a, ball("b", 1, {1.5, 1.5, 0})})).empty());

  const Vec3 centre(1.2, 0.3, 0.1);
  const auto found = find_overlaps(build_surface({a, ball("b", 1, centre)}));
  REQUIRE(found.size() == 2);
  for (const Overlap& overlap : found) {
    CHECK(overlap.other == 1 - overlap.patch);
    // A cap of height 1 - |c| / 2 is that part of half a sphere.
    const double part = (1 - centre.norm() / 2) / 2;
    CHECK(static_cast<double>(overlap.faces) ==
          doctest::Approx(part * static_cast<double>(a.faces.size())).epsilon(0.15));
    const Vec3 other_centre = overlap.other == 0 ? Vec3(Vec3::Zero()) : centre;
    CHECK((overlap.place_world - other_centre).norm() < 1);
  }
}

TEST_CASE("overlaps: a body within another is one, a hollow in it is none") {
  const Patch outer = ball("outer", 2, Vec3::Zero());
  const auto found = find_overlaps(build_surface({outer, ball("inner", 1, {0.1, 0, 0})}));
  REQUIRE(found.size() == 1);
  CHECK(found[0].patch == 1);
  CHECK(found[0].other == 0);
  CHECK(found[0].faces == outer.faces.size());
  CHECK(find_overlaps(build_surface({outer, ball("hollow", 1, {0.1, 0, 0}, true)})).empty());
  // A body in a duct: the flow is between them.
  CHECK(find_overlaps(
            build_surface({ball("duct", 2, Vec3::Zero(), true), ball("body", 1, {0.1, 0, 0})}))
            .empty());
  // And one in the hollow of another.
  CHECK(find_overlaps(build_surface({outer, ball("hollow", 1, {0.1, 0, 0}, true),
                                     ball("core", 0.5, {0.1, 0.1, 0})}))
            .empty());
}

TEST_CASE("overlaps: cleaning keeps a hollow, and one of a file whose normals all point in") {
  for (const bool inverted : {false, true}) {
    const Patch outer = ball("outer", 2, Vec3::Zero(), inverted);
    const Patch hollow = ball("hollow", 1, {0.1, 0, 0}, !inverted);
    const Surface surface = build_surface(cleaned({outer, hollow}));
    CHECK(find_overlaps(surface).empty());
    // In the flow: beyond all, and in the hollow; in the solid: between.
    const auto side = [&](const Vec3& p) { return surface.wall->closest(p).side(p); };
    CHECK(side({3, 0, 0}) > 0);
    CHECK(side({0, 1.5, 0}) < 0);
    CHECK(side(Vec3::Zero()) > 0);
    CHECK(find_overlaps(build_surface(cleaned({outer, ball("inner", 1, {0.1, 0, 0}, inverted)})))
              .size() == 1);
  }
}

TEST_CASE(
    "overlaps: a body twice in one place is two that overlap, and across a gap there are none") {
  Patch a = ball("a", 1, Vec3::Zero());
  Patch b = ball("b", 1, Vec3::Zero());
  a.body = 1;
  b.body = 2;
  const auto found = find_overlaps(build_surface({a, b}));
  REQUIRE(found.size() == 2);
  for (const Overlap& overlap : found) {
    CHECK(overlap.other == 1 - overlap.patch);
    CHECK(overlap.faces == static_cast<int>(a.faces.size()));
  }
  // Nearer than the first place that is looked at.
  const auto cubes = [](double gap) {
    Patches both = make_example("cube", {.points = 5});
    const std::size_t sides = both.size();
    double size = 0;
    for (const Patch& patch : both) {
      for (const Vec3& p : patch.points_world) size = std::max(size, 2 * p.x());
    }
    for (std::size_t n = 0; n < sides; ++n) {
      both[n].body = 1;
      Patch moved = both[n];
      moved.body = 2;
      moved.name += " of the other";
      for (Vec3& p : moved.points_world) p.x() += size + gap;
      both.push_back(std::move(moved));
    }
    return both;
  };
  CHECK(find_overlaps(build_surface(cubes(1e-6))).empty());
  CHECK(find_overlaps(build_surface(cubes(-1e-6))).size() == 2);
}

TEST_CASE("overlaps: edges that go through a wall are found, and none where parts only touch") {
  const auto crossing_at = [](const Vec3& centre) {
    const Patch a = ball("a", 1, Vec3::Zero());
    return find_self_crossing(*build_surface({a, ball("b", 1, centre)}).wall);
  };
  CHECK(crossing_at({2.5, 0, 0}).edges == 0);
  CHECK(crossing_at({1.5, 1.5, 0}).edges == 0);  // boxes meet, bodies do not
  const Vec3 centre(1.2, 0.3, 0.1);
  const SelfCrossing crossing = crossing_at(centre);
  CHECK(crossing.edges > 20);
  // On both spheres, but for what their chords cut off: edges subtend some 0.3.
  const double sagitta = 0.3 * 0.3 / 4;
  CHECK(std::abs(crossing.place_world.norm() - 1) < sagitta);
  CHECK(std::abs((crossing.place_world - centre).norm() - 1) < sagitta);
}

TEST_CASE("overlaps: bodies that go through each other by their edges alone are named") {
  // Boxes of two triangles a side, turned about z.
  const auto box = [](const char* name, const Vec3& centre, const Vec3& size, double degrees) {
    Patch patch;
    patch.name = name;
    const Eigen::AngleAxisd turn(degrees * std::numbers::pi / 180, Vec3::UnitZ());
    for (int n = 0; n < 8; ++n) {
      const Vec3 corner((n & 1) - 0.5, (n >> 1 & 1) - 0.5, (n >> 2) - 0.5);
      patch.points_world.push_back(centre + turn * corner.cwiseProduct(size));
    }
    patch.ni = 8;
    patch.nj = 0;
    patch.faces = {{0, 2, 3, 3}, {0, 3, 1, 1}, {4, 5, 7, 7}, {4, 7, 6, 6},
                   {0, 1, 5, 5}, {0, 5, 4, 4}, {2, 6, 7, 7}, {2, 7, 3, 3},
                   {0, 4, 6, 6}, {0, 6, 2, 2}, {1, 3, 7, 7}, {1, 7, 5, 5}};
    return patch;
  };
  const Patch cube = box("cube", Vec3::Zero(), Vec3::Ones(), 0);
  const double half = std::sqrt(0.5);
  const auto meet = [&](const Vec3& centre, double degrees, const Vec3& size) {
    return find_overlaps(build_surface({cube, box("other", centre, size, degrees)}));
  };
  const Vec3 tall(1, 1, 3);
  // A tall box comes with one of its edges through the top and the bottom, on their diagonal too.
  for (const double y : {0.2, 0.4, -0.3}) {
    const auto found = meet({0.4 + half, y, 0}, 45, tall);
    REQUIRE(!found.empty());
    CHECK(found[0].patch != found[0].other);
    CHECK(std::abs(found[0].place_world.x() - 0.45) <= 0.051);
  }
  // It touches, with an edge on a side or on an edge.
  CHECK(meet({0.5 + half, 0.2, 0}, 45, tall).empty());
  CHECK(meet({0.5 + half, 0.5, 0}, 45, tall).empty());
  CHECK(meet({1, 1, 0}, 0, tall).empty());
  // A rod through the wall of a duct.
  Patch duct = box("duct", Vec3::Zero(), 4 * Vec3::Ones(), 0);
  for (std::array<int, 4>& f : duct.faces) f = {f[0], f[2], f[1], f[1]};
  const Patch rod = box("rod", {2, 0.3, 0.1}, {2, 0.1, 0.1}, 0);
  CHECK(find_overlaps(build_surface({duct, rod})).size() == 1);
  const Patch inner = box("inner", {0.7, 0.3, 0.1}, {2, 0.1, 0.1}, 0);
  CHECK(find_overlaps(build_surface({duct, inner})).empty());
}

TEST_CASE("overlaps: closed parts of no thickness are those that enclose nothing") {
  const auto squashed = [](double height) {
    Patch patch = ball("a", 1, Vec3::Zero());
    for (Vec3& p : patch.points_world) p.z() *= height;
    Patch other = ball("b", 1, {3, 0, 0});
    Vec3List vertices = patch.points_world;
    std::vector<Wall::Triangle> triangles;
    for (Patch* of : {&patch, &other}) {
      const int shift = of == &patch ? 0 : static_cast<int>(patch.points_world.size());
      for (const auto& f : of->faces) {
        triangles.push_back({f[0] + shift, f[1] + shift, f[2] + shift});
      }
    }
    vertices.insert(vertices.end(), other.points_world.begin(), other.points_world.end());
    return find_flat_parts(Wall(vertices, triangles));
  };
  CHECK(squashed(1).empty());
  CHECK(squashed(1e-6).empty());
  const std::vector<FlatPart> flat = squashed(1e-11);
  REQUIRE(flat.size() == 1);
  CHECK(flat[0].place_world.x() < 1.5);
  // An ellipsoid's volume is 4/3 pi h, and its two faces are pi each; less for chords.
  CHECK(flat[0].thickness_world < 4e-11 / 3);
  CHECK(flat[0].thickness_world > 3e-11 / 3);
}
