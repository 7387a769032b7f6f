// The native mesh format as SU2's documentation ("Mesh File") describes it; numbers of elements are
// those of VTK.

#include "vdb_offset/io/su2.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <iterator>
#include <ostream>
#include <utility>
#include <vector>

#include "io/cell_mesh.h"
#include "io/linear_cell.h"
#include "io/output_file.h"

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

void put_cell(Text& text, const Corners& corners) {
  constexpr std::array<Element, 4> kTypes{kTetra, kPyramid, kPrism, kHexa};
  const LinearCell cell = linear_cell(corners);
  text.element(kTypes[static_cast<std::size_t>(cell.kind)], cell.points());
}

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

}  // namespace

void write_su2(const std::filesystem::path& file, const MultiBlock& mesh) {
  const bool plane = mesh.flat;
  const CellMesh cells(mesh, plane ? CellMesh::Extent::Plane : CellMesh::Extent::Full);
  OutputFile output(file);
  Text text(output.stream());
  text.put("NDIME= {}\nNELEM= {}\n", plane ? 2 : 3, cells.cells());
  cells.for_cells([&](int block, const CellMesh::Place& place) {
    const Corners corners = cells.corners(block, place);
    plane ? text.polygon(CellMesh::plane_cell(corners)) : put_cell(text, corners);
  });
  text.put("NPOIN= {}\n", cells.points());
  cells.for_points([&](const Vec3& p) {
    // The shortest text that brings back every double.
    plane ? text.put("{} {}\n", p.x(), p.y()) : text.put("{} {} {}\n", p.x(), p.y(), p.z());
  });
  put_markers(text, cells, plane);
  text.flush();
  output.commit();
}

}  // namespace vdb_offset
