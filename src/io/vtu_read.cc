// Unstructured grids of anybody, as "VTK File Formats" (Kitware) describes them.

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "io/number_text.h"
#include "io/vtk_file.h"
#include "vdb_offset/io/vtk.h"

namespace vdb_offset {
namespace {

/// VTK's numbers of cells.
enum VtkType : std::int64_t {
  kVertex = 1,
  kPolyVertex = 2,
  kLine = 3,
  kPolyLine = 4,
  kTriangle = 5,
  kPolygon = 7,
  kPixel = 8,
  kQuad = 9,
  kTetrahedron = 10,
  kVoxel = 11,
  kHexahedron = 12,
  kWedge = 13,
  kPyramid = 14,
  kPolyhedron = 42
};

/// Volumes of a number of corners of their own.
struct Volume {
  VtkType type;
  CellKind kind;
  std::size_t corners;
};
constexpr std::array<Volume, 5> kVolumes{{{kTetrahedron, CellKind::Tetrahedron, 4},
                                          {kVoxel, CellKind::Hexahedron, 8},
                                          {kHexahedron, CellKind::Hexahedron, 8},
                                          {kWedge, CellKind::Prism, 6},
                                          {kPyramid, CellKind::Pyramid, 5}}};

class Reader {
 public:
  explicit Reader(const std::filesystem::path& file) : file_(file, "UnstructuredGrid") {}

  CellZone read() {
    mesh_.names_boundaries = false;
    for (const pugi::xml_node& piece : file_.root().children("Piece")) read_piece(piece);
    if (mesh_.kinds.empty()) file_.refuse("has no cells with a volume");
    if (open_ > 0) {
      mesh_.faults.push_back(fmt::format(
          "{} polyhedra whose faces do not close; the first: cell {}", open_, first_open_));
    }
    if (faces_.size() > 0) mesh_.boundaries.push_back({"faces", "", std::move(faces_)});
    return std::move(mesh_);
  }

 private:
  using Numbers = std::vector<std::int64_t>;

  std::size_t count(const pugi::xml_node& piece, const char* name) const {
    const std::string_view text = piece.attribute(name).value();
    const auto value = parse_whole(text);
    if (!value || *value < 0 || *value > static_cast<std::int64_t>(kMostVtkPoints)) {
      file_.refuse(
          fmt::format("{} is {}, but must be in [0, {}]", name, quoted(text), kMostVtkPoints));
    }
    return static_cast<std::size_t>(*value);
  }

  Numbers wholes(const pugi::xml_node& cells, const char* name, std::size_t count) const {
    const pugi::xml_node array = cells.find_child_by_attribute("DataArray", "Name", name);
    if (!array) file_.refuse(fmt::format("<Cells> has no array {}", quoted(name)));
    return file_.wholes(array, count);
  }

  void read_piece(const pugi::xml_node& piece) {
    const std::size_t points = count(piece, "NumberOfPoints");
    const std::size_t cells = count(piece, "NumberOfCells");
    shift_ = mesh_.points_world.size();
    if (shift_ + points > kMostVtkPoints) file_.refuse("has too many points");
    const Vec3List more = file_.points(piece, points);
    mesh_.points_world.insert(mesh_.points_world.end(), more.begin(), more.end());
    read_cells(piece.child("Cells"), cells);
  }

  /// Ends of lists: none before that before it.
  std::size_t last_of(const Numbers& ends, const char* name) const {
    for (std::size_t c = 0; c < ends.size(); ++c) {
      if (ends[c] >= (c == 0 ? 0 : ends[c - 1])) continue;
      file_.refuse(
          fmt::format("{} of cell {} is {}, before that of the one before", name, c, ends[c]));
    }
    return ends.empty() ? 0 : static_cast<std::size_t>(ends.back());
  }

  void read_cells(const pugi::xml_node& node, std::size_t cells) {
    const Numbers types = wholes(node, "types", cells);
    const Numbers ends = wholes(node, "offsets", cells);
    const Numbers corners = wholes(node, "connectivity", last_of(ends, "offset"));
    if (std::ranges::count(types, kPolyhedron) > 0) read_faces(node, cells);
    for (std::size_t c = 0; c < cells; ++c) {
      cell_ = c;
      const auto begin = static_cast<std::size_t>(c == 0 ? 0 : ends[c - 1]);
      const auto size = static_cast<std::size_t>(ends[c]) - begin;
      add(types[c], std::span(corners).subspan(begin, size));
    }
  }

  /// Of polyhedra: where those of a cell end, -1 for others.
  void read_faces(const pugi::xml_node& node, std::size_t cells) {
    if (!node.find_child_by_attribute("DataArray", "Name", "faceoffsets")) {
      file_.refuse(
          "polyhedra are read where <Cells> has faces and faceoffsets alone; write a "
          "version below 2.3 of the format");
    }
    face_ends_ = wholes(node, "faceoffsets", cells);
    const auto last = std::ranges::max_element(face_ends_);
    const auto length = static_cast<std::size_t>(std::max<std::int64_t>(*last, 0));
    face_list_ = wholes(node, "faces", length);
    face_begin_ = 0;
  }

  std::int32_t point(std::int64_t p) const {
    const auto points = static_cast<std::int64_t>(mesh_.points_world.size() - shift_);
    if (p < 0 || p >= points) {
      file_.refuse(fmt::format("cell {} has point {}, but there are {}, from 0", cell_, p, points));
    }
    return static_cast<std::int32_t>(p + static_cast<std::int64_t>(shift_));
  }

  void add(std::int64_t type, std::span<const std::int64_t> corners) {
    if (type >= kVertex && type <= kPolyLine) return;
    if (type == kPolyhedron) return add_polyhedron();
    std::vector<std::int32_t> points;
    for (const std::int64_t corner : corners) points.push_back(point(corner));
    // Those of the axes list the second pair of a square the other way.
    if (type == kPixel || type == kVoxel) {
      for (std::size_t at = 2; at + 1 < points.size(); at += 4)
        std::swap(points[at], points[at + 1]);
    }
    if (type == kTriangle || (type >= kPolygon && type <= kQuad)) {
      const std::size_t expected = type == kTriangle ? 3 : type == kPolygon ? points.size() : 4;
      if (points.size() < 3 || points.size() != expected) refuse_corners(type, points.size());
      return faces_.add(points);
    }
    const auto volume = std::ranges::find(kVolumes, type, &Volume::type);
    if (volume == kVolumes.end()) {
      file_.refuse(
          fmt::format("cell {} has the type {}, but linear cells alone are read (1 to 14 "
                      "without 6, and 42)",
                      cell_, type));
    }
    if (points.size() != volume->corners) refuse_corners(type, points.size());
    // The base of VTK's wedges runs the other way than that of its other cells.
    if (type == kWedge) {
      std::swap(points[1], points[2]);
      std::swap(points[4], points[5]);
    }
    mesh_.add(volume->kind, points);
  }

  [[noreturn]] void refuse_corners(std::int64_t type, std::size_t corners) const {
    file_.refuse(fmt::format("cell {}, of the type {}, has {} points", cell_, type, corners));
  }

  void add_polyhedron() {
    const std::int64_t end = face_ends_[cell_];
    std::vector<std::int32_t> list;
    std::int64_t at = face_begin_;
    const auto next = [&] {
      if (at >= end) file_.refuse(fmt::format("faces of cell {} end early", cell_));
      return face_list_[static_cast<std::size_t>(at++)];
    };
    const auto next_count = [&](std::int64_t least) {
      const std::int64_t value = next();
      if (value >= least && value <= end - at) return value;
      file_.refuse(
          fmt::format("faces of cell {}: {} is no number of faces or points", cell_, value));
    };
    edges_.clear();
    const std::int64_t faces = next_count(4);
    list.push_back(static_cast<std::int32_t>(faces));
    for (std::int64_t f = 0; f < faces; ++f) {
      const std::int64_t corners = next_count(3);
      list.push_back(static_cast<std::int32_t>(corners));
      for (std::int64_t n = 0; n < corners; ++n) list.push_back(point(next()));
      const auto around = std::span(list).last(static_cast<std::size_t>(corners));
      for (std::size_t n = 0; n < around.size(); ++n) {
        edges_.push_back({around[n], around[(n + 1) % around.size()]});
      }
    }
    if (!edges_close() && open_++ == 0) first_open_ = mesh_.kinds.size();
    if (at != end)
      file_.refuse(fmt::format("faces of cell {} do not end where they should", cell_));
    face_begin_ = end;
    mesh_.add(CellKind::Polyhedron, list);
  }

  /// Whether each edge of a polyhedron is run along once each way.
  bool edges_close() {
    auto back = edges_;
    for (auto& [from, to] : back) std::swap(from, to);
    std::ranges::sort(edges_);
    std::ranges::sort(back);
    return edges_ == back && std::ranges::adjacent_find(edges_) == edges_.end();
  }

  VtkFile file_;
  CellZone mesh_;
  PointLists faces_;
  std::size_t shift_ = 0;  ///< points of the pieces before
  std::size_t cell_ = 0;   ///< of the piece; for messages
  Numbers face_ends_;
  Numbers face_list_;
  std::int64_t face_begin_ = 0;
  std::vector<std::pair<std::int32_t, std::int32_t>> edges_;  ///< of the polyhedron
  std::size_t open_ = 0;                                      ///< polyhedra that are not closed
  std::size_t first_open_ = 0;
};

}  // namespace

CellZone read_vtu(const std::filesystem::path& file) { return Reader(file).read(); }

}  // namespace vdb_offset
