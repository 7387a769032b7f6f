#include "vdb_offset/io/cgns.h"

#include <doctest/doctest.h>

#include <Eigen/Geometry>
#include <array>
#include <set>
#include <string>

#include "io/cgns_names.h"
#include "io/cgns_round.h"
#include "support/face_ranges.h"
#include "support/temp_folder.h"
#include "vdb_offset/core/error.h"
#include "vdb_offset/surface/example.h"

namespace vdb_offset::test {
namespace {

void check_round_trip(const Surface& surface, const ConditionOptions& conditions = {}) {
  const TempFolder folder;
  MultiBlock mesh = any_mesh(surface);
  set_conditions(surface, conditions, mesh);
  check_covered_once(mesh);
  write_cgns(folder / "mesh.cgns", mesh);
  check_same(zone_mesh(mesh), read_cgns_mesh(folder / "mesh.cgns"));
  CHECK(folder.listing() == std::vector<std::string>{"mesh.cgns"});
}

TEST_CASE("cgns: blocks come back to the bit, with interfaces, boundaries and conditions") {
  SUBCASE("blocks that meet in all ways") {
    check_round_trip(build_surface(make_example("sphere")));
  }
  SUBCASE("blocks that meet themselves") { check_round_trip(build_surface(make_example("torus"))); }
  SUBCASE("poles, and a block that closes on itself") {
    check_round_trip(build_surface(polar_ball()));
  }
  SUBCASE("two dimensions") { check_round_trip(build_surface(make_example("circle"))); }
  SUBCASE("planes, and sides that meet a part of others") {
    check_round_trip(build_surface(make_example("draft-tube")));
  }
  SUBCASE("first levels that are edges and points") {
    SurfaceOptions options;
    options.fans = 4;
    check_round_trip(build_surface(make_example("cube"), options));
  }
  SUBCASE("free sides, overset, and conditions of patches") {
    SurfaceOptions options;
    options.open_edges = OpenEdges::Splay;
    ConditionOptions conditions;
    conditions.outer = ConditionKind::Overset;
    conditions.named = {{"free", parse_condition("overset")},
                        {"side", parse_condition("BCWallViscousIsothermal")}};
    check_round_trip(build_surface(make_example("quarter-cylinder"), options), conditions);
  }
}

TEST_CASE("cgns: blocks that are written part by part come back to the bit") {
  const TempFolder folder;
  for (const MultiBlock& mesh : {wavy_plate(301, 203, 40), wavy_plate(8, 9, 150)}) {
    const Block& block = mesh.blocks[0];
    REQUIRE((block.point_count() > 2 * kCgnsSlab || block.nk > 128));
    write_cgns(folder / "mesh.cgns", mesh);
    const ZoneMesh read = read_cgns_mesh(folder / "mesh.cgns");
    CHECK(same_bits(read.zones.at(0).points_world, zone_of(mesh, 0).points_world));
  }
}

TEST_CASE("cgns: a surface comes back to the bit, with its families") {
  const TempFolder folder;
  Patches patches = make_example("wing-on-cylinder");
  for (Patch& patch : patches) patch.family = patch.family + " of the wing";
  write_cgns(folder / "wing.cgns", patches, {"millimeter"});
  const Patches read = read_cgns(folder / "wing.cgns");
  REQUIRE(read.size() == patches.size());
  for (std::size_t p = 0; p < read.size(); ++p) {
    CHECK(read[p].name == patches[p].name);
    CHECK(read[p].family == patches[p].family);
    CHECK(read[p].ni == patches[p].ni);
    CHECK(same_bits(read[p].points_world, patches[p].points_world));
  }
  const CgnsInfo info = inspect_cgns(folder / "wing.cgns");
  CHECK(info.is_surface());
  CHECK(info.length_unit == "Millimeter");
  CHECK(info.container == "HDF5");
  CHECK(info.cell_dimension == 2);
}

TEST_CASE("cgns: names are legal and single, and stay what they are where they can") {
  CgnsNames names;
  CHECK(names.take("wing") == "wing");
  CHECK(names.take("wing") == "wing-2");
  CHECK(names.take("a/b") == "a_b");
  CHECK(names.take("  ") == "unnamed");
  CHECK(names.take("..") == "unnamed-2");
  const std::string longest(kCgnsName, 'x');
  CHECK(names.take(longest) == longest);
  CHECK(names.take(longest + "y") == std::string(kCgnsName - 2, 'x') + "-2");
  std::string umlauts;
  for (int n = 0; n < 20; ++n) umlauts += "\xC3\xA4";
  umlauts.insert(0, "x");
  CHECK(names.take(umlauts) == umlauts.substr(0, kCgnsName - 1));  // no half of one
  const TempFolder folder;
  Surface surface = build_surface(make_example("sphere"));
  for (Patch& patch : surface.patches) patch.name = patch.family = std::string(50, 'a');
  write_cgns(folder / "long.cgns", any_mesh(surface));
  std::set<std::string> zones;
  for (const Zone& zone : read_cgns_mesh(folder / "long.cgns").zones) zones.insert(zone.name);
  CHECK(zones.size() == 6);
}

/// A plate whose only wall is one face, with the first index turned round or not.
MultiBlock walled(BlockFace face, bool left_handed) {
  MultiBlock mesh = wavy_plate(5, 4, 3);
  Block& block = mesh.blocks[0];
  if (left_handed) {
    for (int j = 0; j < block.nj; ++j) {
      std::reverse(block.columns.begin() + j * block.ni,
                   block.columns.begin() + (j + 1) * block.ni);
    }
  }
  for (BoundaryFace& one : mesh.boundary_faces) {
    one.condition = {one.range.face == face ? ConditionKind::Wall : ConditionKind::Farfield};
    one.name = one.range.face == face ? "skin" : "rest";
  }
  return mesh;
}

TEST_CASE("cgns: walls of a volume become patches whose normals point into it") {
  for (int f = 0; f < 6; ++f) {
    for (const bool left_handed : {false, true}) {
      CAPTURE(f);
      CAPTURE(left_handed);
      const TempFolder folder;
      const MultiBlock mesh = walled(static_cast<BlockFace>(f), left_handed);
      write_cgns(folder / "mesh.cgns", mesh);
      const Patches patches = read_cgns(folder / "mesh.cgns");
      REQUIRE(patches.size() == 1);
      CHECK(patches[0].family == "skin");
      const Zone zone = zone_of(mesh, 0);
      const Patch& patch = patches[0];
      const Vec3& at = patch.at(1, 1);
      const auto found = std::ranges::find(zone.points_world, at) - zone.points_world.begin();
      const Index3 strides{1, zone.ni, zone.ni * zone.nj};
      const int stride = strides[static_cast<std::size_t>(f / 2)];
      const auto inner = static_cast<std::size_t>(found + (f % 2 == 0 ? stride : -stride));
      const Vec3 normal = (patch.at(2, 1) - at).cross(patch.at(1, 2) - at);
      CHECK(normal.dot(zone.points_world[inner] - at) > 0);
      const auto is_of_zone = [&](const Vec3& p) {
        return std::ranges::count(zone.points_world, p) == 1;
      };
      CHECK(std::ranges::all_of(patch.points_world, is_of_zone));
    }
  }
}

TEST_CASE("cgns: what cannot be written leaves no file and says why") {
  const TempFolder folder;
  const MultiBlock mesh = wavy_plate(3, 3, 2);
  CHECK_THROWS_WITH_AS(write_cgns(folder / "m.cgns", mesh, {"furlong"}),
                       doctest::Contains("furlong"), InputError);
  CHECK_THROWS_WITH_AS(write_cgns(folder / "no" / "m.cgns", mesh), doctest::Contains("no folder"),
                       IoError);
  CHECK_THROWS_AS(write_cgns(folder / "c.cgns", make_example("circle")), InputError);
  CHECK(folder.listing().empty());
}

TEST_CASE("cgns: a mesh of real files is read, and its wall is a surface") {
  const auto data = shared_data();
  if (!data) {
    MESSAGE("skipped: no shared data");
    return;
  }
  const ZoneMesh mesh = read_cgns_mesh(*data + "/cgns/717_wl_L2.cgns");
  CHECK(mesh.cells() == 15120);
  CHECK(mesh.faults.empty());
  CHECK(mesh.interfaces.size() == 8);  // 16 nodes
  for (const Interface& interface : mesh.interfaces) {
    for_points(interface.first, [&](const Index3& p) {
      const Index3 q = to_donor(interface, p);
      const Zone& a = mesh.zones[static_cast<std::size_t>(interface.first.block)];
      const Zone& b = mesh.zones[static_cast<std::size_t>(interface.second.block)];
      CHECK((a.at(p[0], p[1], p[2]) - b.at(q[0], q[1], q[2])).norm() < 1e-12);
    });
  }
  const Surface wall = build_surface(read_cgns(*data + "/cgns/717_wl_L2.cgns"));
  CHECK(wall.faces() == 756);  // 15,120 cells in 20 layers
  const Patches corner = read_cgns(*data + "/cgns/pyhyp_corner.cgns");
  CHECK(build_surface(corner).nodes_world.size() == 496);  // 2 x 256, 16 of them shared
  CHECK_THROWS_WITH_AS(read_cgns(*data + "/cgns/block_4x2x3.cgns"), doctest::Contains("no walls"),
                       IoError);
}

}  // namespace
}  // namespace vdb_offset::test
