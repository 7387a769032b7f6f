#include <doctest/doctest.h>

#include <cstdlib>
#include <limits>
#include <numbers>
#include <string>

#include "io/plot3d_grid.h"
#include "vdb_offset/core/error.h"
#include "vdb_offset/io/plot3d.h"

using namespace vdb_offset;
using namespace plot3d_test;

namespace {

/// Two patches with numbers that are hard to write down.
Patches hard_patches() {
  const Grid grid = make_grid({{5, 4, 1}, {2, 3, 1}}, false, 5);
  Patches patches(2);
  for (std::size_t b = 0; b < 2; ++b) {
    patches[b].ni = static_cast<int>(grid.sizes[b].ni);
    patches[b].nj = static_cast<int>(grid.sizes[b].nj);
    patches[b].points_world = grid.points[b];
    for (Vec3& point : patches[b].points_world) point /= std::numbers::pi;
  }
  patches[0].at(0, 0) = {-0.0, std::numeric_limits<double>::denorm_min(), 0.1};
  patches[0].at(1, 0) = {std::numeric_limits<double>::max(), -1.0 / 3.0, 1e-300};
  return patches;
}

/// A mesh of two blocks that share the column between them, every point different.
MultiBlock small_mesh() {
  MultiBlock mesh;
  mesh.layers.spacing.layers = 2;
  for (int column = 0; column < 9; ++column) {
    mesh.layers.stop.push_back(Stop::Reached);
    for (int k = 0; k <= 2; ++k) {
      mesh.layers.points_world.emplace_back(column + 0.1, k / 3.0, column * k + 0.7);
    }
  }
  Block block;
  block.ni = 3;
  block.nj = 2;
  block.nk = 3;
  block.columns = {0, 1, 2, 3, 4, 5};
  mesh.blocks.push_back(block);
  block.columns = {3, 4, 5, 6, 7, 8};
  mesh.blocks.push_back(block);
  return mesh;
}

bool same_bits(const Vec3& a, const Vec3& b) {
  return std::memcmp(a.data(), b.data(), 3 * sizeof(double)) == 0;
}

/// All doubles of a file written by another program.
std::vector<double> doubles_in(const std::filesystem::path& file) {
  const std::string bytes = file_bytes(file);
  std::vector<double> values(bytes.size() / sizeof(double));
  std::memcpy(values.data(), bytes.data(), values.size() * sizeof(double));
  return values;
}

bool vtk_is_installed() {
  return std::system("/usr/bin/python3 -c 'import vtk' >/dev/null 2>&1") == 0;
}

}  // namespace

TEST_CASE("plot3d: what is written is read back bit by bit, as text and as bytes") {
  const TempFolder scratch;
  const Patches patches = hard_patches();
  for (const bool formatted : {false, true}) {
    write_plot3d(scratch / "out.xyz", patches, {formatted});
    const Plot3dInfo info = inspect_plot3d(scratch / "out.xyz");
    CHECK(info.dialect.describe() ==
          (formatted ? "formatted, multi-block, 3-D"
                     : "Fortran records, double, little-endian, multi-block, 3-D"));
    const Patches again = read_plot3d(scratch / "out.xyz");
    REQUIRE(again.size() == patches.size());
    for (std::size_t b = 0; b < again.size(); ++b) {
      REQUIRE(again[b].ni == patches[b].ni);
      REQUIRE(again[b].nj == patches[b].nj);
      for (std::size_t p = 0; p < again[b].points_world.size(); ++p) {
        CHECK(same_bits(again[b].points_world[p], patches[b].points_world[p]));
      }
    }
  }
}

TEST_CASE("plot3d: a mesh is written i fastest, then j, then k, in the layout of other writers") {
  const TempFolder scratch;
  const MultiBlock mesh = small_mesh();
  Grid grid;
  for (const Block& block : mesh.blocks) {
    grid.sizes.push_back({block.ni, block.nj, block.nk});
    Vec3List& points = grid.points.emplace_back();
    for (int k = 0; k < block.nk; ++k) {
      for (int j = 0; j < block.nj; ++j) {
        for (int i = 0; i < block.ni; ++i) points.push_back(mesh.point(block, i, j, k));
      }
    }
  }
  Plot3dDialect dialect;
  dialect.formatted = false;
  dialect.big_endian = std::endian::native == std::endian::big;
  write_plot3d(scratch / "mesh.xyz", mesh);
  CHECK(file_bytes(scratch / "mesh.xyz") == encode(dialect, grid));
  write_plot3d(scratch / "mesh.fmt", mesh, {true});
  const Plot3dInfo info = inspect_plot3d(scratch / "mesh.fmt");
  REQUIRE(info.blocks.size() == 2);
  CHECK(info.blocks[1].nk == 3);
}

TEST_CASE("plot3d: curves in z = 0 are written as 2-D, others as 3-D, and both come back") {
  const TempFolder scratch;
  Patches curves = hard_patches();
  for (Patch& patch : curves) {
    patch.ni *= patch.nj;
    patch.nj = 1;
  }
  for (const bool plane : {false, true}) {
    for (Patch& patch : curves) {
      for (Vec3& point : patch.points_world) point.z() = plane ? 0.0 : point.z();
    }
    for (const bool formatted : {false, true}) {
      write_plot3d(scratch / "out.xyz", curves, {formatted});
      const Plot3dInfo info = inspect_plot3d(scratch / "out.xyz");
      CAPTURE(info.dialect.describe());
      CHECK(info.dialect.two_dimensional == plane);
      CHECK(info.dialect.formatted == formatted);
      const Patches again = read_plot3d(scratch / "out.xyz");
      REQUIRE(again.size() == 2);
      for (std::size_t b = 0; b < 2; ++b) {
        CHECK(again[b].nj == 1);
        REQUIRE(again[b].ni == curves[b].ni);
        for (std::size_t p = 0; p < again[b].points_world.size(); ++p) {
          CHECK(same_bits(again[b].points_world[p], curves[b].points_world[p]));
        }
      }
    }
  }
  curves.push_back(hard_patches()[0]);
  CHECK_THROWS_AS(write_plot3d(scratch / "both.xyz", curves), InputError);
}

TEST_CASE("plot3d: a record too long for its marks, and nothing at all, are not written") {
  const TempFolder scratch;
  MultiBlock mesh;
  Block& block = mesh.blocks.emplace_back();
  block.ni = block.nj = 10000;
  block.nk = 1;  // 2.4e9 bytes of coordinates
  const std::string said = io_error([&] { write_plot3d(scratch / "long.xyz", mesh); });
  CAPTURE(said);
  CHECK(contains(said, "block 1 of 10000 x 10000 x 1 points needs a Fortran record of 2400000000"));
  CHECK_THROWS_AS(write_plot3d(scratch / "none.xyz", Patches{}), InputError);
  Patches short_patch(1);
  short_patch[0].ni = short_patch[0].nj = 2;
  CHECK_THROWS_AS(write_plot3d(scratch / "short.xyz", short_patch), InputError);
  CHECK_THROWS_AS(write_plot3d(scratch / "no/folder.xyz", hard_patches()), IoError);
  CHECK(std::filesystem::is_empty(scratch / ""));
}

TEST_CASE("plot3d: VTK reads the same points from the binary file") {
  if (!vtk_is_installed()) {
    MESSAGE("skipped: /usr/bin/python3 has no vtk");
    return;
  }
  const TempFolder scratch;
  const MultiBlock mesh = small_mesh();
  write_plot3d(scratch / "mesh.xyz", mesh);
  std::ofstream(scratch / "dump.py") << R"(
import sys, vtk
reader = vtk.vtkMultiBlockPLOT3DReader()
reader.SetXYZFileName(sys.argv[1])
reader.SetAutoDetectFormat(0)
reader.SetBinaryFile(1)
reader.SetHasByteCount(1)
reader.SetMultiGrid(1)
reader.SetDoublePrecision(1)
if sys.byteorder == 'little':
    reader.SetByteOrderToLittleEndian()
else:
    reader.SetByteOrderToBigEndian()
reader.Update()
grid = reader.GetOutput()
from array import array
values = array('d')
for b in range(grid.GetNumberOfBlocks()):
    block = grid.GetBlock(b)
    values.extend(float(n) for n in block.GetDimensions())
    for p in range(block.GetNumberOfPoints()):
        values.extend(block.GetPoint(p))
values.tofile(open(sys.argv[2], 'wb'))
)";
  const std::string command = "/usr/bin/python3 " + (scratch / "dump.py").string() + " " +
                              (scratch / "mesh.xyz").string() + " " + (scratch / "points").string();
  REQUIRE(std::system(command.c_str()) == 0);
  std::vector<double> expected;
  for (const Block& block : mesh.blocks) {
    for (const int n : {block.ni, block.nj, block.nk}) expected.push_back(n);
    for (int k = 0; k < block.nk; ++k) {
      for (const int column : block.columns) {
        for (int c = 0; c < 3; ++c) expected.push_back(mesh.layers.at(column, k)[c]);
      }
    }
  }
  CHECK((doubles_in(scratch / "points") == expected));
}
