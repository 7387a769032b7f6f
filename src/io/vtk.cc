// The VTK XML formats as "VTK File Formats" (Kitware) describes them: structured grids with raw
// appended data, listed by a multi-block file.

#include "vdb_offset/io/vtk.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <ostream>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "io/output_file.h"
#include "io/vtk_arrays.h"
#include "io/xml_text.h"
#include "vdb_offset/io/output.h"
#include "vdb_offset/march/spacing.h"

namespace vdb_offset {
namespace {

/// Points of a block, from the first index of each direction to the last; one layer of points has
/// the cells that stand on it.
struct Part {
  int block;
  std::array<int, 3> first;
  std::array<int, 3> last;
};

Part whole(const Block& block, int index) {
  return {index, {0, 0, 0}, {block.ni - 1, block.nj - 1, block.nk - 1}};
}

Part part_of(const BlockRange& range) {
  Part part{range.block, range.begin, range.end};
  for (std::size_t a = 0; a < 3; ++a) {
    if (part.first[a] > part.last[a]) std::swap(part.first[a], part.last[a]);
  }
  return part;
}

/// What a block's cells carry.
struct CellValues {
  const std::vector<float>& scaled_jacobian;
  const CellFields& fields;
};

/// Writes one `.vts`: declares arrays first, then sends their data in the same order.
class Piece {
 public:
  Piece(std::ostream& out, const MultiBlock& mesh, const Part& part)
      : out_(out),
        mesh_(mesh),
        part_(part),
        block_(mesh.blocks[static_cast<std::size_t>(part.block)]),
        columns_(columns_of(part, block_)),
        points_(columns_.size() * static_cast<std::size_t>(part.last[2] - part.first[2] + 1)),
        cells_(cell_count(part)) {}

  void write(const CellValues& values) {
    write_header();
    write_points();
    write_point_data();
    write_cell_data(values);
    out_ << "\n</AppendedData>\n</VTKFile>\n";
  }

 private:
  static std::size_t cell_count(const Part& part) {
    std::size_t count = 1;
    for (std::size_t a = 0; a < 3; ++a) {
      count *= static_cast<std::size_t>(std::max(1, part.last[a] - part.first[a]));
    }
    return count;
  }

  static std::vector<int> columns_of(const Part& part, const Block& block) {
    std::vector<int> columns;
    for (int j = part.first[1]; j <= part.last[1]; ++j) {
      for (int i = part.first[0]; i <= part.last[0]; ++i) columns.push_back(block.column(i, j));
    }
    return columns;
  }

  /// `visit(cell)` for each of the part's cells, by its index in the block, in order.
  template <typename Visit>
  void for_cells(const Visit& visit) const {
    const std::array<int, 3> cells{block_.ni - 1, block_.nj - 1, block_.nk - 1};
    std::array<int, 3> begin{};
    std::array<int, 3> end{};
    for (std::size_t a = 0; a < 3; ++a) {
      const bool is_flat = part_.first[a] == part_.last[a];
      begin[a] = is_flat ? std::min(part_.first[a], cells[a] - 1) : part_.first[a];
      end[a] = is_flat ? begin[a] + 1 : part_.last[a];
    }
    for (int k = begin[2]; k < end[2]; ++k) {
      for (int j = begin[1]; j < end[1]; ++j) {
        const std::size_t row = static_cast<std::size_t>(k) * static_cast<std::size_t>(cells[1]) +
                                static_cast<std::size_t>(j);
        const std::size_t start = row * static_cast<std::size_t>(cells[0]);
        for (int i = begin[0]; i < end[0]; ++i) visit(start + static_cast<std::size_t>(i));
      }
    }
  }

  void write_header() {
    const std::string extent =
        fmt::format("{} {} {} {} {} {}", part_.first[0], part_.last[0], part_.first[1],
                    part_.last[1], part_.first[2], part_.last[2]);
    out_
        << "<?xml version=\"1.0\"?>\n<VTKFile type=\"StructuredGrid\" version=\"1.0\" byte_order=\""
        << kVtkByteOrder << "\" header_type=\"UInt64\">\n<StructuredGrid WholeExtent=\"" << extent
        << "\">\n<Piece Extent=\"" << extent << "\">\n";
    out_ << "<Points>\n";
    declare(kVtkPoints, points_);
    out_ << "</Points>\n<PointData Scalars=\"height\">\n";
    for (const VtkArray& array : kVtkPointData) declare(array, points_);
    out_ << "</PointData>\n<CellData Scalars=\"scaled_jacobian\">\n";
    for (const VtkArray& array : kVtkCellData) declare(array, cells_);
    out_ << "</CellData>\n</Piece>\n</StructuredGrid>\n<AppendedData encoding=\"raw\">\n_";
  }

  void declare(const VtkArray& array, std::uint64_t count) {
    out_ << vtk_declaration(array, count, offset_);
  }

  void begin_array(const VtkArray& array, std::uint64_t count) {
    bytes_.clear();
    put_bytes(bytes_, count * array.item_bytes);
  }

  /// Sends what is buffered: a level at a time, so that a block is never in memory twice.
  void flush() {
    out_.write(bytes_.data(), static_cast<std::streamsize>(bytes_.size()));
    bytes_.clear();
  }

  void write_points() {
    begin_array(kVtkPoints, points_);
    for (int k = part_.first[2]; k <= part_.last[2]; ++k) {
      for (const int node : columns_) {
        const Vec3& p = mesh_.layers.at(node, k);
        put_bytes(bytes_, std::array<double, 3>{p.x(), p.y(), p.z()});
      }
      flush();
    }
  }

  /// `value(node, level)` for every point.
  template <typename Value>
  void write_point_array(const VtkArray& array, const Value& value) {
    begin_array(array, points_);
    for (int k = part_.first[2]; k <= part_.last[2]; ++k) {
      for (const int node : columns_) put_bytes(bytes_, value(node, k));
      flush();
    }
  }

  /// True distances of the part's points, as the march laid the levels; in the points' order.
  std::vector<double> level_heights() const {
    std::vector<double> heights(points_);
    for (std::size_t c = 0; c < columns_.size(); ++c) {
      const std::vector<double> column =
          mesh_.layers.heights(static_cast<std::size_t>(columns_[c]));
      std::size_t point = c;
      for (int k = part_.first[2]; k <= part_.last[2]; ++k, point += columns_.size()) {
        heights[point] = column[static_cast<std::size_t>(k)];
      }
    }
    return heights;
  }

  void write_point_data() {
    const Layers& layers = mesh_.layers;
    const auto at = [](int node) { return static_cast<std::size_t>(node); };
    const std::vector<double> heights = level_heights();
    std::size_t point = 0;
    write_point_array(kVtkPointData[0], [&](int, int) { return heights[point++]; });
    write_point_array(kVtkPointData[1],
                      [&](int n, int) { return static_cast<float>(mesh_.coverage(n)); });
    write_point_array(kVtkPointData[2],
                      [&](int n, int) { return static_cast<float>(layers.room_world[at(n)]); });
    write_point_array(kVtkPointData[3],
                      [&](int n, int) { return static_cast<std::uint8_t>(layers.stop[at(n)]); });
    write_point_array(kVtkPointData[4], [](int, int k) { return static_cast<std::int32_t>(k); });
    write_point_array(kVtkPointData[5], [](int n, int) { return static_cast<std::int32_t>(n); });
  }

  void write_cell_data(const CellValues& values) {
    const std::size_t layer =
        static_cast<std::size_t>(block_.ni - 1) * static_cast<std::size_t>(block_.nj - 1);
    write_cell_array(kVtkCellData[0], [&](std::size_t) { return std::int32_t{part_.block}; });
    write_cell_array(kVtkCellData[1],
                     [&](std::size_t cell) { return static_cast<std::int32_t>(cell / layer); });
    const auto floats = vtk_cell_values(values.scaled_jacobian, values.fields);
    for (std::size_t f = 0; f < floats.size(); ++f) {
      write_cell_array(kVtkCellData[f + 2], [&](std::size_t cell) { return (*floats[f])[cell]; });
    }
  }

  /// `value(cell)` for every cell, by its index in the block.
  template <typename Value>
  void write_cell_array(const VtkArray& array, const Value& value) {
    constexpr std::size_t kBuffered = 1U << 20U;  // bytes
    begin_array(array, cells_);
    for_cells([&](std::size_t cell) {
      put_bytes(bytes_, value(cell));
      if (bytes_.size() >= kBuffered) flush();
    });
    flush();
  }

  std::ostream& out_;
  const MultiBlock& mesh_;
  Part part_;
  const Block& block_;
  std::vector<int> columns_;
  std::size_t points_;
  std::size_t cells_;
  std::uint64_t offset_ = 0;
  std::vector<char> bytes_;
};

Pieces pieces_of(const std::filesystem::path& place) {
  std::filesystem::path folder = place;
  place.has_extension() ? folder.replace_extension() : folder.concat(".blocks");
  return {folder, "block_", ".vts"};
}

/// A part of a block's face, and the names of the surface that it lies on and of its file.
struct NamedFace {
  std::string name;
  Part part;
  std::string piece;
};

/// All that have a name, those of one name together, in the order in which names first appear.
std::vector<NamedFace> faces_of(const MultiBlock& mesh) {
  std::vector<NamedFace> faces;
  std::vector<int> count(mesh.blocks.size(), 0);
  const auto add = [&](const std::string& name, const BlockRange& range) {
    if (name.empty()) return;
    const int n = count[static_cast<std::size_t>(range.block)]++;
    auto after = std::find_if(faces.rbegin(), faces.rend(),
                              [&](const NamedFace& face) { return face.name == name; });
    faces.insert(after == faces.rend() ? faces.end() : after.base(),
                 {name, part_of(range), fmt::format("{}_face_{}", range.block, n)});
  };
  for (const BoundaryFace& face : mesh.boundary_faces) add(face.name, face.range);
  for (const Interface& interface : mesh.interfaces) add(interface.name, interface.first);
  return faces;
}

/// The blocks, and behind them the group "boundaries": a group of faces for each name.
void write_index(std::ostream& out, const MultiBlock& mesh, const std::string& folder) {
  out << "<?xml version=\"1.0\"?>\n<VTKFile type=\"vtkMultiBlockDataSet\" version=\"1.0\" "
         "byte_order=\""
      << kVtkByteOrder << "\" header_type=\"UInt64\">\n<vtkMultiBlockDataSet>\n";
  const auto put_piece = [&](std::size_t index, int block, const std::string& piece) {
    out << fmt::format("<DataSet index=\"{}\" name=\"{}\" file=\"{}/block_{}.vts\"/>\n", index,
                       xml_text(mesh.blocks[static_cast<std::size_t>(block)].name),
                       xml_text(folder), piece);
  };
  const std::size_t blocks = mesh.blocks.size();
  for (std::size_t b = 0; b < blocks; ++b) put_piece(b, static_cast<int>(b), std::to_string(b));
  const std::vector<NamedFace> faces = faces_of(mesh);
  if (!faces.empty()) out << fmt::format("<Block index=\"{}\" name=\"boundaries\">\n", blocks);
  std::size_t names = 0;
  std::size_t of_name = 0;
  for (std::size_t f = 0; f < faces.size(); ++f, ++of_name) {
    if (f == 0 || faces[f].name != faces[f - 1].name) {
      out << (f == 0 ? "" : "</Block>\n")
          << fmt::format("<Block index=\"{}\" name=\"{}\">\n", names++, xml_text(faces[f].name));
      of_name = 0;
    }
    put_piece(of_name, faces[f].part.block, faces[f].piece);
  }
  if (!faces.empty()) out << "</Block>\n</Block>\n";
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
  check_of_mesh(quality, mesh);
  // Through a link the pieces lie beside its target, where the index looks for them.
  const Pieces pieces = pieces_of(output_place(file));
  OutputFile index(file);
  OutputFolder folder(pieces);
  const std::vector<NamedFace> faces = faces_of(mesh);
  for (std::size_t b = 0; b < mesh.blocks.size(); ++b) {
    const CellFields fields = cell_fields(mesh, mesh.blocks[b]);
    const auto write_piece = [&](const Part& part, const std::string& name) {
      OutputFile piece(folder.piece(name));
      Piece(piece.stream(), mesh, part).write({quality.scaled_jacobian[b], fields});
      piece.commit();
    };
    write_piece(whole(mesh.blocks[b], static_cast<int>(b)), std::to_string(b));
    for (const NamedFace& face : faces) {
      if (face.part.block == static_cast<int>(b)) write_piece(face.part, face.piece);
    }
  }
  write_index(index.stream(), mesh, pieces.folder.filename().string());
  folder.swap_in();
  index.commit();
  folder.commit();
}

}  // namespace vdb_offset
