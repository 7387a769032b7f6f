// The native mesh format as SU2's documentation ("Mesh File") describes it; numbers of elements are
// those of VTK.

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include "io/input_file.h"
#include "io/number_text.h"
#include "io/text_lines.h"
#include "vdb_offset/core/error.h"
#include "vdb_offset/io/su2.h"

namespace vdb_offset {
namespace {

constexpr std::int64_t kMost = std::numeric_limits<std::int32_t>::max();

struct Element {
  int number;
  std::size_t corners;
};
constexpr Element kLine{3, 2};
constexpr Element kTriangle{5, 3};
constexpr Element kQuad{9, 4};
constexpr std::array<std::pair<Element, CellKind>, 4> kCells{{{{10, 4}, CellKind::Tetrahedron},
                                                              {{12, 8}, CellKind::Hexahedron},
                                                              {{13, 6}, CellKind::Prism},
                                                              {{14, 5}, CellKind::Pyramid}}};

class Reader {
 public:
  Reader(std::string_view bytes, const std::string& name)
      : bytes_(bytes), lines_(bytes), name_(name) {}

  CellZone read() {
    while (next()) read_section();
    if (dimensions_ == 0) throw IoError(name_ + ": has no NDIME=; is it a native SU2 mesh?");
    if (mesh_.kinds.empty() && plane_.size() == 0) {
      throw IoError(name_ + ": has no elements (NELEM=)");
    }
    if (mesh_.points_world.empty()) throw IoError(name_ + ": has no points (NPOIN=)");
    check_indices();
    if (dimensions_ == 2) make_thick();
    return std::move(mesh_);
  }

 private:
  [[noreturn]] void refuse(const std::string& why) const {
    throw IoError(fmt::format("{}, line {}: {}", name_, lines_.number(), why),
                  {static_cast<std::int64_t>(lines_.number())});
  }

  /// The next line that says something, without its comment.
  bool next() {
    while (lines_.next()) {
      const std::string_view line = lines_.line();
      line_ = line.substr(0, line.find('%'));
      words_ = tokens_of(line_);
      if (!words_.empty()) return true;
    }
    return false;
  }

  std::int64_t whole(std::string_view word, const char* what, std::int64_t most) const {
    const auto value = parse_whole(word);
    if (!value) refuse(fmt::format("{} {} is no whole number", what, quoted(word)));
    if (*value < 0 || *value > most) {
      refuse(fmt::format("{} = {}, but must be in [0, {}]", what, *value, most));
    }
    return *value;
  }

  /// What stands behind '='; nothing if this line does not begin with `key`.
  std::optional<std::string_view> value_of(std::string_view key) const {
    const std::size_t begin = line_.find_first_not_of(" \t");
    if (line_.substr(begin, key.size()) != key) return {};
    const std::size_t equals = line_.find('=');
    if (equals == std::string_view::npos) return {};
    const std::vector<std::string_view> words = tokens_of(line_.substr(equals + 1));
    if (words.empty()) refuse(fmt::format("nothing behind {}=", key));
    return words.front();
  }

  /// A count of lines: each takes two bytes at least.
  std::size_t count(std::string_view word, const char* what) const {
    return static_cast<std::size_t>(
        whole(word, what, std::min<std::int64_t>(kMost, std::ssize(bytes_))));
  }

  void read_section() {
    if (const auto zones = value_of("NZONE")) {
      if (whole(*zones, "NZONE", kMost) != 1)
        refuse("several zones; give them in files of their own");
    } else if (const auto dimensions = value_of("NDIME")) {
      dimensions_ = static_cast<int>(whole(*dimensions, "NDIME", 3));
      if (dimensions_ < 2) refuse(fmt::format("NDIME = {}, but must be 2 or 3", dimensions_));
    } else if (const auto elements = value_of("NELEM")) {
      read_elements(count(*elements, "NELEM"));
    } else if (const auto points = value_of("NPOIN")) {
      read_points(count(*points, "NPOIN"));
    } else if (const auto markers = value_of("NMARK")) {
      const std::size_t number = count(*markers, "NMARK");
      for (std::size_t m = 0; m < number; ++m) read_marker(m, number);
    } else if (line_.find('=') == std::string_view::npos) {
      refuse(fmt::format("{} where a keyword (NELEM=, NPOIN=, NMARK= ...) is expected",
                         quoted(words_.front())));
    }
  }

  void need(const char* what, std::size_t n, std::size_t all) {
    if (!next()) refuse(fmt::format("ends after {} of {} {}", n, all, what));
  }

  std::vector<std::int32_t> corners(std::size_t wanted) const {
    if (words_.size() < wanted + 1) {
      refuse(fmt::format("{} words, but an element of type {} has {} points", words_.size(),
                         words_.front(), wanted));
    }
    std::vector<std::int32_t> out;
    for (std::size_t n = 1; n <= wanted; ++n) {
      out.push_back(static_cast<std::int32_t>(whole(words_[n], "point", kMost - 1)));
      highest_ = std::max(highest_, out.back());
    }
    return out;
  }

  void need_dimensions() const {
    if (dimensions_ == 0) refuse("NDIME= has to stand before elements and points");
  }

  void read_elements(std::size_t number) {
    need_dimensions();
    for (std::size_t e = 0; e < number; ++e) {
      need("elements", e, number);
      const std::int64_t type = whole(words_.front(), "element type", kMost);
      if (dimensions_ == 2 && (type == kTriangle.number || type == kQuad.number)) {
        plane_.add(corners(type == kTriangle.number ? kTriangle.corners : kQuad.corners));
        continue;
      }
      const auto* const found =
          std::ranges::find_if(kCells, [&](const auto& cell) { return cell.first.number == type; });
      if (dimensions_ == 2 || found == kCells.end()) {
        refuse(fmt::format("element type {}, but cells of {} dimensions are {}", type, dimensions_,
                           dimensions_ == 2 ? "5 or 9" : "10, 12, 13 or 14"));
      }
      mesh_.add(found->second, corners(found->first.corners));
    }
  }

  void read_points(std::size_t number) {
    need_dimensions();
    mesh_.points_world.clear();
    for (std::size_t p = 0; p < number; ++p) {
      need("points", p, number);
      const auto axes = static_cast<std::size_t>(dimensions_);
      if (words_.size() < axes)
        refuse(fmt::format("{} words, but a point has {}", words_.size(), axes));
      Vec3 point = Vec3::Zero();
      for (std::size_t a = 0; a < axes; ++a) {
        const auto value = parse_real(words_[a]);
        if (!value || !std::isfinite(*value)) {
          refuse(fmt::format("coordinate {} is no finite number", quoted(words_[a])));
        }
        point[static_cast<Eigen::Index>(a)] = *value;
      }
      mesh_.points_world.push_back(point);
    }
  }

  void read_marker(std::size_t m, std::size_t number) {
    need("markers", m, number);
    const auto tag = value_of("MARKER_TAG");
    if (!tag) refuse("MARKER_TAG= is expected");
    need_dimensions();
    CellBoundary boundary;
    boundary.name = std::string(*tag);
    need("markers", m, number);
    const auto elements = value_of("MARKER_ELEMS");
    if (!elements) refuse("MARKER_ELEMS= is expected");
    const std::size_t faces = count(*elements, "MARKER_ELEMS");
    for (std::size_t f = 0; f < faces; ++f) {
      need("marker elements", f, faces);
      const std::int64_t type = whole(words_.front(), "element type", kMost);
      if (type == 1) continue;  // a vertex: of the halo
      const bool is_line = dimensions_ == 2 && type == kLine.number;
      const bool is_face = dimensions_ == 3 && (type == kTriangle.number || type == kQuad.number);
      if (!is_line && !is_face) {
        refuse(fmt::format("element type {}, but faces of {} dimensions are {}", type, dimensions_,
                           dimensions_ == 2 ? "3" : "5 or 9"));
      }
      boundary.faces.add(corners(is_line                    ? kLine.corners
                                 : type == kTriangle.number ? kTriangle.corners
                                                            : kQuad.corners));
    }
    if (boundary.name != "SEND_RECEIVE") mesh_.boundaries.push_back(std::move(boundary));
  }

  void check_indices() const {
    if (highest_ < std::ssize(mesh_.points_world)) return;
    throw IoError(fmt::format("{}: an element has point {}, but there are {}, from 0", name_,
                              highest_, mesh_.points_world.size()));
  }

  /// Points again behind the plane; triangles become prisms, quads hexahedra, lines quads.
  void make_thick() {
    Vec3List& points = mesh_.points_world;
    if (2 * std::ssize(points) > kMost) throw LimitError(name_ + ": has too many points");
    Vec3 lo = points.front();
    Vec3 hi = lo;
    for (const Vec3& p : points) {
      lo = lo.cwiseMin(p);
      hi = hi.cwiseMax(p);
    }
    const double width = (hi - lo).maxCoeff();
    const auto shift = static_cast<std::int32_t>(points.size());
    points.reserve(2 * points.size());
    for (std::int32_t p = 0; p < shift; ++p) {
      const Vec3& from = points[static_cast<std::size_t>(p)];
      points.emplace_back(from.x(), from.y(), width > 0 ? width : 1.0);
    }
    CellBoundary front{"front"};
    CellBoundary back{"back"};
    for (std::size_t c = 0; c < plane_.size(); ++c) {
      std::vector<std::int32_t> cell(plane_[c].begin(), plane_[c].end());
      front.faces.add(cell);
      const std::size_t corners = cell.size();
      for (std::size_t n = 0; n < corners; ++n) cell.push_back(cell[n] + shift);
      back.faces.add(std::span(cell).subspan(corners));
      mesh_.add(corners == 3 ? CellKind::Prism : CellKind::Hexahedron, cell);
    }
    for (CellBoundary& boundary : mesh_.boundaries) {
      PointLists quads;
      for (std::size_t f = 0; f < boundary.faces.size(); ++f) {
        const auto line = boundary.faces[f];
        quads.add(std::array{line[0], line[1], line[1] + shift, line[0] + shift});
      }
      boundary.faces = std::move(quads);
    }
    mesh_.boundaries.push_back(std::move(front));
    mesh_.boundaries.push_back(std::move(back));
    mesh_.flat = true;
  }

  std::string_view bytes_;
  TextLines lines_;
  const std::string& name_;
  std::string_view line_;
  std::vector<std::string_view> words_;
  int dimensions_ = 0;
  mutable std::int32_t highest_ = -1;
  CellZone mesh_;
  PointLists plane_;  // the cells of two dimensions
};

}  // namespace

CellZone read_su2(const std::filesystem::path& file) {
  const std::string bytes = contents_of(file, "a SU2 mesh");
  const std::string name = file.string();
  return Reader(bytes, name).read();
}

}  // namespace vdb_offset
