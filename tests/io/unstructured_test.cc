// Points merged, faces in order, and what is refused, on meshes put together by hand.

#include <doctest/doctest.h>

#include <array>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <set>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "io/cell_mesh.h"
#include "io/part_middle.h"
#include "support/hand_made.h"
#include "support/temp_folder.h"
#include "vdb_offset/core/error.h"
#include "vdb_offset/io/openfoam.h"
#include "vdb_offset/io/outer_surface.h"
#include "vdb_offset/io/su2.h"

namespace vdb_offset::test {
namespace {

namespace fs = std::filesystem;

/// Two blocks of `2 x 3` columns side by side, the second turned round: they meet along their last
/// columns, against each other.
MultiBlock turned_pair() {
  Surface surface;
  add_patch(surface, "left", 2, 3, {0, 1, 2, 3, 4, 5});
  add_patch(surface, "right", 2, 3, {8, 5, 7, 3, 6, 1});
  surface.topology.edges = {{EdgeKind::Interface, {0, Side::IMax, 0, 2}, {1, Side::IMax, 2, 0}, {}},
                            free_edge(0, Side::IMin, 0, 2),
                            free_edge(0, Side::JMin, 0, 1),
                            free_edge(0, Side::JMax, 0, 1),
                            free_edge(1, Side::IMin, 0, 2),
                            free_edge(1, Side::JMin, 0, 1),
                            free_edge(1, Side::JMax, 0, 1)};
  constexpr std::array<std::array<double, 2>, 9> kPlaces{
      {{0, 0}, {1, 0}, {0, 1}, {1, 1}, {0, 2}, {1, 2}, {2, 0}, {2, 1}, {2, 2}}};
  return build_blocks(surface, make_layers(9, 2, [&](int n, int k) -> Vec3 {
                        const auto& at = kPlaces[static_cast<std::size_t>(n)];
                        return {at[0], at[1], 1.0 * k};
                      }));
}

std::string text_of(const fs::path& file) {
  std::ifstream in(file);
  return {std::istreambuf_iterator<char>(in), {}};
}

/// The numbers of a list of labels.
std::vector<int> labels(const fs::path& file) {
  const std::string text = text_of(file);
  std::istringstream in(text.substr(text.find("\n(\n") + 3));
  std::vector<int> out;
  for (int value = 0; in >> value;) out.push_back(value);
  return out;
}

}  // namespace

TEST_CASE("cell mesh: what lies beyond a turned interface is the cell that shares its points") {
  const MultiBlock mesh = turned_pair();
  const CellMesh cells(mesh);
  CHECK(cells.points() == 27);
  CHECK(cells.cells() == 8);
  int shared = 0;
  for (int j = 0; j < 2; ++j) {
    for (int k = 0; k < 2; ++k) {
      const CellMesh::Place here{0, j, k};
      const CellMesh::Place there{0, 1 - j, k};
      CHECK(cells.beyond(0, here, BlockFace::IMax) == cells.cell(1, there));
      CHECK(cells.beyond(1, there, BlockFace::IMax) == cells.cell(0, here));
      const auto set_of = [&](int block, const CellMesh::Place& place) {
        const Polygon face = polygons(cells.corners(block, place))[1];
        return std::set<std::int32_t>(face.points.begin(), face.points.end());
      };
      shared += set_of(0, here) == set_of(1, there) ? 1 : 0;
    }
  }
  CHECK(shared == 4);
}

TEST_CASE(
    "part middle: a pit in a box is seen whole from beyond its mean, and the mean stays else") {
  // A box of [0, 4] x [0, 1] x [0, 1] without its left end, which is a pyramid to (tip, 1/2, 1/2).
  const auto faces = [](double tip) {
    const Vec3 apex(tip, 0.5, 0.5);
    const auto at = [](double x, double y, double z) { return Vec3(x, y, z); };
    return std::vector<InnerFace>{{at(0, 0, 0), at(4, 0, 0), at(4, 1, 0), at(0, 1, 0)},
                                  {at(0, 0, 1), at(0, 1, 1), at(4, 1, 1), at(4, 0, 1)},
                                  {at(0, 0, 0), at(0, 0, 1), at(4, 0, 1), at(4, 0, 0)},
                                  {at(0, 1, 0), at(4, 1, 0), at(4, 1, 1), at(0, 1, 1)},
                                  {at(4, 0, 0), at(4, 0, 1), at(4, 1, 1), at(4, 1, 0)},
                                  {at(0, 0, 0), at(0, 1, 0), apex},
                                  {at(0, 1, 0), at(0, 1, 1), apex},
                                  {at(0, 1, 1), at(0, 0, 1), apex},
                                  {at(0, 0, 1), at(0, 0, 0), apex}};
  };
  const Vec3 mean(2, 0.5, 0.5);
  CHECK(least_part_about(faces(0), mean) == 1);  // of the left end's triangles, 1/2 x 2
  CHECK(part_middle(faces(0), mean) == mean);
  // Beyond the pit's tip alone are the planes of all its faces.
  CHECK(least_part_about(faces(3), mean) < 0);
  const Vec3 middle = part_middle(faces(3), mean);
  CHECK(middle.x() > 3);
  CHECK(middle.x() < 4);
  CHECK(least_part_about(faces(3), middle) > 0);
}

TEST_CASE("openfoam: internal faces are in upper-triangular order, each pair of cells once") {
  const TempFolder folder;
  write_openfoam(folder / "case", turned_pair());
  const fs::path poly = folder / "case" / "constant" / "polyMesh";
  const std::vector<int> owner = labels(poly / "owner");
  const std::vector<int> neighbour = labels(poly / "neighbour");
  // 2 x 2 x 2 cells: 12 faces within, 24 outside.
  REQUIRE(neighbour.size() == 12);
  REQUIRE(owner.size() == 36);
  for (std::size_t f = 0; f < neighbour.size(); ++f) {
    CHECK(owner[f] < neighbour[f]);
    if (f == 0) continue;
    CHECK(std::pair(owner[f - 1], neighbour[f - 1]) < std::pair(owner[f], neighbour[f]));
  }
}

TEST_CASE("openfoam: a cell that has collapsed to nothing is refused, and nothing is left") {
  MultiBlock mesh = turned_pair();
  for (int k = 0; k < 3; ++k) {  // the columns 0 and 1 onto 2 and 3
    mesh.layers.points_world[static_cast<std::size_t>(k)] = mesh.layers.at(2, k);
    mesh.layers.points_world[static_cast<std::size_t>(3 + k)] = mesh.layers.at(3, k);
  }
  const TempFolder folder;
  CHECK_THROWS_AS(write_openfoam(folder / "case", mesh), InputError);
  CHECK_THROWS_AS(write_su2(folder / "mesh.su2", mesh), InputError);
  CHECK(folder.listing().empty());
}

TEST_CASE("unstructured: stacks of no height at all are left out, of structured blocks too") {
  MultiBlock mesh = wavy_plate(6, 5, 4);
  const auto cells = [&] {
    const TempFolder folder;
    write_su2(folder / "mesh.su2", mesh);
    const std::string text = text_of(folder / "mesh.su2");
    return std::stoi(text.substr(text.find("NELEM=") + 6));
  };
  CHECK(cells() == 5 * 4 * 4);
  for (const int column : mesh.blocks[0].stack(2, 1)) {
    const std::size_t first = static_cast<std::size_t>(column) * 5;
    for (std::size_t k = 1; k < 5; ++k) {
      mesh.layers.points_world[first + k] = mesh.layers.points_world[first];
    }
  }
  // Four stacks beside it have one column of no height: each of their cells is parted in two.
  CHECK(cells() == (5 * 4 - 1 + 4) * 4);
  const TempFolder folder;
  write_openfoam(folder / "case", mesh);
  const std::vector<int> owner = labels(folder / "case/constant/polyMesh/owner");
  CHECK(*std::ranges::max_element(owner) + 1 == (5 * 4 - 1) * 4);
}

TEST_CASE("openfoam: a symmetry that is not flat is no symmetryPlane") {
  MultiBlock mesh = turned_pair();
  for (BoundaryFace& face : mesh.boundary_faces) {
    if (face.kind != BoundaryKind::Wall) continue;
    face.name = "plate";
    face.condition = {ConditionKind::Symmetry};
  }
  const TempFolder folder;
  const auto type = [&] {
    write_openfoam(folder / "case", mesh);
    const std::string text = text_of(folder / "case/constant/polyMesh/boundary");
    const std::size_t at = text.find("type", text.find("plate"));
    return text.substr(at, text.find(';', at) - at);
  };
  CHECK(type() == "type            symmetryPlane");
  mesh.layers.points_world[0].z() += 1e-6;
  CHECK(type() == "type            symmetry");
}

TEST_CASE("outer level: points are the blocks' last, bit for bit") {
  const MultiBlock mesh = wavy_plate(5, 4, 3);
  const Patches level = outer_level(mesh);
  REQUIRE(level.size() == 1);
  for (int j = 0; j < 4; ++j) {
    for (int i = 0; i < 5; ++i) CHECK(level[0].at(i, j) == mesh.point(mesh.blocks[0], i, j, 3));
  }
}

}  // namespace vdb_offset::test
