#include "vdb_offset/io/vtk.h"

#include <doctest/doctest.h>

#include <sstream>

#include "io/xml_text.h"
#include "support/hand_made.h"
#include "support/vtk_python.h"

namespace vdb_offset::test {
namespace {

using Names = std::vector<std::string>;

/// Two blocks that share a side, of different sizes and with columns of every kind.
MultiBlock two_blocks() {
  MultiBlock mesh = wavy_plate(5, 4, 3);
  Layers& layers = mesh.layers;
  layers.distance_world = 2;
  SpacingOptions spacing;
  spacing.layers = 3;
  spacing.first_cell_world = 0.4;
  layers.spacing = solve_spacing(2, spacing);
  for (std::size_t n = 0; n < layers.stop.size(); ++n) {
    layers.stop[n] = static_cast<Stop>(n % 3);
    layers.height_world[n] = 0.1 * static_cast<double>(n + 2);
    layers.asked_world[n] = 2;
    layers.first_asked_world[n] = layers.spacing.first_cell_world;
  }
  Block& left = mesh.blocks[0];
  Block right = left;
  left.name = "left <&\"'> \xC3\xA4 \x01 \xFF";
  right.name = "right";
  left.ni = 3;
  right.ni = 3;
  left.columns.clear();
  right.columns.clear();
  for (int n = 0; n < 20; ++n) {
    if (n % 5 <= 2) left.columns.push_back(n);
    if (n % 5 >= 2) right.columns.push_back(n);
  }
  mesh.blocks.push_back(right);
  // One side of the right block in two parts, the last of them from its end.
  mesh.boundary_faces = {
      {BoundaryKind::Wall, "wing & tail", {0, BlockFace::KMin, {0, 0, 0}, {2, 3, 0}}},
      {BoundaryKind::Outer, "outer", {0, BlockFace::KMax, {0, 0, 3}, {2, 3, 3}}},
      {BoundaryKind::Wall, "wing & tail", {1, BlockFace::KMin, {0, 0, 0}, {2, 3, 0}}},
      {BoundaryKind::Boundary, "symmetry", {1, BlockFace::IMax, {2, 0, 0}, {2, 1, 3}}},
      {BoundaryKind::Free, "free", {1, BlockFace::IMax, {2, 3, 0}, {2, 1, 3}}}};
  mesh.interfaces = {{{0, BlockFace::IMax, {2, 0, 0}, {2, 3, 3}},
                      {1, BlockFace::IMin, {0, 0, 0}, {0, 3, 3}},
                      {1, 2, 3},
                      "membrane"}};
  return mesh;
}

/// Three cells from a first one f with ratio r to h: 1 + r + r^2 = h / f; equal ones where 3 f > h.
double level_height(const Layers& layers, std::size_t node, int level) {
  const double f = 0.4;
  const double h =
      layers.stop[node] == Stop::Reached ? 2 : std::min(2.0, layers.height_world[node]);
  if (3 * f >= h) return h * level / 3;
  const double r = 0.5 * (std::sqrt(4 * h / f - 3) - 1);
  return f * (std::pow(r, level) - 1) / (r - 1);
}

void write(const std::filesystem::path& file, const MultiBlock& mesh) {
  write_vtm(file, mesh, judge(mesh));
}

TEST_CASE("vtm: VTK reads back every point and every field of every block") {
  if (!has_vtk()) {
    MESSAGE("skipped: VTK's Python is not installed");
    return;
  }
  const TempFolder folder;
  const MultiBlock mesh = two_blocks();
  const QualityField quality = judge(mesh);
  write_vtm(folder / "two blocks & more.vtm", mesh, quality);
  std::istringstream read(run_vtk(folder, R"(
reader = vtk.vtkXMLMultiBlockDataReader()
reader.SetFileName('two blocks & more.vtm')
reader.Update()
blocks = reader.GetOutput()
print(blocks.GetNumberOfBlocks() - 1)
for b in range(blocks.GetNumberOfBlocks() - 1):
    name = blocks.GetMetaData(b).Get(vtk.vtkCompositeDataSet.NAME())
    print(name.encode('utf-8', 'surrogateescape').hex())
    grid = blocks.GetBlock(b)
    print(*grid.GetDimensions(), grid.GetNumberOfPoints(), grid.GetNumberOfCells())
    print(grid.GetPointData().GetNumberOfArrays(), grid.GetCellData().GetNumberOfArrays())
    names = ('height', 'coverage', 'stop', 'level', 'node')
    point = [grid.GetPointData().GetArray(n) for n in names]
    for p in range(grid.GetNumberOfPoints()):
        print(*grid.GetPoint(p), *[a.GetValue(p) for a in point])
    names = ('block', 'layer', 'scaled_jacobian', 'volume', 'min_jacobian', 'skewness',
             'aspect_ratio', 'orthogonality', 'growth')
    cell = [grid.GetCellData().GetArray(n) for n in names]
    for c in range(grid.GetNumberOfCells()):
        print(*[a.GetValue(c) for a in cell])
)"));
  std::size_t count = 0;
  read >> count;
  REQUIRE(count == 2);
  for (std::size_t b = 0; b < count; ++b) {
    const Block& block = mesh.blocks[b];
    std::string name;
    std::array<int, 3> size{};
    std::size_t points = 0;
    std::size_t cells = 0;
    int point_arrays = 0;
    int cell_arrays = 0;
    read >> name >> size[0] >> size[1] >> size[2] >> points >> cells >> point_arrays >> cell_arrays;
    // "left <&"'> ä ? ?" in UTF-8: what XML cannot hold has become a question mark
    CHECK(name == (b == 0 ? "6c656674203c2622273e20c3a4203f203f" : "7269676874"));
    CHECK(size == std::array<int, 3>{block.ni, block.nj, block.nk});
    REQUIRE(points == block.point_count());
    REQUIRE(cells == block.cell_count());
    CHECK(point_arrays == 6);
    CHECK(cell_arrays == 9);
    for (std::size_t p = 0; p < points; ++p) {
      const int node = block.columns[p % block.columns.size()];
      const int level = static_cast<int>(p / block.columns.size());
      const auto n = static_cast<std::size_t>(node);
      Vec3 place;
      double height = 0;
      double covered = 0;
      std::array<int, 3> tags{};
      read >> place.x() >> place.y() >> place.z() >> height >> covered >> tags[0] >> tags[1] >>
          tags[2];
      CHECK(place == mesh.layers.at(node, level));
      CHECK(height == doctest::Approx(level_height(mesh.layers, n, level)).epsilon(1e-12));
      const double reached = std::min(1.0, mesh.layers.height_world[n] / 2);
      CHECK(static_cast<float>(covered) == static_cast<float>(reached));
      CHECK(tags == std::array<int, 3>{static_cast<int>(n % 3), level, node});
    }
    const CellFields fields = cell_fields(mesh, block);
    const int layer_cells = (block.ni - 1) * (block.nj - 1);
    for (std::size_t c = 0; c < cells; ++c) {
      int index = -1;
      int layer = -1;
      double scaled_jacobian = 0;
      read >> index >> layer >> scaled_jacobian;
      CHECK(index == static_cast<int>(b));
      CHECK(layer == static_cast<int>(c) / layer_cells);
      CHECK(static_cast<float>(scaled_jacobian) == quality.scaled_jacobian[b][c]);
      for (const auto* field : {&fields.volume, &fields.min_jacobian, &fields.skewness,
                                &fields.aspect_ratio, &fields.orthogonality, &fields.growth}) {
        double value = -2;
        read >> value;
        CHECK(static_cast<float>(value) == (*field)[c]);
      }
    }
  }
  CHECK(static_cast<bool>(read));
}

TEST_CASE("vtm: VTK finds each boundary by its name, with the points and cells of its faces") {
  if (!has_vtk()) {
    MESSAGE("skipped: VTK's Python is not installed");
    return;
  }
  const TempFolder folder;
  const MultiBlock mesh = two_blocks();
  const QualityField quality = judge(mesh);
  write_vtm(folder / "out.vtm", mesh, quality);
  const std::string listed = run_vtk(folder, R"(
reader = vtk.vtkXMLMultiBlockDataReader()
reader.SetFileName('out.vtm')
reader.Update()
def name(group, n):
    return group.GetMetaData(n).Get(vtk.vtkCompositeDataSet.NAME())
blocks = reader.GetOutput()
faces = open('faces.txt', 'w')
top = blocks.GetBlock(2)
print(name(blocks, 2))
for b in range(top.GetNumberOfBlocks()):
    group = top.GetBlock(b)
    print(name(top, b))
    for f in range(group.GetNumberOfBlocks()):
        grid = group.GetBlock(f)
        owner = 'right' if name(group, f) == 'right' else 'left'
        print(' ', owner, *grid.GetDimensions(), grid.GetNumberOfCells())
        node, level = [grid.GetPointData().GetArray(n) for n in ('node', 'level')]
        height = grid.GetPointData().GetArray('height')
        print(grid.GetNumberOfPoints(), grid.GetNumberOfCells(), file=faces)
        for p in range(grid.GetNumberOfPoints()):
            print(node.GetValue(p), level.GetValue(p), *grid.GetPoint(p), height.GetValue(p),
                  file=faces)
        names = ('block', 'layer', 'scaled_jacobian')
        cell = [grid.GetCellData().GetArray(n) for n in names]
        for c in range(grid.GetNumberOfCells()):
            print(*[a.GetValue(c) for a in cell], file=faces)
)");
  CHECK(listed ==
        "boundaries\nwing & tail\n  left 3 4 1 6\n  right 3 4 1 6\nouter\n  left 3 4 1 6\n"
        "symmetry\n  right 1 2 4 3\nfree\n  right 1 3 4 6\nmembrane\n  left 1 4 4 9\n");
  std::ifstream faces(folder / "faces.txt");
  std::size_t points = 0;
  std::size_t cells = 0;
  int face = 0;
  for (; faces >> points >> cells; ++face) {
    CAPTURE(face);
    for (std::size_t p = 0; p < points; ++p) {
      int node = 0;
      int level = 0;
      double height = 0;
      Vec3 place;
      faces >> node >> level >> place.x() >> place.y() >> place.z() >> height;
      CHECK(place == mesh.layers.at(node, level));
      const double meant = level_height(mesh.layers, static_cast<std::size_t>(node), level);
      CHECK(height == doctest::Approx(meant).epsilon(1e-12));
      if (face < 2) CHECK(level == 0);
      if (face == 2) CHECK(level == 3);
      if (face == 3 || face == 4) CHECK(node % 5 == 4);
      if (face == 5) CHECK(node % 5 == 2);
    }
    for (std::size_t c = 0; c < cells; ++c) {
      std::size_t block = 9;
      std::size_t layer = 9;
      float scaled_jacobian = 0;
      faces >> block >> layer >> scaled_jacobian;
      REQUIRE(block < 2);
      CHECK(block == (face == 1 || face == 3 || face == 4 ? 1 : 0));
      if (face < 3) CHECK(layer == (face == 2 ? 2 : 0));
      // The cell that the face is of: 2 x 3 cells a layer.
      std::size_t cell = c;
      if (face == 2) cell = 12 + c;
      if (face == 3) cell = 6 * c + 1;
      if (face == 4) cell = 6 * (c / 2) + 2 * (c % 2 + 1) + 1;
      if (face == 5) cell = 2 * c + 1;
      CHECK(scaled_jacobian == quality.scaled_jacobian[block][cell]);
    }
  }
  CHECK(face == 6);
}

TEST_CASE("vtm: pieces lie in the folder of the file's name, and nothing else is left") {
  const TempFolder folder;
  write(folder / "out.vtm", two_blocks());
  CHECK(folder.listing() == Names{"out", "out.vtm", "out/block_0.vts", "out/block_0_face_0.vts",
                                  "out/block_0_face_1.vts", "out/block_0_face_2.vts",
                                  "out/block_1.vts", "out/block_1_face_0.vts",
                                  "out/block_1_face_1.vts", "out/block_1_face_2.vts"});
  const std::string index = file_bytes(folder / "out.vtm");
  CHECK(index.find("file=\"out/block_1.vts\"") != std::string::npos);

  SUBCASE("a second run of fewer blocks replaces them all") {
    MultiBlock one = wavy_plate(3, 3, 2);
    one.boundary_faces.clear();
    write(folder / "out.vtm", one);
    CHECK(folder.listing() == Names{"out", "out.vtm", "out/block_0.vts"});
    CHECK(file_bytes(folder / "out.vtm").find("boundaries") == std::string::npos);
  }
  SUBCASE("the same mesh gives the same bytes") {
    write(folder / "again.vtm", two_blocks());
    CHECK(file_bytes(folder / "again/block_1.vts") == file_bytes(folder / "out/block_1.vts"));
  }
}

TEST_CASE("vtm: a file without extension does not collide with its folder") {
  const TempFolder folder;
  MultiBlock mesh = wavy_plate(3, 3, 2);
  mesh.boundary_faces.clear();
  write(folder / "out", mesh);
  CHECK(folder.listing() == Names{"out", "out.blocks", "out.blocks/block_0.vts"});
}

TEST_CASE("vtm: somebody else's folder is refused and left alone") {
  const TempFolder folder;
  std::filesystem::create_directory(folder / "out");
  const auto refused = [&] { CHECK_THROWS_AS(write(folder / "out.vtm", two_blocks()), IoError); };
  SUBCASE("with a file that is not a piece") {
    std::ofstream(folder / "out/thesis.txt") << "three years";
    std::ofstream(folder / "out/block_0.vts") << "old";
    refused();
    CHECK(folder.listing() == Names{"out", "out/block_0.vts", "out/thesis.txt"});
    CHECK(file_bytes(folder / "out/block_0.vts") == "old");
  }
  SUBCASE("with a folder named like a piece") {
    std::filesystem::create_directory(folder / "out/block_0.vts");
    refused();
    CHECK(folder.listing() == Names{"out", "out/block_0.vts"});
  }
  SUBCASE("that is a file") {
    std::filesystem::remove(folder / "out");
    std::ofstream(folder / "out") << "a file";
    refused();
    CHECK(folder.listing() == Names{"out"});
  }
  SUBCASE("that is a link") {
    std::filesystem::create_directory(folder / "elsewhere");
    std::filesystem::remove(folder / "out");
    std::filesystem::create_directory_symlink(folder / "elsewhere", folder / "out");
    refused();
    CHECK(folder.listing() == Names{"elsewhere", "out"});
  }
}

TEST_CASE("vtm: a write that fails leaves everything as it was") {
  const TempFolder folder;
  SUBCASE("the folder does not exist") {
    CHECK_THROWS_AS(write(folder / "missing/out.vtm", two_blocks()), IoError);
    CHECK(folder.listing().empty());
  }
  SUBCASE("the target is a folder") {
    std::filesystem::create_directory(folder / "out.vtm");
    CHECK_THROWS_AS(write(folder / "out.vtm", two_blocks()), IoError);
    CHECK(folder.listing() == Names{"out.vtm"});
  }
  SUBCASE("the quality is of another mesh") {
    CHECK_THROWS_AS(write_vtm(folder / "out.vtm", two_blocks(), judge(wavy_plate(3, 3, 2))),
                    InputError);
    CHECK(folder.listing().empty());
  }
}

}  // namespace
}  // namespace vdb_offset::test
