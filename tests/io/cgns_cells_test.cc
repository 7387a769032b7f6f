// Unstructured zones: what write_cgns makes of columns, and files that libcgns writes.

#include <cgnslib.h>
#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <fstream>
#include <optional>
#include <random>
#include <string>
#include <vector>

#include "support/polygons.h"
#include "support/temp_folder.h"
#include "vdb_offset/blocks/check_cells.h"
#include "vdb_offset/core/error.h"
#include "vdb_offset/io/cgns.h"
#include "vdb_offset/io/su2.h"
#include "vdb_offset/pipeline.h"
#include "vdb_offset/surface/example.h"

namespace vdb_offset::test {
namespace {

namespace fs = std::filesystem;

using Numbers = std::vector<cgsize_t>;

/// A cube with a pyramid on it and a tetrahedron beside that, their outer faces as triangles and
/// quads; written by libcgns. What is changed before `write` is a file that is wrong, or another's.
struct Hand {
  std::array<std::vector<double>, 3> coordinates{{{0, 1, 1, 0, 0, 1, 1, 0, .5, -1},
                                                  {0, 0, 1, 1, 0, 0, 1, 1, .5, .5},
                                                  {0, 0, 0, 0, 1, 1, 1, 1, 2, 1.5}}};
  struct Section {
    const char* name;
    ElementType_t type;
    cgsize_t first, last;
    Numbers points;
  };
  std::vector<Section> sections{{"hexa", CGNS_ENUMV(HEXA_8), 1, 1, {1, 2, 3, 4, 5, 6, 7, 8}},
                                {"pyra", CGNS_ENUMV(PYRA_5), 2, 2, {5, 6, 7, 8, 9}},
                                {"tetra", CGNS_ENUMV(TETRA_4), 3, 3, {5, 8, 10, 9}},
                                {"quads", CGNS_ENUMV(QUAD_4), 4, 8, {1, 2, 3, 4, 1, 2, 6, 5, 2, 3,
                                                                     7, 6, 3, 4, 8, 7, 4, 1, 5, 8}},
                                {"tris",
                                 CGNS_ENUMV(TRI_3),
                                 9,
                                 14,
                                 {5, 6, 9, 6, 7, 9, 7, 8, 9, 5, 8, 10, 5, 9, 10, 8, 9, 10}}};
  cgsize_t cells = 3;
  PointSetType_t set = CGNS_ENUMV(PointRange);
  Numbers wall{4, 8};
  Numbers rest{9, 14};
  GridLocation_t location = CGNS_ENUMV(FaceCenter);

  void write(const fs::path& file) const {
    int f = 0;
    int base = 0;
    int zone = 0;
    int index = 0;
    REQUIRE(cg_set_file_type(CG_FILE_HDF5) == CG_OK);
    REQUIRE(cg_open(file.c_str(), CG_MODE_WRITE, &f) == CG_OK);
    REQUIRE(cg_base_write(f, "Base", 3, 3, &base) == CG_OK);
    REQUIRE(cg_family_write(f, base, "skin", &index) == CG_OK);
    REQUIRE(cg_fambc_write(f, base, index, "FamBC", CGNS_ENUMV(BCWallViscous), &index) == CG_OK);
    const std::array<cgsize_t, 3> size{static_cast<cgsize_t>(coordinates[0].size()), cells, 0};
    REQUIRE(cg_zone_write(f, base, "any", size.data(), CGNS_ENUMV(Unstructured), &zone) == CG_OK);
    for (std::size_t a = 0; a < 3; ++a) {
      const std::string name = std::string("Coordinate") + "XYZ"[a];
      REQUIRE(cg_coord_write(f, base, zone, CGNS_ENUMV(RealDouble), name.c_str(),
                             coordinates[a].data(), &index) == CG_OK);
    }
    for (const Section& s : sections) write_section(f, s);
    write_boundary(f, "bottom", wall);
    REQUIRE(cg_goto(f, base, "Zone_t", zone, "ZoneBC_t", 1, "BC_t", 1, "end") == CG_OK);
    REQUIRE(cg_famname_write("skin") == CG_OK);
    write_boundary(f, "top", rest);
    REQUIRE(cg_close(f) == CG_OK);
  }

 private:
  static void write_section(int f, const Section& s) {
    int index = 0;
#if CGNS_VERSION >= 3400
    if (s.type == CGNS_ENUMV(MIXED)) {
      Numbers offsets{0};
      for (cgsize_t at = 0; at < static_cast<cgsize_t>(s.points.size());) {
        int corners = 0;
        cg_npe(static_cast<ElementType_t>(s.points[static_cast<std::size_t>(at)]), &corners);
        offsets.push_back(at += corners + 1);
      }
      REQUIRE(cg_poly_section_write(f, 1, 1, s.name, s.type, s.first, s.last, 0, s.points.data(),
                                    offsets.data(), &index) == CG_OK);
      return;
    }
#endif
    REQUIRE(cg_section_write(f, 1, 1, s.name, s.type, s.first, s.last, 0, s.points.data(),
                             &index) == CG_OK);
  }

  void write_boundary(int f, const char* name, const Numbers& elements) const {
    int index = 0;
    const bool is_skin = std::string(name) == "bottom";
    REQUIRE(cg_boco_write(
                f, 1, 1, name, is_skin ? CGNS_ENUMV(FamilySpecified) : CGNS_ENUMV(BCFarfield), set,
                static_cast<cgsize_t>(elements.size()), elements.data(), &index) == CG_OK);
    if (location == CGNS_ENUMV(Vertex)) return;
    REQUIRE(cg_boco_gridlocation_write(f, 1, 1, index, location) == CG_OK);
  }
};

void check_hand(const CellZone& mesh) {
  CHECK(mesh.faults == std::vector<std::string>{});
  CHECK(mesh.points_world.size() == 10);
  CHECK(std::ranges::count(mesh.kinds, CellKind::Pyramid) == 1);
  REQUIRE(mesh.boundaries.size() == 2);
  CHECK(mesh.boundaries[0].name == "skin");
  CHECK(mesh.boundaries[0].type == "BCWallViscous");
  CHECK(mesh.boundaries[0].faces.size() == 5);
  CHECK(mesh.boundaries[1].name == "top");
  CHECK(mesh.boundaries[1].type == "BCFarfield");
  CHECK(mesh.boundaries[1].faces.size() == 6);
  const CellCheck check = check_cells(mesh);
  CHECK(check.is_sound());
  // A cube, a pyramid of height 1, a tetrahedron of det((0,1,0), (-1,.5,.5), (.5,.5,1)) = 1.25.
  using Kind = CellKind;
  const auto volume = [&](Kind k) { return check.kinds[static_cast<std::size_t>(k)].min_volume; };
  CHECK(volume(Kind::Hexahedron) == doctest::Approx(1));
  CHECK(volume(Kind::Pyramid) == doctest::Approx(1.0 / 3));
  CHECK(volume(Kind::Tetrahedron) == doctest::Approx(1.25 / 6));
}

void put_bytes(const fs::path& file, const std::string& bytes) {
  std::ofstream(file, std::ios::binary) << bytes;
}

}  // namespace

TEST_CASE("cgns cells: columns come back as SU2 has them: points, cells, quality, boundaries") {
  Patches mixed = make_example("sphere", {.points = 5});
  mixed[1] = as_polygons(mixed[1]);
  mixed[4] = as_triangles(mixed[4]);
  mixed[4].family = "triangles";
  Patches open{as_triangles(make_example("quarter-cylinder", {.points = 5}).front())};
  const TempFolder folder;
  for (const Patches& patches : {mixed, open, Patches{icosphere(1)}}) {
    PipelineOptions options;
    options.distance_world = 0.2;
    options.spacing.layers = 4;
    options.spacing.first_cell_world = 0.02;
    const MeshResult made = make_mesh(patches, options);
    write_cgns(folder / "m.cgns", made.mesh);
    write_su2(folder / "m.su2", made.mesh);
    CHECK(inspect_cgns(folder / "m.cgns").is_unstructured());
    const CellZone cgns = read_cgns_cells(folder / "m.cgns");
    const CellZone su2 = read_su2(folder / "m.su2");
    CHECK(cgns.faults.empty());
    CHECK(cgns.points_world == su2.points_world);
    REQUIRE(cgns.kinds.size() == su2.kinds.size());
    REQUIRE(cgns.boundaries.size() == su2.boundaries.size());
    for (std::size_t b = 0; b < cgns.boundaries.size(); ++b) {
      CHECK(cgns.boundaries[b].name == su2.boundaries[b].name);
      CHECK(cgns.boundaries[b].faces.size() == su2.boundaries[b].faces.size());
    }
    const CellCheck a = check_cells(cgns);
    const CellCheck b = check_cells(su2);
    CHECK(a.is_sound());
    CHECK(a.quality.min_scaled_jacobian == b.quality.min_scaled_jacobian);
    CHECK(a.mean_scaled_jacobian == doctest::Approx(b.mean_scaled_jacobian).epsilon(1e-12));
    CHECK(a.inner_faces == b.inner_faces);
    CHECK(a.boundary_faces == b.boundary_faces);
  }
}

TEST_CASE("cgns cells: sections of one kind or mixed, BCs as ranges or lists of faces") {
  const TempFolder folder;
  Hand hand;
  SUBCASE("of one kind, ranges") {}
  SUBCASE("of one kind, lists") {
    hand.set = CGNS_ENUMV(PointList);
    hand.wall = {8, 7, 6, 5, 4};
    hand.rest = {9, 10, 11, 12, 13, 14};
  }
  SUBCASE("in another order") { std::swap(hand.sections[0], hand.sections[4]); }
  SUBCASE("mixed, cells and faces together") {
    Numbers words;
    for (const Hand::Section& s : hand.sections) {
      int corners = 0;
      cg_npe(s.type, &corners);
      for (std::size_t p = 0; p < s.points.size(); ++p) {
        if (p % static_cast<std::size_t>(corners) == 0) words.push_back(s.type);
        words.push_back(s.points[p]);
      }
    }
    hand.sections = {{"all", CGNS_ENUMV(MIXED), 1, 14, words}};
  }
  hand.write(folder / "m.cgns");
  check_hand(read_cgns_cells(folder / "m.cgns"));
}

TEST_CASE("cgns cells: what is wrong is refused with file, node, value and rule") {
  const TempFolder folder;
  Hand hand;
  const char* said = "";
  SUBCASE("a point that there is not") {
    hand.sections[1].points[4] = 11;
    said = "Base/any/pyra/ElementConnectivity: names the point 11, but its zone has 10";
  }
  SUBCASE("point 0") {
    hand.sections[1].points[4] = 0;
    said = "names the point 0";
  }
  SUBCASE("elements with numbers of others") {
    hand.sections[1].first = hand.sections[1].last = 1;
    said = "two sections with an element 1";
  }
  SUBCASE("elements of higher order") {
    hand.sections[2].type = CGNS_ENUMV(TETRA_10);
    hand.sections[2].points = {5, 8, 10, 9, 1, 2, 3, 4, 6, 7};
    said = "elements of type TETRA_10";
  }
  SUBCASE("a mixed section with elements of higher order") {
    hand.sections[0] = {"hexa", CGNS_ENUMV(MIXED), 1, 1, {CGNS_ENUMV(TRI_6), 1, 2, 3, 4, 5, 6}};
    said = "element 1 of type TRI_6";
  }
  SUBCASE("faces alone") {
    hand.sections.erase(hand.sections.begin(), hand.sections.begin() + 3);
    said = "has no cells";
  }
  hand.write(folder / "m.cgns");
  CHECK_THROWS_WITH_AS(read_cgns_cells(folder / "m.cgns"), doctest::Contains(said), IoError);
  CHECK_THROWS_WITH_AS(read_cgns_mesh(folder / "m.cgns"), doctest::Contains("is unstructured"),
                       IoError);
  CHECK_THROWS_WITH_AS(read_cgns(folder / "m.cgns"), doctest::Contains("is unstructured"), IoError);
}

TEST_CASE("cgns cells: polyhedra are refused by name") {
  const TempFolder folder;
  const auto file = folder / "m.cgns";
  Hand hand;
  hand.sections.resize(1);
  hand.write(file);
  int f = 0;
  int index = 0;
  REQUIRE(cg_open(file.c_str(), CG_MODE_MODIFY, &f) == CG_OK);
#if CGNS_VERSION >= 3400
  const Numbers faces{1, 2, 3, 4};
  const Numbers offsets{0, 4};
  REQUIRE(cg_poly_section_write(f, 1, 1, "faces", CGNS_ENUMV(NGON_n), 2, 2, 0, faces.data(),
                                offsets.data(), &index) == CG_OK);
#else
  const Numbers faces{4, 1, 2, 3, 4};
  REQUIRE(cg_section_write(f, 1, 1, "faces", CGNS_ENUMV(NGON_n), 2, 2, 0, faces.data(), &index) ==
          CG_OK);
#endif
  REQUIRE(cg_close(f) == CG_OK);
  CHECK_THROWS_WITH_AS(read_cgns_cells(file), doctest::Contains("elements of type NGON_n"),
                       IoError);
}

TEST_CASE("cgns cells: what does not fit is a fault by name") {
  const TempFolder folder;
  Hand hand;
  std::vector<std::string> said;
  SUBCASE("a number of cells that the zone does not have") {
    hand.cells = 4;
    said = {"zone 'any' says that it has 4 cells, and its sections have 3"};
  }
  SUBCASE("BCs of cells, or beyond all elements") {
    hand.wall = {3, 8};
    hand.rest = {9, 15};
    said = {"zone 'any' 'bottom' names 1 elements that are no faces of it",
            "zone 'any' 'top' names 1 elements that are no faces of it"};
  }
  SUBCASE("BCs of points") {
    hand.location = CGNS_ENUMV(Vertex);
    hand.set = CGNS_ENUMV(PointList);
    hand.wall = {1, 2, 3, 4};
    hand.rest = {5, 6, 7};
    said = {"zone 'any' 'bottom' is of points at Vertex, which do not say what faces it has",
            "zone 'any' 'top' is of points at Vertex, which do not say what faces it has"};
  }
  hand.write(folder / "m.cgns");
  const CellZone mesh = read_cgns_cells(folder / "m.cgns");
  CHECK(mesh.faults == said);
  CHECK_FALSE(check_cells(mesh).is_sound());
}

TEST_CASE("cgns cells: cut and damaged files are read or refused, never worse") {
  const TempFolder folder;
  Hand{}.write(folder / "m.cgns");
  int f = 0;
  REQUIRE(cg_open((folder / "m.cgns").c_str(), CG_MODE_READ, &f) == CG_OK);
  REQUIRE(cg_save_as(f, (folder / "adf.cgns").c_str(), CG_FILE_ADF, 0) == CG_OK);
  REQUIRE(cg_close(f) == CG_OK);
  std::mt19937 random(13);
  for (const char* name : {"m.cgns", "adf.cgns"}) {
    const std::string whole = file_bytes(folder / name);
    const auto is_refused = [&](const std::string& bytes) {
      put_bytes(folder / "damaged.cgns", bytes);
      try {
        const CellZone mesh = read_cgns_cells(folder / "damaged.cgns");
        for (const std::int32_t corner : mesh.cells.points) {
          CHECK(static_cast<std::size_t>(corner) < mesh.points_world.size());
        }
        check_cells(mesh);
      } catch (const IoError&) {
        return true;
      }
      return false;
    };
    int refused = 0;
    for (std::size_t cut = 0; cut < 20; ++cut) {
      refused += is_refused(whole.substr(0, cut * whole.size() / 20)) ? 1 : 0;
    }
    CHECK(refused >= 18);
    refused = 0;
    for (int round = 0; round < 150; ++round) {
      std::string bytes = whole;
      for (int n = 0; n < 20; ++n) {
        bytes[random() % bytes.size()] = static_cast<char>(round % 2 == 0 ? 0xFF : random());
      }
      refused += is_refused(bytes) ? 1 : 0;
    }
    CHECK(refused > 0);
  }
}

}  // namespace vdb_offset::test
