// The VTK XML format for unstructured grids as "VTK File Formats" (Kitware) describes it.

#include <fmt/format.h>

#include <array>
#include <cstdint>
#include <ostream>
#include <utility>
#include <vector>

#include "io/cell_mesh.h"
#include "io/linear_cell.h"
#include "io/output_file.h"
#include "io/vtk_arrays.h"
#include "vdb_offset/core/error.h"
#include "vdb_offset/io/vtk.h"

namespace vdb_offset {
namespace {

constexpr VtkArray kConnectivity{"connectivity", "Int32", 4};
constexpr VtkArray kOffsets{"offsets", "Int64", 8};
constexpr VtkArray kTypes{"types", "UInt8", 1};

std::uint8_t vtk_type(LinearCell::Kind kind) {
  constexpr std::array<std::uint8_t, 4> kOfKind{10, 14, 13, 12};
  return kOfKind[static_cast<std::size_t>(kind)];
}

/// VTK's wedges have bases that run counter-clockwise seen from outside, unlike its other cells.
void turn_round(LinearCell& prism) {
  std::swap(prism.corners[1], prism.corners[2]);
  std::swap(prism.corners[4], prism.corners[5]);
}

/// Writes the grid: declares arrays first, then sends their data in the same order.
class Grid {
 public:
  Grid(std::ostream& out, const MultiBlock& mesh) : out_(out), mesh_(mesh), cells_(mesh) {
    for_cells([&](const LinearCell& cell) { corners_ += cell.count; });
  }

  void write(const QualityField& quality) {
    write_header();
    write_points();
    write_cells();
    write_point_data();
    write_cell_data(quality);
    out_ << "\n</AppendedData>\n</VTKFile>\n";
  }

 private:
  static constexpr std::size_t kBuffered = 1U << 20U;  // bytes

  template <typename Visit>
  void for_cells(const Visit& visit) const {
    cells_.for_cells([&](int block, const CellMesh::Place& place) {
      visit(linear_cell(cells_.corners(block, place)));
    });
  }

  void declare(const VtkArray& array, std::uint64_t count) {
    out_ << vtk_declaration(array, count, offset_);
  }

  void write_header() {
    const auto points = static_cast<std::uint64_t>(cells_.points());
    const auto cells = static_cast<std::uint64_t>(cells_.cells());
    out_ << "<?xml version=\"1.0\"?>\n<VTKFile type=\"UnstructuredGrid\" version=\"1.0\" "
            "byte_order=\""
         << kVtkByteOrder << "\" header_type=\"UInt64\">\n<UnstructuredGrid>\n"
         << fmt::format("<Piece NumberOfPoints=\"{}\" NumberOfCells=\"{}\">\n", points, cells);
    out_ << "<Points>\n";
    declare(kVtkPoints, points);
    out_ << "</Points>\n<Cells>\n";
    declare(kConnectivity, corners_);
    declare(kOffsets, cells);
    declare(kTypes, cells);
    out_ << "</Cells>\n<PointData Scalars=\"height\">\n";
    for (const VtkArray& array : kVtkPointData) declare(array, points);
    out_ << "</PointData>\n<CellData Scalars=\"scaled_jacobian\">\n";
    for (const VtkArray& array : kVtkCellData) declare(array, cells);
    out_ << "</CellData>\n</Piece>\n</UnstructuredGrid>\n<AppendedData encoding=\"raw\">\n_";
  }

  void begin(const VtkArray& array, std::uint64_t count) {
    put_bytes(bytes_, count * array.item_bytes);
  }
  template <typename T>
  void put(const T& value) {
    put_bytes(bytes_, value);
    if (bytes_.size() >= kBuffered) flush();
  }
  void flush() {
    out_.write(bytes_.data(), static_cast<std::streamsize>(bytes_.size()));
    bytes_.clear();
  }

  void write_points() {
    begin(kVtkPoints, static_cast<std::uint64_t>(cells_.points()));
    cells_.for_points([&](const Vec3& p) { put(std::array<double, 3>{p.x(), p.y(), p.z()}); });
    flush();
  }

  void write_cells() {
    begin(kConnectivity, corners_);
    for_cells([&](LinearCell cell) {
      if (cell.kind == LinearCell::Kind::Prism) turn_round(cell);
      for (const std::int32_t point : cell.points()) put(point);
    });
    const auto count = static_cast<std::uint64_t>(cells_.cells());
    begin(kOffsets, count);
    std::int64_t end = 0;
    for_cells([&](const LinearCell& cell) { put(end += static_cast<std::int64_t>(cell.count)); });
    begin(kTypes, count);
    for_cells([&](const LinearCell& cell) { put(vtk_type(cell.kind)); });
    flush();
  }

  /// `value(node, level)` for every point.
  template <typename Value>
  void write_point_array(const VtkArray& array, const Value& value) {
    begin(array, static_cast<std::uint64_t>(cells_.points()));
    const auto levels = static_cast<std::size_t>(mesh_.layers.levels());
    cells_.for_places([&](std::size_t place) { put(value(place / levels, place % levels)); });
    flush();
  }

  void write_point_data() {
    const Layers& layers = mesh_.layers;
    std::size_t last = layers.stop.size();
    std::vector<double> heights;  // of the column that is being written
    write_point_array(kVtkPointData[0], [&](std::size_t n, std::size_t k) {
      if (n != last) heights = layers.heights(n);
      last = n;
      return heights[k];
    });
    write_point_array(kVtkPointData[1], [&](std::size_t n, std::size_t) {
      return static_cast<float>(mesh_.coverage(static_cast<int>(n)));
    });
    write_point_array(kVtkPointData[2], [&](std::size_t n, std::size_t) {
      return static_cast<float>(layers.room_world[n]);
    });
    write_point_array(kVtkPointData[3], [&](std::size_t n, std::size_t) {
      return static_cast<std::uint8_t>(layers.stop[n]);
    });
    write_point_array(kVtkPointData[4],
                      [](std::size_t, std::size_t k) { return static_cast<std::int32_t>(k); });
    write_point_array(kVtkPointData[5],
                      [](std::size_t n, std::size_t) { return static_cast<std::int32_t>(n); });
  }

  void write_cell_data(const QualityField& quality) {
    const auto count = static_cast<std::uint64_t>(cells_.cells());
    begin(kVtkCellData[0], count);
    cells_.for_cells([&](int block, const CellMesh::Place&) { put(std::int32_t{block}); });
    begin(kVtkCellData[1], count);
    cells_.for_cells([&](int, const CellMesh::Place& place) { put(std::int32_t{place[2]}); });
    std::vector<CellFields> fields;
    for (const Block& block : mesh_.blocks) fields.push_back(cell_fields(mesh_, block));
    for (std::size_t f = 0; f + 2 < kVtkCellData.size(); ++f) {
      begin(kVtkCellData[f + 2], count);
      for (std::size_t b = 0; b < fields.size(); ++b) {
        const std::vector<float>& values =
            *vtk_cell_values(quality.scaled_jacobian[b], fields[b])[f];
        const Block& block = mesh_.blocks[b];
        cells_.for_cells_of(static_cast<int>(b), [&](const CellMesh::Place& at) {
          const int cell = (at[2] * block.stacks_j() + at[1]) * block.stacks_i() + at[0];
          put(values[static_cast<std::size_t>(cell)]);
        });
      }
    }
    flush();
  }

  std::ostream& out_;
  const MultiBlock& mesh_;
  CellMesh cells_;
  std::uint64_t corners_ = 0;
  std::uint64_t offset_ = 0;
  std::vector<char> bytes_;
};

}  // namespace

void write_vtu(const std::filesystem::path& file, const MultiBlock& mesh,
               const QualityField& quality) {
  check_of_mesh(quality, mesh);
  OutputFile output(file);
  Grid(output.stream(), mesh).write(quality);
  output.commit();
}

}  // namespace vdb_offset
