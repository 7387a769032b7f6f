#include "vdb_offset/blocks/find_interfaces.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <limits>
#include <utility>

#include "support/marched.h"
#include "vdb_offset/blocks/check_mesh.h"
#include "vdb_offset/surface/example.h"

namespace vdb_offset::test {
namespace {

MultiBlock mesh_of(Patches patches) {
  Marched made = marched(std::move(patches),
                         {.distance = 0.1, .voxel = 0.04, .layers = 3, .first_cell = 0.02});
  return build_blocks(made.surface, std::move(made.layers));
}

/// Faces of cells in all interfaces.
std::size_t faces_in(const ZoneMesh& mesh) {
  std::size_t faces = 0;
  for (const Interface& interface : mesh.interfaces) {
    std::size_t here = 1;
    for (std::size_t a = 0; a < 3; ++a) {
      const int length = std::abs(interface.first.end[a] - interface.first.begin[a]);
      here *= static_cast<std::size_t>(std::max(1, length));
    }
    faces += here;
  }
  return faces;
}

bool is_same(const Interface& one, const Interface& other) {
  const auto plain = [](const Interface& i) {
    Interface out = ascending(i);
    out.name.clear();
    return out;
  };
  return plain(one) == plain(other) || plain(one) == plain(reversed(other));
}

}  // namespace

TEST_CASE("find interfaces: the marched blocks' own come back") {
  for (const char* name : {"cube", "torus", "quarter-cylinder", "u-slot", "channel"}) {
    CAPTURE(name);
    const ZoneMesh meant = zone_mesh(mesh_of(make_example(name, {.points = 9})));
    ZoneMesh found = meant;
    found.interfaces.clear();
    CHECK_FALSE(check_mesh(found).is_sound());
    find_interfaces(found);
    CHECK(check_mesh(found).fault_count == 0);
    CHECK(faces_in(found) == faces_in(meant));
    CHECK(found.boundary_faces == meant.boundary_faces);
    for (const Interface& interface : meant.interfaces) {
      CHECK(std::ranges::any_of(found.interfaces,
                                [&](const Interface& one) { return is_same(one, interface); }));
    }
  }
}

TEST_CASE("find interfaces: a block may meet itself, whole or folded on one face") {
  for (const bool folded : {false, true}) {
    CAPTURE(folded);
    ZoneMesh mesh;
    Zone zone{"zone", "", 9, 4, 3};
    for (int k = 0; k < 3; ++k) {
      for (int j = 0; j < 4; ++j) {
        for (int i = 0; i < 9; ++i) {
          // a ring about z whose ends meet, or a cut along x that i runs round
          constexpr std::array<std::array<double, 2>, 8> kRing{
              {{2, 0}, {1, 1}, {0, 2}, {-1, 1}, {-2, 0}, {-1, -1}, {0, -2}, {1, -1}}};
          const auto& [x, y] = kRing[static_cast<std::size_t>((8 - i) % 8)];
          const double side = i < 4 ? -1 : i > 4 ? 1 : 0;
          const Vec3 on_ring((1.0 + j) * x, (1.0 + j) * y, k);
          const Vec3 at_cut(std::abs(i - 4) - j * (i == 4 ? 1 : 0), side * j, k);
          zone.points_world.push_back(folded ? at_cut : on_ring);
        }
      }
    }
    mesh.zones.push_back(zone);
    find_interfaces(mesh);
    REQUIRE(mesh.interfaces.size() == 1);
    const Interface& one = mesh.interfaces[0];
    CHECK(faces_in(mesh) == (folded ? 4 * 2 : 3 * 2));
    CHECK(one.transform == (folded ? std::array{-1, -2, 3} : std::array{1, 2, 3}));
    CHECK(one.first.face == (folded ? BlockFace::JMin : BlockFace::IMin));
    const MeshCheck check = check_mesh(mesh);
    CHECK(std::ranges::none_of(
        check.faults, [](const MeshFault& fault) { return fault.kind != FaultKind::Uncovered; }));
  }
}

TEST_CASE("find interfaces: a boundary with cells behind it is an internal surface of its name") {
  ZoneMesh mesh = zone_mesh(mesh_of(make_example("cube", {.points = 5})));
  const std::size_t interfaces = mesh.interfaces.size();
  const Interface one = mesh.interfaces.front();
  mesh.boundary_faces.push_back({BoundaryKind::Boundary, "screen", one.first});
  mesh.interfaces.clear();
  find_interfaces(mesh);
  CHECK(mesh.interfaces.size() == interfaces);
  CHECK(is_same(mesh.interfaces.front(), one));
  CHECK(mesh.interfaces.front().name == "screen");
  CHECK(check_mesh(mesh).fault_count == 0);
}

TEST_CASE("find interfaces: points that are apart, or no numbers, make none") {
  const ZoneMesh meant = zone_mesh(mesh_of(make_example("cube", {.points = 5})));
  for (const double by : {1e-9, std::numeric_limits<double>::quiet_NaN()}) {
    ZoneMesh mesh = meant;
    mesh.interfaces.clear();
    Zone& zone = mesh.zones[0];
    zone.at(0, 2, 2).x() += by;
    find_interfaces(mesh);
    CHECK(faces_in(mesh) == faces_in(meant) - 4);
  }
}

}  // namespace vdb_offset::test
