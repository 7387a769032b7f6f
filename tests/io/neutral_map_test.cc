#include "vdb_offset/io/neutral_map.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <map>
#include <string>

#include "io/cgns_round.h"
#include "io/neutral_parse.h"
#include "support/face_ranges.h"
#include "support/temp_folder.h"
#include "vdb_offset/core/error.h"
#include "vdb_offset/io/plot3d.h"
#include "vdb_offset/surface/example.h"

namespace vdb_offset::test {
namespace {

bool same(const BlockRange& a, const BlockRange& b) {
  return a.block == b.block && a.face == b.face && a.begin == b.begin && a.end == b.end;
}

void check_same_map(const NeutralMap& a, const NeutralMap& b) {
  CHECK(a.sizes == b.sizes);
  REQUIRE(a.interfaces.size() == b.interfaces.size());
  for (std::size_t n = 0; n < a.interfaces.size(); ++n) {
    CHECK(same(a.interfaces[n].first, b.interfaces[n].first));
    CHECK(same(a.interfaces[n].second, b.interfaces[n].second));
    CHECK(a.interfaces[n].transform == b.interfaces[n].transform);
  }
  REQUIRE(a.boundary_faces.size() == b.boundary_faces.size());
  for (std::size_t n = 0; n < a.boundary_faces.size(); ++n) {
    CHECK(same(a.boundary_faces[n].range, b.boundary_faces[n].range));
    CHECK(a.boundary_faces[n].name == b.boundary_faces[n].name);
    CHECK(a.boundary_faces[n].kind == b.boundary_faces[n].kind);
    CHECK(a.boundary_faces[n].condition == b.boundary_faces[n].condition);
  }
}

/// Writes and reads: all that a map can say is there, and interfaces are those of the mesh.
NeutralMap check_round_trip(const Surface& surface) {
  const TempFolder folder;
  const MultiBlock mesh = any_mesh(surface);
  const NeutralMap map = neutral_map(mesh);
  write_neutral_map(folder / "mesh.nmf", mesh);
  NeutralMap read = read_neutral_map(folder / "mesh.nmf");
  check_same_map(map, read);
  CHECK(all_of(read.interfaces) == all_of(mesh.interfaces));
  CHECK(read.faults.empty());
  return read;
}

std::map<std::string, int> types_of(const NeutralMap& map) {
  std::map<std::string, int> types;
  for (const BoundaryFace& face : map.boundary_faces) ++types[face.name];
  return types;
}

TEST_CASE("neutral map: what is written comes back, however blocks meet") {
  SUBCASE("in all ways") {
    const auto types = types_of(check_round_trip(build_surface(make_example("sphere"))));
    CHECK(types == std::map<std::string, int>{{"WALL", 6}, {"FARFIELD", 6}});
  }
  SUBCASE("themselves") { check_round_trip(build_surface(make_example("torus"))); }
  SUBCASE("poles, and a block that closes on itself") {
    const auto map = check_round_trip(build_surface(polar_ball()));
    CHECK(map.interfaces.size() == 1);
    // A pole's points are one along i, which is the second direction of a face j = const.
    CHECK(types_of(map)["POLE_DIR2"] == 2);
  }
  SUBCASE("a part of a side") { check_round_trip(build_surface(make_example("draft-tube"))); }
  SUBCASE("first levels that are edges and points") {
    SurfaceOptions options;
    options.fans = 4;
    const auto types = types_of(check_round_trip(build_surface(make_example("cube"), options)));
    CHECK(types.contains("COLLAPSED"));
  }
}

constexpr const char* kPlain = R"(# a comment
2
1 5 4 3
2 3 5 4

ONE_TO_ONE 1 4 1 4 1 3 2 5 1 4 1 3 FALSE
WALL 1 1 5 1 1 4
Symmetry-Y 2 6 1 4 1 3
POLE_DIR1 2 3 1 5 1 4
)";

constexpr const char* kOther =
    "\xEF\xBB\xBF  2   # blocks\r\n"
    "1, 5, 4, 3\r\n 2 3 5 4\r\n"
    "'one-to-one' 1 4 1 4 1 3 \\\r\n  2 5 1 4 1 3 .false.\r\n"
    "\"WALL\" 1 1 \\  \r\n # not this\r\n 5 1 1 4 # a wall\r\n"
    "Symmetry-Y\t2 6 1 4 1 3\r\n"
    "POLE_DIR1 2 3 1 5 1 4";

TEST_CASE(
    "neutral map: quotes, case, commas, comments and lines that go on are read as plain ones") {
  check_same_map(read_neutral_map_bytes(kPlain, "a"), read_neutral_map_bytes(kOther, "b"));
}

TEST_CASE("neutral map: faces, directions and swaps are what the format says") {
  const NeutralMap map = read_neutral_map_bytes(kPlain, "plain");
  // Face 4 is i max with j, k; face 5 is j min with k, i.
  const Interface& face = map.interfaces.at(0);
  CHECK(same(face.first, {0, BlockFace::IMax, {4, 0, 0}, {4, 3, 2}}));
  CHECK(same(face.second, {1, BlockFace::JMin, {0, 0, 0}, {2, 0, 3}}));
  CHECK(face.transform == std::array<int, 3>{2, 3, 1});
  const BoundaryFace& wall = map.boundary_faces.at(0);
  CHECK(same(wall.range, {0, BlockFace::KMin, {4, 0, 0}, {0, 3, 0}}));  // backward along i
  CHECK(wall.kind == BoundaryKind::Wall);
  CHECK(map.boundary_faces.at(1).condition.kind == ConditionKind::Symmetry);
  CHECK(same(map.boundary_faces.at(1).range, {1, BlockFace::JMax, {0, 4, 0}, {2, 4, 3}}));
  CHECK(map.boundary_faces.at(2).kind == BoundaryKind::Degenerate);

  // The first direction (j) along the second (i) of the other, backward.
  const NeutralMap turned = read_neutral_map_bytes(
      "1\n1 4 4 3\nONE_TO_ONE 1 3 1 4 1 3 1 5 1 3 4 1 TRUE\nmine 1 2 1 4 1 4\n", "turned");
  CHECK(turned.interfaces.at(0).transform == std::array<int, 3>{-2, -1, 3});
  CHECK(turned.boundary_faces.at(0).condition == Condition{});
  CHECK(turned.boundary_faces.at(0).name == "mine");
}

TEST_CASE("neutral map: patched interfaces cover both sides, and are a fault") {
  const NeutralMap map = read_neutral_map_bytes(
      "2\n1 5 4 3\n2 3 5 4\npatched 1 4 1 4 1 3 2 5 1 4 1 3 FALSE\n", "patched");
  CHECK(map.interfaces.empty());
  CHECK(map.boundary_faces.size() == 2);
  CHECK(map.faults.size() == 1);
}

/// The message of a text that is refused.
std::string refusal(const std::string& text) {
  try {
    read_neutral_map_bytes(text, "bad.nmf");
  } catch (const IoError& error) {
    return error.what();
  }
  return "was read";
}

TEST_CASE("neutral map: what cannot be is refused by line and value") {
  const auto says = [](const std::string& text, const std::string& part) {
    const std::string said = refusal(text);
    CAPTURE(said);
    CHECK(said.find("bad.nmf") == 0);
    CHECK(said.find(part) != std::string::npos);
  };
  const std::string head = "1\n1 5 4 3\n";
  says("", "is empty");
  says("# nothing\n", "is empty");
  says("0\n", "line 1: number of blocks = 0");
  says("99999999999999999999\n", "line 1: number of blocks \"99999999999999999999\"");
  says("2000000000\n1 2 2 2\n", "ends after 1 of 2000000000 blocks");
  says("many\n", "line 1: number of blocks \"many\"");
  says("1 5 4 3\n", "line 1: 4 words");
  says("1\n2 5 4 3\n", "line 2: block number = 2");
  says("1\n1 5 -4 3\n", "line 2: jdim = -4");
  says("1\n1 5 4 3000000000\n", "line 2: kdim = 3000000000");
  says(head + "WALL 2 1 1 5 1 4\n", "line 3: block = 2");
  says(head + "WALL 1 7 1 5 1 4\n", "line 3: face = 7");
  says(head + "WALL 1 1 1 5 1 5\n", "line 3: E2 = 5, but must be in [1, 4]");
  says(head + "\nWALL 1 1 0 5 1 4\n", "line 4: S1 = 0");
  says(head + "WALL 1 1 1 5 1\n", "line 3: \"WALL\" has 6 words");
  says(head + "WALL 1 1 1 5 1 4 9\n", "line 3: \"WALL\" has 8 words");
  says(head + "ONE_TO_ONE 1 3 1 4 1 3 1 4 1 4 1 3\n", "line 3: \"ONE_TO_ONE\" has 13 words");
  says(head + "ONE_TO_ONE 1 3 1 4 1 3 1 4 1 4 1 3 perhaps\n", "Swap is \"perhaps\"");
  says(head + "WALL 1 1 1 5 \\\n", "goes on");
}

TEST_CASE("neutral map: a grid takes the map of its own sizes alone, and comes back as the mesh") {
  const TempFolder folder;
  const MultiBlock mesh = any_mesh(build_surface(make_example("torus")));
  for (const bool formatted : {false, true}) {
    write_plot3d(folder / "mesh.xyz", mesh, {.formatted = formatted});
    write_neutral_map(folder / "mesh.nmf", mesh);
    ZoneMesh read = read_plot3d_mesh(folder / "mesh.xyz");
    connect(read_neutral_map(folder / "mesh.nmf"), {folder / "mesh.nmf", folder / "mesh.xyz"},
            read);
    REQUIRE(read.zones.size() == mesh.blocks.size());
    for (std::size_t b = 0; b < read.zones.size(); ++b) {
      CHECK(same_bits(read.zones[b].points_world, zone_of(mesh, b).points_world));
    }
    CHECK(all_of(read.interfaces) == all_of(mesh.interfaces));
    CHECK(read.boundary_faces.size() == mesh.boundary_faces.size());
    read.zones[0].nk -= 1;
    const NeutralMap map = read_neutral_map(folder / "mesh.nmf");
    CHECK_THROWS_WITH_AS(connect(map, {"mesh.nmf", "mesh.xyz"}, read),
                         doctest::Contains("mesh.nmf: block 1 is"), IoError);
    read.zones.pop_back();
    CHECK_THROWS_AS(connect(map, {"mesh.nmf", "mesh.xyz"}, read), IoError);
  }
}

TEST_CASE("neutral map: curves have none") {
  const TempFolder folder;
  const MultiBlock mesh = any_mesh(build_surface(make_example("circle")));
  CHECK_THROWS_WITH_AS(write_neutral_map(folder / "a.nmf", mesh),
                       doctest::Contains("three dimensions"), InputError);
  CHECK(folder.listing().empty());
}

}  // namespace
}  // namespace vdb_offset::test
