#include "blocks/check_faces.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <unordered_map>

namespace vdb_offset {
namespace {

constexpr std::array<std::string_view, 6> kFaceNames{"i min", "i max", "j min",
                                                     "j max", "k min", "k max"};

/// How often a face of a cell is covered, or that it is not and lies where another such lies.
enum State : std::uint8_t { kNone = 0, kOnce = 1, kMore = 2, kTouching = 3 };

/// The faces of cells on one face of a zone, `na x nb`, along its lower axis fastest.
struct FaceMap {
  int zone;
  BlockFace face;
  std::array<std::size_t, 2> axes;
  int na;
  int nb;
  std::vector<std::uint8_t> state;

  std::uint8_t& at(int a, int b) {
    return state[static_cast<std::size_t>(b) * static_cast<std::size_t>(na) +
                 static_cast<std::size_t>(a)];
  }
};

FaceMap make_map(const Zone& zone, int index, BlockFace face) {
  const std::array<std::size_t, 2> axes = axes_along(face);
  const std::array<int, 3> sizes = sizes_of(zone);
  FaceMap map{index, face, axes, sizes[axes[0]] - 1, sizes[axes[1]] - 1, {}};
  map.state.resize(static_cast<std::size_t>(map.na) * static_cast<std::size_t>(map.nb), kNone);
  return map;
}

/// A rectangle of faces as a range of points.
struct Rectangle {
  int a_begin, a_end, b_begin, b_end;  ///< faces, the ends not among them
};

BlockRange range_of(const ZoneMesh& mesh, const FaceMap& map, const Rectangle& r) {
  BlockRange range{map.zone, map.face, {}, {}};
  const std::size_t normal = axis_of(map.face);
  const int last = sizes_of(mesh.zones[static_cast<std::size_t>(map.zone)])[normal] - 1;
  range.begin[normal] = range.end[normal] = is_max(map.face) ? last : 0;
  range.begin[map.axes[0]] = r.a_begin;
  range.end[map.axes[0]] = r.a_end;
  range.begin[map.axes[1]] = r.b_begin;
  range.end[map.axes[1]] = r.b_end;
  return range;
}

/// Takes a rectangle of faces of one state out of the map: as long as it can be, then as wide.
Rectangle take_rectangle(FaceMap& map, int a, int b) {
  const std::uint8_t state = map.at(a, b);
  Rectangle r{a, a, b, b};
  while (r.a_end < map.na && map.at(r.a_end, b) == state) ++r.a_end;
  const auto is_whole = [&](int row) {
    for (int n = r.a_begin; n < r.a_end; ++n) {
      if (map.at(n, row) != state) return false;
    }
    return true;
  };
  while (r.b_end < map.nb && is_whole(r.b_end)) {
    for (int n = r.a_begin; n < r.a_end; ++n) map.at(n, r.b_end) = kOnce;
    ++r.b_end;
  }
  return r;
}

using Corners = std::array<Vec3, 4>;

/// A face of a cell that nothing covers.
struct OpenFace {
  std::size_t map;
  int a;
  int b;
  Corners corners;
  Vec3 centre;
  double tolerance;  ///< within which corners are the same; below 0: a face without area
};

OpenFace open_face(const ZoneMesh& mesh, const FaceMap& map, int a, int b) {
  const Zone& zone = mesh.zones[static_cast<std::size_t>(map.zone)];
  OpenFace face{0, a, b, {}, Vec3::Zero(), -1};
  for (std::size_t c = 0; c < 4; ++c) {
    const int da = c == 1 || c == 2 ? 1 : 0;
    const int db = c >= 2 ? 1 : 0;
    const auto p = range_of(mesh, map, {a + da, a + da, b + db, b + db}).begin;
    face.corners[c] = zone.at(p[0], p[1], p[2]);
    face.centre += 0.25 * face.corners[c];
  }
  double shortest = std::numeric_limits<double>::infinity();
  for (std::size_t c = 0; c < 4; ++c) {
    const double length = (face.corners[(c + 1) % 4] - face.corners[c]).norm();
    if (length > 0) shortest = std::min(shortest, length);
  }
  const Vec3 area = (face.corners[2] - face.corners[0]).cross(face.corners[3] - face.corners[1]);
  // Farther out, distances overflow.
  const bool is_near = face.centre.squaredNorm() < 1e200;
  if (is_near && area.norm() > 0 && std::isfinite(area.norm())) {
    face.tolerance = kMatchTolerance * shortest;
  }
  return face;
}

/// Whether two sides opposite each other have no length: nothing lies on either side.
bool is_line(const OpenFace& face) {
  const auto is_point = [&](std::size_t c) { return face.corners[c] == face.corners[(c + 1) % 4]; };
  return (is_point(0) && is_point(2)) || (is_point(1) && is_point(3));
}

bool coincide(const OpenFace& one, const OpenFace& other) {
  if (one.map == other.map && one.a == other.a && one.b == other.b) return false;
  const double tolerance = std::min(one.tolerance, other.tolerance);
  return std::ranges::all_of(one.corners, [&](const Vec3& p) {
    return std::ranges::any_of(other.corners,
                               [&](const Vec3& q) { return (p - q).norm() <= tolerance; });
  });
}

/// Open faces by where their centres are: a lattice that is fine against the mesh.
class OpenFaces {
 public:
  OpenFaces(const ZoneMesh& mesh, std::vector<FaceMap>& maps) {
    for (std::size_t m = 0; m < maps.size(); ++m) {
      for (int b = 0; b < maps[m].nb; ++b) {
        for (int a = 0; a < maps[m].na; ++a) add(mesh, maps, {m, a, b});
      }
    }
    step_ = std::max(box_.size() * kStep, std::numeric_limits<double>::min());
    for (std::size_t n = 0; n < faces_.size(); ++n) {
      const Vec3 at = (faces_[n].centre - box_.lo) / step_;
      lattice_.emplace(key(at.array().floor()), n);
    }
  }

  const std::vector<OpenFace>& faces() const { return faces_; }

  /// The first other face that lies where this one lies, or none.
  const OpenFace* twin_of(const OpenFace& face) const {
    const double reach = std::min(face.tolerance, 0.5 * step_);
    std::size_t best = faces_.size();
    for (int corner = 0; corner < 8; ++corner) {
      const Vec3 off{corner & 1 ? reach : -reach, corner & 2 ? reach : -reach,
                     corner & 4 ? reach : -reach};
      const Vec3 at = (face.centre + off - box_.lo) / step_;
      const auto [begin, end] = lattice_.equal_range(key(at.array().floor()));
      for (auto found = begin; found != end; ++found) {
        if (found->second < best && coincide(face, faces_[found->second])) best = found->second;
      }
    }
    return best < faces_.size() ? &faces_[best] : nullptr;
  }

 private:
  static constexpr double kStep = 1e-6;  ///< of the lattice, over the size of all

  struct Spot {
    std::size_t map;
    int a;
    int b;
  };

  void add(const ZoneMesh& mesh, std::vector<FaceMap>& maps, const Spot& spot) {
    FaceMap& map = maps[spot.map];
    if (map.at(spot.a, spot.b) != kNone) return;
    OpenFace face = open_face(mesh, map, spot.a, spot.b);
    if (is_line(face)) map.at(spot.a, spot.b) = kOnce;  // needs no cover
    if (face.tolerance < 0) return;
    face.map = spot.map;
    box_.add(face.centre);
    faces_.push_back(face);
  }

  static std::uint64_t key(const Vec3& whole) {
    std::uint64_t key = 0;
    for (const double x : whole) {
      key = key * 4194319 + static_cast<std::uint64_t>(static_cast<std::int64_t>(x) + 2);
    }
    return key;
  }

  std::vector<OpenFace> faces_;
  Box box_;
  double step_ = 0;
  std::unordered_multimap<std::uint64_t, std::size_t> lattice_;
};

/// Maps of all faces of all zones: 6 a zone, in the order of BlockFace.
std::vector<FaceMap> covered(const ZoneMesh& mesh, const std::vector<BlockRange>& ranges) {
  std::vector<FaceMap> maps;
  for (std::size_t z = 0; z < mesh.zones.size(); ++z) {
    for (int f = 0; f < 6; ++f) {
      maps.push_back(make_map(mesh.zones[z], static_cast<int>(z), static_cast<BlockFace>(f)));
    }
  }
  for (const BlockRange& given : ranges) {
    const BlockRange range = ascending(given);
    FaceMap& map =
        maps[static_cast<std::size_t>(range.block) * 6 + static_cast<std::size_t>(range.face)];
    for (int b = range.begin[map.axes[1]]; b < range.end[map.axes[1]]; ++b) {
      for (int a = range.begin[map.axes[0]]; a < range.end[map.axes[0]]; ++a) {
        map.at(a, b) = map.at(a, b) == kNone ? kOnce : kMore;
      }
    }
  }
  return maps;
}

std::string what_is_wrong(std::uint8_t state, std::uint64_t faces) {
  switch (state) {
    case kNone:
      return fmt::format("{} faces in no interface and no boundary", faces);
    case kMore:
      return fmt::format("{} faces in more than one interface or boundary", faces);
    default:
      return fmt::format("{} faces in no interface, though they lie", faces);
  }
}

FaultKind kind_of(std::uint8_t state) {
  if (state == kTouching) return FaultKind::Gap;
  return state == kMore ? FaultKind::DoublyCovered : FaultKind::Uncovered;
}

}  // namespace

std::string place_in_words(const ZoneMesh& mesh, const BlockRange& range) {
  const auto zone = static_cast<std::size_t>(range.block);
  std::string words = zone < mesh.zones.size() ? fmt::format("zone '{}'", mesh.zones[zone].name)
                                               : fmt::format("zone {}, which is none", zone + 1);
  words += fmt::format(", {}", kFaceNames[static_cast<std::size_t>(range.face)]);
  for (const std::size_t a : axes_along(range.face)) {
    words += fmt::format(", {} = {}-{}", "ijk"[a], range.begin[a] + 1, range.end[a] + 1);
  }
  return words;
}

bool lies_on_face(const ZoneMesh& mesh, const BlockRange& range) {
  if (range.block < 0 || static_cast<std::size_t>(range.block) >= mesh.zones.size()) return false;
  const auto sizes = sizes_of(mesh.zones[static_cast<std::size_t>(range.block)]);
  for (std::size_t a = 0; a < 3; ++a) {
    if (std::min(range.begin[a], range.end[a]) < 0) return false;
    if (std::max(range.begin[a], range.end[a]) >= sizes[a]) return false;
    if (a != axis_of(range.face) && range.begin[a] == range.end[a]) return false;
  }
  const std::size_t normal = axis_of(range.face);
  const int level = is_max(range.face) ? sizes[normal] - 1 : 0;
  return range.begin[normal] == level && range.end[normal] == level;
}

std::vector<MeshFault> check_coverage(const ZoneMesh& mesh, const std::vector<BlockRange>& ranges) {
  std::vector<FaceMap> maps = covered(mesh, ranges);
  const OpenFaces open(mesh, maps);
  std::unordered_map<std::uint8_t*, int> beside;  // the zone that a touching face lies at
  for (const OpenFace& face : open.faces()) {
    const OpenFace* const twin = open.twin_of(face);
    if (twin == nullptr) continue;
    std::uint8_t& state = maps[face.map].at(face.a, face.b);
    state = kTouching;
    beside[&state] = maps[twin->map].zone;
  }
  std::vector<MeshFault> faults;
  for (FaceMap& map : maps) {
    for (std::size_t n = 0; n < map.state.size(); ++n) {
      const std::uint8_t state = map.state[n];
      if (state == kOnce) continue;
      const int a = static_cast<int>(n) % map.na;
      const Rectangle r = take_rectangle(map, a, static_cast<int>(n) / map.na);
      for (int done = r.a_begin; done < r.a_end; ++done) map.at(done, r.b_begin) = kOnce;
      const BlockRange range = range_of(mesh, map, r);
      MeshFault fault{kind_of(state), {}, {range}};
      fault.count = static_cast<std::uint64_t>(r.a_end - r.a_begin) *
                    static_cast<std::uint64_t>(r.b_end - r.b_begin);
      fault.text = place_in_words(mesh, range) + ": " + what_is_wrong(state, fault.count);
      if (state == kTouching) {
        const auto zone = static_cast<std::size_t>(beside.at(&map.state[n]));
        fault.text += fmt::format(" at faces of zone '{}' in none", mesh.zones[zone].name);
      }
      faults.push_back(std::move(fault));
    }
  }
  return faults;
}

}  // namespace vdb_offset
