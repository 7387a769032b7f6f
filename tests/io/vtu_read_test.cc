// Unstructured grids that VTK's own writer made, in each of its forms, and what is refused.

#include <doctest/doctest.h>

#include <array>
#include <filesystem>
#include <fstream>
#include <random>
#include <string>

#include "support/hand_made.h"
#include "support/temp_folder.h"
#include "support/vtk_python.h"
#include "vdb_offset/blocks/check_cells.h"
#include "vdb_offset/core/error.h"
#include "vdb_offset/io/vtk.h"

namespace vdb_offset::test {
namespace {

namespace fs = std::filesystem;

/// A cube of each kind that has one, a pyramid and a wedge on the first, a tetrahedron beside; a
/// polyhedron on the far one; two of the faces, a line and a vertex.
const char* const kGrid = R"(
def grid_of_all():
    points = vtk.vtkPoints()
    points.SetDataTypeToDouble()
    for p in [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (1, 1, 1),
              (0, 1, 1), (.5, .5, 2), (-1, .5, 1.5), (2, 0, 0), (2, 1, 0), (2, 0, 1), (2, 1, 1),
              (.5, 0, -1), (.5, 1, -1), (3, 0, 0), (3, 1, 0), (3, 0, 1), (3, 1, 1)]:
        points.InsertNextPoint(p)
    grid = vtk.vtkUnstructuredGrid()
    grid.SetPoints(points)
    def add(kind, corners):
        grid.InsertNextCell(kind, len(corners), corners)
    add(vtk.VTK_HEXAHEDRON, (0, 1, 2, 3, 4, 5, 6, 7))
    add(vtk.VTK_QUAD, (0, 3, 7, 4))
    add(vtk.VTK_VERTEX, (3,))
    add(vtk.VTK_PYRAMID, (4, 5, 6, 7, 8))
    add(vtk.VTK_TETRA, (4, 7, 9, 8))
    add(vtk.VTK_VOXEL, (1, 10, 2, 11, 5, 12, 6, 13))
    add(vtk.VTK_LINE, (0, 1))
    add(vtk.VTK_WEDGE, (0, 14, 1, 3, 15, 2))
    add(vtk.VTK_PIXEL, (1, 10, 5, 12))
    faces = [(10, 11, 17, 16), (12, 18, 19, 13), (10, 16, 18, 12), (16, 17, 19, 18),
             (17, 11, 13, 19), (11, 10, 12, 13)]
    ids = vtk.vtkIdList()
    ids.InsertNextId(len(faces))
    for face in faces:
        ids.InsertNextId(len(face))
        for p in face:
            ids.InsertNextId(p)
    grid.InsertNextCell(vtk.VTK_POLYHEDRON, ids)
    return grid
)";

void check_all(const CellZone& mesh) {
  REQUIRE(mesh.points_world.size() == 20);
  CHECK(mesh.points_world[9] == Vec3(-1, 0.5, 1.5));
  CHECK(mesh.kinds == std::vector{CellKind::Hexahedron, CellKind::Pyramid, CellKind::Tetrahedron,
                                  CellKind::Hexahedron, CellKind::Prism, CellKind::Polyhedron});
  CHECK_FALSE(mesh.names_boundaries);
  REQUIRE(mesh.boundaries.size() == 1);
  CHECK(mesh.boundaries[0].faces.size() == 2);
  const CellCheck check = check_cells(mesh);
  CHECK(check.fault_count == 0);
  CHECK(check.quality.nonpositive_cells == 0);
  CHECK(check.inner_faces == 5);
  CHECK(check.boundary_faces == 6 + 5 + 4 + 6 + 5 + 6 - 2 * 5);
  // The cube and the box are as cubes; both halves of the wedge's volume are told by its base.
  CHECK(check.kinds[static_cast<std::size_t>(CellKind::Hexahedron)].min_volume ==
        doctest::Approx(1));
  CHECK(check.kinds[static_cast<std::size_t>(CellKind::Prism)].min_volume == doctest::Approx(0.5));
  CHECK(check.kinds[static_cast<std::size_t>(CellKind::Polyhedron)].min_volume ==
        doctest::Approx(1));
}

std::string why_not(const fs::path& file) {
  try {
    check_cells(read_vtu(file));
  } catch (const IoError& error) {
    return error.what();
  }
  return "it was read";
}

void put(const fs::path& file, const std::string& bytes) {
  std::ofstream(file, std::ios::binary) << bytes;
}

}  // namespace

TEST_CASE("vtu: what VTK writes is read in each of its forms, the same every time") {
  if (!has_vtk()) {
    MESSAGE("skipped: VTK's Python is not installed");
    return;
  }
  const TempFolder folder;
  run_vtk(folder, std::string(kGrid) + R"(
for mode in ('Ascii', 'Binary', 'Appended'):
    for packed in (0, 1):
        for wide in (0, 1):
            for encoded in (0, 1):
                writer = vtk.vtkXMLUnstructuredGridWriter()
                writer.SetInputData(grid_of_all())
                getattr(writer, f'SetDataModeTo{mode}')()
                writer.SetEncodeAppendedData(encoded)
                if packed:
                    writer.SetCompressorTypeToZLib()
                    writer.SetBlockSize(32)
                else:
                    writer.SetCompressorTypeToNone()
                if wide:
                    writer.SetHeaderTypeToUInt64()
                    writer.SetIdTypeToInt64()
                else:
                    writer.SetHeaderTypeToUInt32()
                    writer.SetIdTypeToInt32()
                writer.SetFileName(f'{mode}_{packed}_{wide}_{encoded}.vtu')
                writer.Write()
)");
  int files = 0;
  for (const std::string& name : folder.listing()) {
    if (!name.ends_with(".vtu")) continue;
    CAPTURE(name);
    check_all(read_vtu(folder / name));
    ++files;
  }
  CHECK(files == 24);
}

TEST_CASE("vtu: what is written comes back, points to the bit") {
  const TempFolder folder;
  const MultiBlock mesh = wavy_plate(5, 4, 3);
  write_vtu(folder / "m.vtu", mesh, judge(mesh));
  const CellZone back = read_vtu(folder / "m.vtu");
  CHECK(back.points_world == mesh.layers.points_world);
  CHECK(back.kinds == std::vector(4 * 3 * 3, CellKind::Hexahedron));
  const CellCheck check = check_cells(back);
  CHECK(check.is_sound());
  CHECK(check.quality.min_scaled_jacobian ==
        doctest::Approx(judge(mesh).report.min_scaled_jacobian).epsilon(1e-12));
}

TEST_CASE("vtu: what is wrong is refused with file, value and rule") {
  const TempFolder folder;
  const fs::path file = folder / "m.vtu";
  const std::string good =
      "<?xml version=\"1.0\"?>\n<VTKFile type=\"UnstructuredGrid\" version=\"0.1\" "
      "byte_order=\"LittleEndian\">\n<UnstructuredGrid>\n"
      "<Piece NumberOfPoints=\"4\" NumberOfCells=\"1\">\n<Points>\n"
      "<DataArray type=\"Float32\" NumberOfComponents=\"3\" format=\"ascii\">\n"
      "0 0 0 1 0 0 0 1 0 0 0 1\n</DataArray></Points>\n<Cells>\n"
      "<DataArray type=\"Int32\" Name=\"connectivity\" format=\"ascii\"> 0 1 2 3 </DataArray>\n"
      "<DataArray type=\"Int32\" Name=\"offsets\" format=\"ascii\"> 4 </DataArray>\n"
      "<DataArray type=\"UInt8\" Name=\"types\" format=\"ascii\"> 10 </DataArray>\n"
      "</Cells></Piece></UnstructuredGrid></VTKFile>\n";
  put(file, good);
  CHECK(why_not(file) == "it was read");
  struct Lie {
    const char *from, *to, *said;
  };
  put(file, std::string(good).replace(good.find("Little"), 6, "Big"));  // text has no order
  CHECK(why_not(file) == "it was read");
  const std::array<Lie, 15> lies{
      {{"type=\"UnstructuredGrid\"", "type=\"PolyData\"", "of the type UnstructuredGrid"},
       {"byte_order=", "compressor=\"vtkLZ4DataCompressor\" byte_order=", "vtkLZ4DataCompressor"},
       {"</VTKFile>", "", "</VTKFile>"},
       {"</Cells>", "", "is no XML at byte"},
       {"NumberOfPoints=\"4\"", "NumberOfPoints=\"-4\"", "NumberOfPoints is \"-4\""},
       {"NumberOfPoints=\"4\"", "NumberOfPoints=\"4000000\"", "too short for 12000000 numbers"},
       {"NumberOfPoints=\"4\"", "NumberOfPoints=\"5\"", "has 12 numbers, not 15"},
       {"0 1 2 3 ", "0 1 2 4 ", "cell 0 has point 4, but there are 4, from 0"},
       {"0 1 2 3 ", "0 1 2 x ", "\"x\" is no whole number"},
       {"0 1 2 3 ", "0 1 2 3 3 ", "more than 4 numbers"},
       {" 4 </", " -4 </", "offset of cell 0 is -4"},
       {" 10 </", " 24 </", "cell 0 has the type 24"},
       {" 10 </", " 14 </", "of the type 14, has 4 points"},
       {"\n0 0 0", "\n0 nan 0", "number 1 is nan, but must be finite"},
       {"format=\"ascii\"> 0", "format=\"appended\" offset=\"9\"> 0", "offset \"9\""}}};
  for (const Lie& lie : lies) {
    std::string bytes = good;
    const std::size_t at = bytes.find(lie.from);
    REQUIRE(at != std::string::npos);
    put(file, bytes.replace(at, std::string(lie.from).size(), lie.to));
    const std::string said = why_not(file);
    CAPTURE(lie.to);
    CAPTURE(said);
    CHECK(said.find("m.vtu") != std::string::npos);
    CHECK(said.find(lie.said) != std::string::npos);
  }
}

TEST_CASE("vtu: polyhedra that are not closed, or have a face turned over, are faults") {
  const TempFolder folder;
  const auto read = [&](const std::string& faces, int end) {
    put(folder / "m.vtu",
        "<VTKFile type=\"UnstructuredGrid\" byte_order=\"LittleEndian\"><UnstructuredGrid>"
        "<Piece NumberOfPoints=\"4\" NumberOfCells=\"1\"><Points>"
        "<DataArray type=\"Float64\" format=\"ascii\">0 0 0 1 0 0 0 1 0 0 0 1</DataArray></Points>"
        "<Cells><DataArray type=\"Int32\" Name=\"connectivity\" format=\"ascii\">0 1 2 3"
        "</DataArray><DataArray type=\"Int32\" Name=\"offsets\" format=\"ascii\">4</DataArray>"
        "<DataArray type=\"UInt8\" Name=\"types\" format=\"ascii\">42</DataArray>"
        "<DataArray type=\"Int32\" Name=\"faces\" format=\"ascii\">" +
            faces + "</DataArray><DataArray type=\"Int32\" Name=\"faceoffsets\" format=\"ascii\">" +
            std::to_string(end) + "</DataArray></Cells></Piece></UnstructuredGrid></VTKFile>");
    return check_cells(read_vtu(folder / "m.vtu"));
  };
  CHECK(read("4 3 0 2 1 3 0 1 3 3 1 2 3 3 0 3 2", 17).is_sound());
  const CellCheck turned = read("4 3 0 2 1 3 0 1 3 3 1 2 3 3 0 2 3", 17);
  CHECK(turned.fault_count == 1);
  CHECK(turned.faults.front().text.starts_with("1 polyhedra whose faces do not close"));
  CHECK_FALSE(read("4 3 0 2 1 3 0 1 3 3 1 2 3 3 1 2 3", 17).is_sound());
}

TEST_CASE("vtu: two prisms on a hexahedron's face are a gap, though no boundary is named") {
  CellZone mesh;
  mesh.names_boundaries = false;
  for (const double z : {0.0, 1.0, 2.0}) {
    for (const auto& [x, y] : {std::pair{0, 0}, {1, 0}, {1, 1}, {0, 1}})
      mesh.points_world.emplace_back(x, y, z);
  }
  mesh.add(CellKind::Hexahedron, std::array{0, 1, 2, 3, 4, 5, 6, 7});
  mesh.add(CellKind::Prism, std::array{4, 5, 6, 8, 9, 10});
  mesh.add(CellKind::Prism, std::array{4, 6, 7, 8, 10, 11});
  const CellCheck check = check_cells(mesh);
  REQUIRE(check.faults.size() == 1);
  CHECK(check.faults[0].kind == FaultKind::Gap);
  CHECK(check.faults[0].count == 2);
}

TEST_CASE("vtu: damaged files are read or refused, never worse") {
  const TempFolder folder;
  const MultiBlock mesh = wavy_plate(3, 3, 2);
  write_vtu(folder / "raw.vtu", mesh, judge(mesh));
  if (has_vtk()) {
    run_vtk(folder, std::string(kGrid) + R"(
for name, mode in (('text.vtu', 'Ascii'), ('packed.vtu', 'Binary'), ('appended.vtu', 'Appended')):
    writer = vtk.vtkXMLUnstructuredGridWriter()
    writer.SetInputData(grid_of_all())
    getattr(writer, f'SetDataModeTo{mode}')()
    writer.SetFileName(name)
    writer.Write()
)");
  }
  std::mt19937 random(17);
  for (const std::string& name : folder.listing()) {
    if (!name.ends_with(".vtu")) continue;
    CAPTURE(name);
    const std::string good = file_bytes(folder / name);
    int refused = 0;
    for (int n = 0; n < 400; ++n) {
      std::string bytes = good;
      bytes[random() % bytes.size()] = static_cast<char>(random());
      if (n % 10 == 0) bytes.resize(random() % bytes.size());
      put(folder / "m.vtu", bytes);
      refused += why_not(folder / "m.vtu") != "it was read" ? 1 : 0;
    }
    CHECK(refused > 60);
  }
}

}  // namespace vdb_offset::test
