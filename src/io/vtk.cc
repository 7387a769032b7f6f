// The VTK XML formats as "VTK File Formats" (Kitware) describes them: structured grids with raw
// appended data, listed by a multi-block file.

#include "vdb_offset/io/vtk.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <cstring>
#include <ostream>
#include <string>
#include <string_view>
#include <vector>

#include "io/output_file.h"
#include "io/xml_text.h"
#include "vdb_offset/io/output.h"
#include "vdb_offset/march/spacing.h"

namespace vdb_offset {
namespace {

constexpr std::string_view kByteOrder =
    std::endian::native == std::endian::little ? "LittleEndian" : "BigEndian";

/// One array of the appended part.
struct Array {
  std::string_view name;
  std::string_view type;
  std::uint64_t item_bytes = 0;  ///< of one point or cell
  int components = 1;
};

template <typename T>
void put(std::vector<char>& bytes, const T& value) {
  const std::size_t size = bytes.size();
  bytes.resize(size + sizeof(T));
  std::memcpy(bytes.data() + size, &value, sizeof(T));
}

/// Writes one `.vts`: declares arrays first, then sends their data in the same order.
class Piece {
 public:
  Piece(std::ostream& out, const MultiBlock& mesh, int block)
      : out_(out),
        mesh_(mesh),
        index_(block),
        block_(mesh.blocks[static_cast<std::size_t>(block)]) {}

  void write(const std::vector<float>& scaled_jacobian) {
    write_header();
    write_points();
    write_point_data();
    write_cell_data(scaled_jacobian);
    out_ << "\n</AppendedData>\n</VTKFile>\n";
  }

 private:
  static constexpr Array kPoints{"points", "Float64", 24, 3};
  static constexpr std::array<Array, 6> kPointData{{{"height", "Float64", 8},
                                                    {"coverage", "Float32", 4},
                                                    {"room", "Float32", 4},
                                                    {"stop", "UInt8", 1},
                                                    {"level", "Int32", 4},
                                                    {"node", "Int32", 4}}};
  static constexpr std::array<Array, 9> kCellData{{{"block", "Int32", 4},
                                                   {"layer", "Int32", 4},
                                                   {"scaled_jacobian", "Float32", 4},
                                                   {"volume", "Float32", 4},
                                                   {"min_jacobian", "Float32", 4},
                                                   {"skewness", "Float32", 4},
                                                   {"aspect_ratio", "Float32", 4},
                                                   {"orthogonality", "Float32", 4},
                                                   {"growth", "Float32", 4}}};

  void write_header() {
    const std::string extent =
        fmt::format("0 {} 0 {} 0 {}", block_.ni - 1, block_.nj - 1, block_.nk - 1);
    out_
        << "<?xml version=\"1.0\"?>\n<VTKFile type=\"StructuredGrid\" version=\"1.0\" byte_order=\""
        << kByteOrder << "\" header_type=\"UInt64\">\n<StructuredGrid WholeExtent=\"" << extent
        << "\">\n<Piece Extent=\"" << extent << "\">\n";
    out_ << "<Points>\n";
    declare(kPoints, block_.point_count());
    out_ << "</Points>\n<PointData Scalars=\"height\">\n";
    for (const Array& array : kPointData) declare(array, block_.point_count());
    out_ << "</PointData>\n<CellData Scalars=\"scaled_jacobian\">\n";
    for (const Array& array : kCellData) declare(array, block_.cell_count());
    out_ << "</CellData>\n</Piece>\n</StructuredGrid>\n<AppendedData encoding=\"raw\">\n_";
  }

  void declare(const Array& array, std::uint64_t count) {
    out_ << fmt::format(
        "<DataArray type=\"{}\" Name=\"{}\" NumberOfComponents=\"{}\" format=\"appended\" "
        "offset=\"{}\"/>\n",
        array.type, array.name, array.components, offset_);
    offset_ += sizeof(std::uint64_t) + count * array.item_bytes;
  }

  void begin_array(const Array& array, std::uint64_t count) {
    bytes_.clear();
    put(bytes_, count * array.item_bytes);
  }

  /// Sends what is buffered: a level at a time, so that a block is never in memory twice.
  void flush() {
    out_.write(bytes_.data(), static_cast<std::streamsize>(bytes_.size()));
    bytes_.clear();
  }

  void write_points() {
    begin_array(kPoints, block_.point_count());
    for (int k = 0; k < block_.nk; ++k) {
      for (const int node : block_.columns) {
        const Vec3& p = mesh_.layers.at(node, k);
        put(bytes_, std::array<double, 3>{p.x(), p.y(), p.z()});
      }
      flush();
    }
  }

  /// `value(node, level)` for every point.
  template <typename Value>
  void write_point_array(const Array& array, const Value& value) {
    begin_array(array, block_.point_count());
    for (int k = 0; k < block_.nk; ++k) {
      for (const int node : block_.columns) put(bytes_, value(node, k));
      flush();
    }
  }

  /// True distances of the block's points, as the march laid the levels; in the points' order.
  std::vector<double> level_heights() const {
    std::vector<double> heights(block_.point_count());
    for (std::size_t c = 0; c < block_.columns.size(); ++c) {
      const std::vector<double> column =
          mesh_.layers.heights(static_cast<std::size_t>(block_.columns[c]));
      for (std::size_t k = 0; k < column.size(); ++k) {
        heights[k * block_.columns.size() + c] = column[k];
      }
    }
    return heights;
  }

  void write_point_data() {
    const Layers& layers = mesh_.layers;
    const auto at = [](int node) { return static_cast<std::size_t>(node); };
    const std::vector<double> heights = level_heights();
    std::size_t point = 0;
    write_point_array(kPointData[0], [&](int, int) { return heights[point++]; });
    write_point_array(kPointData[1],
                      [&](int n, int) { return static_cast<float>(mesh_.coverage(n)); });
    write_point_array(kPointData[2],
                      [&](int n, int) { return static_cast<float>(layers.room_world[at(n)]); });
    write_point_array(kPointData[3],
                      [&](int n, int) { return static_cast<std::uint8_t>(layers.stop[at(n)]); });
    write_point_array(kPointData[4], [](int, int k) { return static_cast<std::int32_t>(k); });
    write_point_array(kPointData[5], [](int n, int) { return static_cast<std::int32_t>(n); });
  }

  void write_cell_data(const std::vector<float>& scaled_jacobian) {
    const std::size_t cells = block_.cell_count();
    const std::size_t layer = cells / static_cast<std::size_t>(block_.nk - 1);
    begin_array(kCellData[0], cells);
    for (std::size_t c = 0; c < cells; ++c) put_cell(c, layer, static_cast<std::int32_t>(index_));
    flush();
    begin_array(kCellData[1], cells);
    for (std::size_t c = 0; c < cells; ++c)
      put_cell(c, layer, static_cast<std::int32_t>(c / layer));
    flush();
    write_floats(kCellData[2], scaled_jacobian);
    const CellFields fields = cell_fields(mesh_, block_);
    write_floats(kCellData[3], fields.volume);
    write_floats(kCellData[4], fields.min_jacobian);
    write_floats(kCellData[5], fields.skewness);
    write_floats(kCellData[6], fields.aspect_ratio);
    write_floats(kCellData[7], fields.orthogonality);
    write_floats(kCellData[8], fields.growth);
  }

  void put_cell(std::size_t cell, std::size_t layer, std::int32_t value) {
    put(bytes_, value);
    if ((cell + 1) % layer == 0) flush();
  }

  void write_floats(const Array& array, const std::vector<float>& values) {
    begin_array(array, values.size());
    flush();
    out_.write(reinterpret_cast<const char*>(values.data()),
               static_cast<std::streamsize>(values.size() * sizeof(float)));
  }

  std::ostream& out_;
  const MultiBlock& mesh_;
  int index_;
  const Block& block_;
  std::uint64_t offset_ = 0;
  std::vector<char> bytes_;
};

void check_sizes(const MultiBlock& mesh, const QualityField& quality) {
  const std::size_t blocks = mesh.blocks.size();
  bool fits = quality.scaled_jacobian.size() == blocks;
  for (std::size_t b = 0; fits && b < blocks; ++b) {
    fits = quality.scaled_jacobian[b].size() == mesh.blocks[b].cell_count();
  }
  if (!fits) throw InputError("write_vtm: the quality is not of this mesh; judge it first");
}

Pieces pieces_of(const std::filesystem::path& place) {
  std::filesystem::path folder = place;
  place.has_extension() ? folder.replace_extension() : folder.concat(".blocks");
  return {folder, "block_", ".vts"};
}

void write_index(std::ostream& out, const MultiBlock& mesh, const std::string& folder) {
  out << "<?xml version=\"1.0\"?>\n<VTKFile type=\"vtkMultiBlockDataSet\" version=\"1.0\" "
         "byte_order=\""
      << kByteOrder << "\" header_type=\"UInt64\">\n<vtkMultiBlockDataSet>\n";
  for (std::size_t b = 0; b < mesh.blocks.size(); ++b) {
    out << fmt::format("<DataSet index=\"{}\" name=\"{}\" file=\"{}/block_{}.vts\"/>\n", b,
                       xml_text(mesh.blocks[b].name), xml_text(folder), b);
  }
  out << "</vtkMultiBlockDataSet>\n</VTKFile>\n";
}

}  // namespace

std::filesystem::path vtm_pieces_place(const std::filesystem::path& file) {
  const Pieces pieces = pieces_of(output_place(file));
  pieces.check_ours();
  return pieces.folder;
}

void write_vtm(const std::filesystem::path& file, const MultiBlock& mesh,
               const QualityField& quality) {
  check_sizes(mesh, quality);
  // Through a link the pieces lie beside its target, where the index looks for them.
  const Pieces pieces = pieces_of(output_place(file));
  OutputFile index(file);
  OutputFolder folder(pieces);
  for (std::size_t b = 0; b < mesh.blocks.size(); ++b) {
    OutputFile piece(folder.piece(std::to_string(b)));
    Piece(piece.stream(), mesh, static_cast<int>(b)).write(quality.scaled_jacobian[b]);
    piece.commit();
  }
  write_index(index.stream(), mesh, pieces.folder.filename().string());
  folder.swap_in();
  index.commit();
  folder.commit();
}

}  // namespace vdb_offset
