// The native mesh format as SU2's documentation ("Mesh File") describes it; numbers of elements are
// those of VTK.

#include "vdb_offset/io/su2.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <iterator>
#include <limits>
#include <optional>
#include <ostream>
#include <utility>
#include <vector>

#include "io/cell_mesh.h"
#include "io/linear_cell.h"
#include "io/output_file.h"
#include "vdb_offset/core/error.h"

namespace vdb_offset {
namespace {

enum Element {
  kLine = 3,
  kTriangle = 5,
  kQuad = 9,
  kTetra = 10,
  kHexa = 12,
  kPrism = 13,
  kPyramid = 14
};

/// Text to a stream, in pieces.
class Text {
 public:
  explicit Text(std::ostream& stream) : stream_(stream) {}

  template <typename... Values>
  void put(fmt::format_string<Values...> form, Values&&... values) {
    fmt::format_to(std::back_inserter(buffer_), form, std::forward<Values>(values)...);
    constexpr std::size_t kPiece = std::size_t{1} << 16U;
    if (buffer_.size() >= kPiece) flush();
  }

  template <typename Points>
  void element(Element type, const Points& points) {
    put("{}", static_cast<int>(type));
    for (const std::int32_t point : points) put(" {}", point);
    put("\n");
  }

  void polygon(const Polygon& polygon) {
    constexpr std::array<Element, 5> kTypes{kLine, kLine, kLine, kTriangle, kQuad};
    const auto count = static_cast<std::size_t>(polygon.count);
    element(kTypes[count], std::vector<std::int32_t>(polygon.points.begin(),
                                                     polygon.points.begin() + polygon.count));
  }

  void flush() {
    stream_.write(buffer_.data(), static_cast<std::streamsize>(buffer_.size()));
    buffer_.clear();
  }

 private:
  std::ostream& stream_;
  fmt::memory_buffer buffer_;
};

constexpr std::array<Element, 4> kElements{kTetra, kPyramid, kPrism, kHexa};

/// The element that a cell is; nothing if it is none.
std::optional<LinearCell> element_of(const Corners& corners) {
  const LinearCell cell = linear_cell(corners);
  if (cell.kind != LinearCell::Kind::Hexahedron) return cell;
  const std::array<Polygon, 6> faces = polygons(corners);
  const bool is_whole =
      std::ranges::all_of(faces, [](const Polygon& face) { return face.count == 4; });
  return is_whole ? std::optional(cell) : std::nullopt;
}

/// A face's corners, seen from within the cell.
std::vector<std::int32_t> base(const Polygon& face) {
  return {face.points.rend() - face.count, face.points.rend()};
}

/// Cells that are no element, parted about points in their middles.
class Parts {
 public:
  Parts(const MultiBlock& mesh, const CellMesh& cells) : mesh_(mesh), cells_(cells) {
    cells.for_cells([&](int block, const CellMesh::Place& place) {
      const Corners corners = cells.corners(block, place);
      if (element_of(corners)) return;
      further_ += std::ranges::count_if(polygons(corners), &Polygon::has_area) - 1;
      middles_.push_back(middle(block, place, corners));
    });
  }

  std::int64_t further_cells() const { return further_; }
  const Vec3List& middles() const { return middles_; }

  /// The next of them, in the order of cells.
  void put(Text& text, const Corners& corners) {
    const std::int32_t apex = cells_.points() + next_++;
    for (const Polygon& face : polygons(corners)) {
      if (!face.has_area()) continue;
      std::vector<std::int32_t> points = base(face);
      points.push_back(apex);
      text.element(face.count == 4 ? kPyramid : kTetra, points);
    }
  }

 private:
  /// The mean of the corners, each once.
  Vec3 middle(int block, const CellMesh::Place& place, const Corners& corners) const {
    const std::array<int, 4> ring =
        mesh_.blocks[static_cast<std::size_t>(block)].stack(place[0], place[1]);
    Vec3 sum = Vec3::Zero();
    double count = 0;
    for (std::size_t c = 0; c < 8; ++c) {
      if (std::find(corners.begin(), corners.begin() + c, corners[c]) != corners.begin() + c) {
        continue;
      }
      sum += mesh_.layers.at(ring[c % 4], place[2] + (c < 4 ? 0 : 1));
      ++count;
    }
    return sum / count;
  }

  const MultiBlock& mesh_;
  const CellMesh& cells_;
  Vec3List middles_;
  std::int64_t further_ = 0;
  std::int32_t next_ = 0;
};

void put_markers(Text& text, const CellMesh& cells, bool plane) {
  text.put("NMARK= {}\n", cells.patches().size());
  for (const CellPatch& patch : cells.patches()) {
    text.put("MARKER_TAG= {}\nMARKER_ELEMS= {}\n", patch.name, patch.faces);
    for (const BlockRange& range : patch.ranges) {
      cells.for_cells_behind(range, [&](int block, const CellMesh::Place& place, BlockFace of) {
        const Corners corners = cells.corners(block, place);
        const Polygon face = plane ? CellMesh::plane_side(corners, of)
                                   : polygons(corners)[static_cast<std::size_t>(of)];
        if (face.count >= (plane ? 2 : 3)) text.polygon(face);
      });
    }
  }
}

void put_plane(Text& text, const CellMesh& cells) {
  text.put("NDIME= 2\nNELEM= {}\n", cells.cells());
  cells.for_cells([&](int block, const CellMesh::Place& place) {
    text.polygon(CellMesh::plane_cell(cells.corners(block, place)));
  });
  text.put("NPOIN= {}\n", cells.points());
  // The shortest text that brings back every double.
  cells.for_points([&](const Vec3& p) { text.put("{} {}\n", p.x(), p.y()); });
}

void put_space(Text& text, const MultiBlock& mesh, const CellMesh& cells) {
  Parts parts(mesh, cells);
  const std::int64_t elements = cells.cells() + parts.further_cells();
  const std::int64_t points = cells.points() + std::ssize(parts.middles());
  if (std::max(elements, points) > std::numeric_limits<std::int32_t>::max()) {
    throw LimitError(fmt::format("{} elements are more than SU2 files can number", elements));
  }
  text.put("NDIME= 3\nNELEM= {}\n", elements);
  cells.for_cells([&](int block, const CellMesh::Place& place) {
    const Corners corners = cells.corners(block, place);
    const std::optional<LinearCell> cell = element_of(corners);
    if (!cell) return parts.put(text, corners);
    text.element(kElements[static_cast<std::size_t>(cell->kind)], cell->points());
  });
  text.put("NPOIN= {}\n", points);
  const auto put_point = [&](const Vec3& p) { text.put("{} {} {}\n", p.x(), p.y(), p.z()); };
  cells.for_points(put_point);
  std::ranges::for_each(parts.middles(), put_point);
}

}  // namespace

void write_su2(const std::filesystem::path& file, const MultiBlock& mesh) {
  const bool plane = mesh.flat;
  const CellMesh cells(mesh, plane ? CellMesh::Extent::Plane : CellMesh::Extent::Full);
  OutputFile output(file);
  Text text(output.stream());
  plane ? put_plane(text, cells) : put_space(text, mesh, cells);
  put_markers(text, cells, plane);
  text.flush();
  output.commit();
}

}  // namespace vdb_offset
