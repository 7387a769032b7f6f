// Unstructured zones as the SIDS have them: elements numbered through all sections, to which the
// BCs refer by these numbers. The SIDS' linear elements have their corners in the order of VTK's.

#include <cgnslib.h>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "io/cgns_zones.h"
#include "vdb_offset/blocks/conditions.h"
#include "vdb_offset/core/error.h"
#include "vdb_offset/io/cgns.h"

namespace vdb_offset {
namespace {

constexpr std::int64_t kMost = std::numeric_limits<std::int32_t>::max() - 1;

/// An element that is read: a cell of that kind, or a face.
struct Linear {
  std::int64_t type;
  std::size_t corners;
  std::optional<CellKind> kind;
};
constexpr std::array<Linear, 6> kLinear{{{CGNS_ENUMV(TRI_3), 3, {}},
                                         {CGNS_ENUMV(QUAD_4), 4, {}},
                                         {CGNS_ENUMV(TETRA_4), 4, CellKind::Tetrahedron},
                                         {CGNS_ENUMV(PYRA_5), 5, CellKind::Pyramid},
                                         {CGNS_ENUMV(PENTA_6), 6, CellKind::Prism},
                                         {CGNS_ENUMV(HEXA_8), 8, CellKind::Hexahedron}}};

const Linear* find_linear(std::int64_t type) {
  const auto* const found = std::ranges::find(kLinear, type, &Linear::type);
  return found == kLinear.end() ? nullptr : found;
}

std::string type_name(std::int64_t type) {
  if (type < 0 || type >= NofValidElementTypes) return fmt::format("number {}", type);
  return ElementTypeName[type];
}

/// The numbers of a section's elements, and which of the zone's faces each is: -1 for cells.
struct Section {
  std::int64_t first, last;
  std::vector<std::int32_t> face;

  std::span<const std::int32_t> faces(std::int64_t from, std::int64_t to) const {
    return std::span(face).subspan(static_cast<std::size_t>(from - first),
                                   static_cast<std::size_t>(to - from + 1));
  }
};

class ZoneReader {
 public:
  ZoneReader(const CgnsBase& base, const CgnsZone& zone, CellZone& mesh)
      : base_(base), zone_(zone), mesh_(mesh) {}

  void read() {
    const Vec3List points = zone_.read_points();
    shift_ = std::ssize(mesh_.points_world);
    if (shift_ + std::ssize(points) > kMost) zone_.node.refuse("more points than can be numbered");
    mesh_.points_world.insert(mesh_.points_world.end(), points.begin(), points.end());
    const std::size_t cells = mesh_.kinds.size();
    for (const CgnsNode& node : zone_.node.children("Elements_t")) read_section(node);
    check_numbers();
    const auto found = static_cast<std::int64_t>(mesh_.kinds.size() - cells);
    if (found != zone_.cells) {
      fault(fmt::format("says that it has {} cells, and its sections have {}", zone_.cells, found));
    }
    for (const auto& all : zone_.node.children("ZoneGridConnectivity_t")) {
      for (const CgnsNode& node : all.children()) {
        fault(fmt::format("'{}' is connectivity to another zone, which is not read", node.name()));
      }
    }
    for (const auto& all : zone_.node.children("ZoneBC_t")) {
      for (const CgnsNode& node : all.children("BC_t")) read_boundary(node);
    }
  }

 private:
  void fault(const std::string& why) {
    mesh_.faults.push_back(fmt::format("zone '{}' {}", zone_.name, why));
  }

  void read_section(const CgnsNode& node) {
    const std::vector<std::int64_t> head = node.integers();
    if (head.empty()) node.refuse("has no element type");
    const Linear* const linear = find_linear(head[0]);
    if (linear == nullptr && head[0] != CGNS_ENUMV(MIXED)) {
      node.refuse(fmt::format(
          "has elements of type {}; TETRA_4, PYRA_5, PENTA_6, HEXA_8, TRI_3, QUAD_4 and MIXED "
          "ones of these are read",
          type_name(head[0])));
    }
    const auto range = node.child("IndexRange_t", "ElementRange");
    const std::vector<std::int64_t> ends = range ? range->integers() : std::vector<std::int64_t>{};
    if (ends.size() != 2 || ends[0] < 1 || ends[1] < ends[0] || ends[1] > kMost) {
      node.refuse(fmt::format("has an ElementRange of {}, and not of two numbers, ascending from 1",
                              fmt::join(ends, " to ")));
    }
    const auto array = node.child("DataArray_t", "ElementConnectivity");
    if (!array) node.refuse("has no ElementConnectivity");
    sections_.push_back({ends[0], ends[1], {}});
    const std::vector<std::int64_t> points = array->integers();
    linear != nullptr ? read_one_kind(*array, *linear, points) : read_mixed(*array, points);
  }

  void read_one_kind(const CgnsNode& array, const Linear& linear,
                     std::span<const std::int64_t> points) {
    const Section& section = sections_.back();
    const auto count = static_cast<std::size_t>(section.last - section.first + 1);
    if (points.size() != count * linear.corners) {
      array.refuse(fmt::format("has {} points, but elements {} to {} of {} have {}", points.size(),
                               section.first, section.last, type_name(linear.type),
                               count * linear.corners));
    }
    for (std::size_t e = 0; e < count; ++e) {
      add(array, linear, points.subspan(e * linear.corners, linear.corners));
    }
  }

  /// Each element behind the number of its type.
  void read_mixed(const CgnsNode& array, std::span<const std::int64_t> words) {
    std::size_t at = 0;
    for (std::int64_t e = sections_.back().first; e <= sections_.back().last; ++e) {
      if (at == words.size()) array.refuse(fmt::format("ends before its element {}", e));
      const Linear* const linear = find_linear(words[at]);
      if (linear == nullptr) {
        array.refuse(
            fmt::format("has element {} of type {}, which is not read", e, type_name(words[at])));
      }
      if (words.size() - at <= linear->corners) {
        array.refuse(fmt::format("ends within its element {}", e));
      }
      add(array, *linear, words.subspan(at + 1, linear->corners));
      at += linear->corners + 1;
    }
    if (at < words.size()) array.refuse("goes on behind its last element");
  }

  /// The next element of the last section.
  void add(const CgnsNode& array, const Linear& linear, std::span<const std::int64_t> points) {
    std::array<std::int32_t, 8> corners{};
    for (std::size_t c = 0; c < points.size(); ++c) {
      if (points[c] < 1 || points[c] > zone_.size[0]) {
        array.refuse(fmt::format("names the point {}, but its zone has {}, from 1", points[c],
                                 zone_.size[0]));
      }
      corners[c] = static_cast<std::int32_t>(points[c] - 1 + shift_);
    }
    const auto list = std::span<const std::int32_t>(corners).first(points.size());
    std::vector<std::int32_t>& face = sections_.back().face;
    if (linear.kind) {
      mesh_.add(*linear.kind, list);
      return face.push_back(-1);
    }
    face.push_back(static_cast<std::int32_t>(faces_.size()));
    faces_.add(list);
  }

  void check_numbers() {
    std::ranges::sort(sections_, {}, &Section::first);
    for (std::size_t s = 0; s + 1 < sections_.size(); ++s) {
      if (sections_[s].last < sections_[s + 1].first) continue;
      zone_.node.refuse(fmt::format("has two sections with an element {}", sections_[s + 1].first));
    }
  }

  /// The one of its name and type.
  CellBoundary& boundary_of(const CgnsNode& node) {
    const std::string family = family_of(node);
    const Condition condition = condition_of(base_, node, family);
    const bool is_said = condition.kind != ConditionKind::Unspecified;
    CellBoundary boundary{family.empty() ? node.name() : family,
                          is_said ? std::string(cgns_type(condition)) : std::string()};
    for (CellBoundary& other : mesh_.boundaries) {
      if (other.name == boundary.name && other.type == boundary.type) return other;
    }
    mesh_.boundaries.push_back(std::move(boundary));
    return mesh_.boundaries.back();
  }

  void read_boundary(const CgnsNode& node) {
    CellBoundary& boundary = boundary_of(node);
    const auto location = node.child("GridLocation_t");
    const std::string at = location ? location->text() : "Vertex";
    auto range = node.child("IndexRange_t", "ElementRange");
    auto list = node.child("IndexArray_t", "ElementList");
    if (!range && !list) {
      range = node.child("IndexRange_t", "PointRange");
      list = node.child("IndexArray_t", "PointList");
      if ((range || list) && at != "FaceCenter") {
        return fault(fmt::format("'{}' is of points at {}, which do not say what faces it has",
                                 node.name(), at));
      }
    }
    if (!range && !list) return fault(fmt::format("'{}' has neither range nor list", node.name()));
    const std::vector<std::int64_t> numbers = range ? range->integers() : list->integers();
    if (range && (numbers.size() != 2 || numbers[0] > numbers[1])) {
      return fault(fmt::format("'{}' has a range that is none: {}", node.name(),
                               fmt::join(numbers, " to ")));
    }
    std::uint64_t missed = 0;
    if (range) {
      missed = static_cast<std::uint64_t>(numbers[1]) - static_cast<std::uint64_t>(numbers[0]) + 1 -
               add_faces(numbers[0], numbers[1], boundary);
    } else {
      for (const std::int64_t number : numbers) missed += 1 - add_faces(number, number, boundary);
    }
    if (missed == 0) return;
    fault(fmt::format("'{}' names {} elements that are no faces of it", node.name(), missed));
  }

  /// How many there are.
  std::uint64_t add_faces(std::int64_t first, std::int64_t last, CellBoundary& boundary) const {
    std::uint64_t count = 0;
    auto section = std::ranges::lower_bound(sections_, first, {}, &Section::last);
    for (; section != sections_.end() && section->first <= last; ++section) {
      const std::int64_t from = std::max(first, section->first);
      for (const std::int32_t face : section->faces(from, std::min(last, section->last))) {
        if (face < 0) continue;
        boundary.faces.add(faces_[static_cast<std::size_t>(face)]);
        ++count;
      }
    }
    return count;
  }

  const CgnsBase& base_;
  const CgnsZone& zone_;
  CellZone& mesh_;
  std::int64_t shift_ = 0;         // of this zone's points in the mesh
  std::vector<Section> sections_;  // by their numbers, once all are read
  PointLists faces_;
};

}  // namespace

CellZone read_cgns_cells(const std::filesystem::path& file) {
  try_apart(file, [&] { read_cgns_cells(file); });
  CgnsTree tree(file);
  const CgnsBase base = read_base(tree);
  for (const CgnsZone& zone : base.zones) {
    if (zone.is_structured) {
      zone.node.refuse("is structured, and other zones are not; give them in files of their own");
    }
  }
  if (base.cell_dimension != 3) {
    base.node.refuse(
        fmt::format("has cells of {} dimensions; unstructured zones are read as "
                    "volume meshes alone",
                    base.cell_dimension));
  }
  CellZone mesh;
  for (const CgnsZone& zone : base.zones) ZoneReader(base, zone, mesh).read();
  if (mesh.kinds.empty()) base.node.refuse("has no cells in its zones' Elements_t");
  mesh.names_boundaries = !mesh.boundaries.empty();
  return mesh;
}

}  // namespace vdb_offset
