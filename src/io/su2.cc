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
#include <ostream>
#include <span>
#include <utility>
#include <vector>

#include "io/cell_mesh.h"
#include "io/cell_parts.h"
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

/// `parts`: of a mesh in space.
void put_markers(Text& text, const CellMesh& cells, const CellParts* parts) {
  text.put("NMARK= {}\n", cells.patches().size());
  for (const CellPatch& patch : cells.patches()) {
    std::vector<Polygon> faces;
    for (const BlockRange& range : patch.ranges) {
      cells.for_cells_behind(range, [&](int block, const CellMesh::Place& place, BlockFace of) {
        if (parts != nullptr) {
          std::ranges::copy(parts->face(block, place, of), std::back_inserter(faces));
          return;
        }
        const Polygon side = CellMesh::plane_side(cells.corners(block, place), of);
        if (side.count == 2) faces.push_back(side);
      });
    }
    text.put("MARKER_TAG= {}\nMARKER_ELEMS= {}\n", patch.name, faces.size());
    for (const Polygon& face : faces) text.polygon(face);
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

void put_space(Text& text, const CellMesh& cells, const CellParts& parts) {
  const std::int64_t points = cells.points() + std::ssize(parts.middles());
  if (std::max(parts.elements(), points) > std::numeric_limits<std::int32_t>::max()) {
    throw LimitError(
        fmt::format("{} elements are more than SU2 files can number", parts.elements()));
  }
  text.put("NDIME= 3\nNELEM= {}\n", parts.elements());
  cells.for_cells([&](int block, const CellMesh::Place& place) {
    parts.put(block, place, [&](LinearCell::Kind kind, std::span<const std::int32_t> corners) {
      text.element(kElements[static_cast<std::size_t>(kind)], corners);
    });
  });
  text.put("NPOIN= {}\n", points);
  const auto put_point = [&](const Vec3& p) { text.put("{} {} {}\n", p.x(), p.y(), p.z()); };
  cells.for_points(put_point);
  std::ranges::for_each(parts.middles(), put_point);
}

}  // namespace

std::int64_t write_su2(const std::filesystem::path& file, const MultiBlock& mesh) {
  const bool plane = mesh.flat;
  const CellMesh cells(mesh, plane ? CellMesh::Extent::Plane : CellMesh::Extent::Full);
  OutputFile output(file);
  Text text(output.stream());
  std::int64_t inverted = 0;
  if (plane) {
    put_plane(text, cells);
    put_markers(text, cells, nullptr);
  } else {
    const CellParts parts(mesh, cells);
    put_space(text, cells, parts);
    put_markers(text, cells, &parts);
    inverted = parts.inverted();
  }
  text.flush();
  output.commit();
  return inverted;
}

}  // namespace vdb_offset
