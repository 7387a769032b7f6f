// SU2 and OpenFOAM files of other hands: what is read, and what is refused with file, line, value
// and rule.

#include <doctest/doctest.h>

#include <array>
#include <filesystem>
#include <fstream>
#include <random>
#include <sstream>
#include <string>

#include "support/hand_made.h"
#include "support/temp_folder.h"
#include "vdb_offset/blocks/check_cells.h"
#include "vdb_offset/core/error.h"
#include "vdb_offset/io/openfoam.h"
#include "vdb_offset/io/su2.h"

namespace vdb_offset::test {
namespace {

namespace fs = std::filesystem;

void put(const fs::path& file, const std::string& bytes) {
  std::ofstream(file, std::ios::binary) << bytes;
}

/// A cube, a pyramid on it and a tetrahedron beside that; points have numbers behind them.
const std::string kSu2 =
    "% of another hand\r\nNDIME=3\nNMARK=1\nMARKER_TAG= all % the lot\nMARKER_ELEMS= 11\n"
    "9 0 1 2 3\n9 0 1 5 4\n9 1 2 6 5\n9 2 3 7 6\n9 3 0 4 7\n5 4 5 8\n5 5 6 8\n5 6 7 8\n"
    "5 4 7 9\n5 4 8 9\n5 7 8 9\n"
    "NELEM= 3\n12 0 1 2 3 4 5 6 7 0\n14 4 5 6 7 8 1\n10 4 7 9 8 2\n"
    "NPOIN= 10 10\n0 0 0 0\n1 0 0 1\n1 1 0 2\n0 1 0 3\n0 0 1 4\n1 0 1 5\n1 1 1 6\n0 1 1 7\n"
    ".5D0 .5 2 8\n-1 +.5 1.5 9\n";

std::string replaced(std::string text, const std::string& from, const std::string& to) {
  const std::size_t at = text.find(from);
  REQUIRE(at != std::string::npos);
  return text.replace(at, from.size(), to);
}

template <typename Read>
std::string why_not(const Read& read) {
  try {
    read();
  } catch (const IoError& error) {
    return error.what();
  }
  return "it was read";
}

}  // namespace

TEST_CASE("su2: a mesh of another hand is read, its faces fit") {
  const TempFolder folder;
  put(folder / "m.su2", kSu2);
  const CellZone mesh = read_su2(folder / "m.su2");
  CHECK(mesh.points_world.size() == 10);
  CHECK(mesh.points_world[8] == Vec3(0.5, 0.5, 2));
  REQUIRE(mesh.kinds.size() == 3);
  CHECK(mesh.kinds[1] == CellKind::Pyramid);
  REQUIRE(mesh.boundaries.size() == 1);
  CHECK(mesh.boundaries[0].name == "all");
  const CellCheck check = check_cells(mesh);
  CHECK(check.fault_count == 0);
  CHECK(check.quality.nonpositive_cells == 0);
  CHECK(check.quality.min_volume > 0);
}

TEST_CASE("su2: two dimensions are made one cell thick, between front and back") {
  const TempFolder folder;
  put(folder / "m.su2",
      "NDIME= 2\nNELEM= 2\n9 0 1 2 3\n5 1 4 2\nNPOIN= 5\n0 0\n2 0\n2 2\n0 2\n3 1\n"
      "NMARK= 1\nMARKER_TAG= rim\nMARKER_ELEMS= 5\n3 0 1\n3 1 4\n3 4 2\n3 2 3\n3 3 0\n");
  const CellZone mesh = read_su2(folder / "m.su2");
  CHECK(mesh.flat);
  const CellCheck check = check_cells(mesh);
  CHECK(check.is_sound());
  CHECK(check.quality.cells == 2);
  CHECK(check.kinds[static_cast<std::size_t>(CellKind::Hexahedron)].min_volume ==
        doctest::Approx(4 * 3));
  CHECK(check.boundary_faces == 5 + 2 * 2);
}

TEST_CASE("su2: what is wrong is refused with file, line, value and rule") {
  const TempFolder folder;
  struct Lie {
    const char *from, *to, *said;
  };
  const std::array<Lie, 12> lies{{{"NDIME=3", "NDIME=4", "NDIME = 4, but must be in [0, 3]"},
                                  {"NDIME=3", "NDIME=1", "must be 2 or 3"},
                                  {"NDIME=3", "", "NDIME"},
                                  {"NELEM= 3", "NELEM= 4000000000", "NELEM = 4000000000"},
                                  {"NELEM= 3", "NELEM= -3", "NELEM = -3"},
                                  {"NELEM= 3", "NELEM= 4", "element type"},
                                  {"12 0 1", "11 0 1", "element type 11"},
                                  {"12 0 1", "12 0 10", "point 10, but there are 10"},
                                  {"14 4 5 6 7 8 1", "14 4 5 6 7", "words"},
                                  {"14 4 5 6", "14 4 x 6", "\"x\" is no whole number"},
                                  {"-1 +.5 1.5 9", "-1 nan 1.5 9", "no finite number"},
                                  {"MARKER_ELEMS= 11", "MARKER_ELEMS= 99", "element type"}}};
  for (const Lie& lie : lies) {
    put(folder / "m.su2", replaced(kSu2, lie.from, lie.to));
    const std::string said = why_not([&] { read_su2(folder / "m.su2"); });
    CAPTURE(lie.to);
    CAPTURE(said);
    CHECK(said.find("m.su2") != std::string::npos);
    CHECK(said.find(lie.said) != std::string::npos);
  }
}

TEST_CASE(
    "openfoam: blocks come back as hexahedra with the same points, patches with their types") {
  const TempFolder folder;
  const MultiBlock blocks = wavy_plate(5, 4, 3);
  write_openfoam(folder / "case", blocks);
  for (const char* name : {"case", "case/any.foam", "case/constant", "case/constant/polyMesh"}) {
    CAPTURE(name);
    const CellZone mesh = read_openfoam(folder / name);
    CHECK(mesh.points_world == blocks.layers.points_world);
    CHECK(mesh.kinds == std::vector(4 * 3 * 3, CellKind::Hexahedron));
    const CellCheck check = check_cells(mesh);
    CHECK(check.is_sound());
    CHECK(check.quality.min_scaled_jacobian ==
          doctest::Approx(judge(blocks).report.min_scaled_jacobian).epsilon(1e-12));
  }
}

TEST_CASE("openfoam: what is wrong is refused with file, line, value and rule") {
  const TempFolder folder;
  const MultiBlock blocks = wavy_plate(3, 3, 2);
  struct Lie {
    const char *file, *from, *to, *said;
  };
  const std::array<Lie, 11> lies{
      {{"points", "ascii", "binary", "only ascii"},
       {"points", "vectorField", "labelList", "'vectorField' is expected"},
       {"points", "27\n(", "28\n(", "'(' is expected"},
       {"points", "27\n(", "999999999\n(", "count = 999999999"},
       {"points", "(0 ", "(nan ", "no finite number"},
       {"faces", "4(", "4000000(", "points of a face"},
       {"faces", "4(", "4(99 ", "point = 99"},
       {"owner", "\n(\n0", "\n(\n77", "cell = 77"},
       {"neighbour", "\n(\n", "\n(\n-", "cell"},
       {"boundary", "nFaces          4", "nFaces          400", "nFaces = 400"},
       {"boundary", "startFace       ", "startFace       9", "startFace"}}};
  for (const Lie& lie : lies) {
    write_openfoam(folder / "case", blocks);
    const fs::path file = folder / "case" / "constant" / "polyMesh" / lie.file;
    put(file, replaced(file_bytes(file), lie.from, lie.to));
    const std::string said = why_not([&] { read_openfoam(folder / "case"); });
    CAPTURE(lie.to);
    CAPTURE(said);
    CHECK(said.find(std::string("polyMesh/") + lie.file) != std::string::npos);
    CHECK(said.find(lie.said) != std::string::npos);
  }
}

TEST_CASE("openfoam: a face that is turned over is found") {
  const TempFolder folder;
  write_openfoam(folder / "case", wavy_plate(3, 3, 2));
  const fs::path file = folder / "case" / "constant" / "polyMesh" / "faces";
  std::string bytes = file_bytes(file);
  const std::size_t begin = bytes.find("4(") + 2;
  const std::size_t end = bytes.find(')', begin);
  std::istringstream corners(bytes.substr(begin, end - begin));
  std::array<int, 4> p{};
  for (int& corner : p) corners >> corner;
  bytes.replace(begin, end - begin,
                std::to_string(p[3]) + " " + std::to_string(p[2]) + " " + std::to_string(p[1]) +
                    " " + std::to_string(p[0]));
  put(file, bytes);
  const CellZone mesh = read_openfoam(folder / "case");
  REQUIRE(mesh.faults.size() == 1);
  CHECK(mesh.faults[0].starts_with("2 cells whose faces do not close"));
}

TEST_CASE("cells: damaged files are read or refused, never worse") {
  const TempFolder folder;
  write_openfoam(folder / "case", wavy_plate(3, 3, 2));
  std::mt19937 random(11);
  const std::string letters = "0123456789-.(){};%= \n/*x\xFF";
  const auto damage = [&](const fs::path& file, const auto& read) {
    const std::string good = file_bytes(file);
    int refused = 0;
    for (int n = 0; n < 200; ++n) {
      std::string bytes = good;
      bytes[random() % bytes.size()] = letters[random() % letters.size()];
      if (n % 10 == 0) bytes.resize(random() % bytes.size());
      put(file, bytes);
      refused += why_not([&] { check_cells(read()); }) != "it was read" ? 1 : 0;
    }
    put(file, good);
    return refused;
  };
  put(folder / "m.su2", kSu2);
  CHECK(damage(folder / "m.su2", [&] { return read_su2(folder / "m.su2"); }) > 20);
  for (const char* name : {"points", "faces", "owner", "neighbour", "boundary"}) {
    CAPTURE(name);
    CHECK(damage(folder / "case" / "constant" / "polyMesh" / name,
                 [&] { return read_openfoam(folder / "case"); }) > 10);
  }
}

}  // namespace vdb_offset::test
