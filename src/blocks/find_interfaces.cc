#include "vdb_offset/blocks/find_interfaces.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>
#include <optional>
#include <unordered_map>
#include <utility>
#include <vector>

#include "blocks/check_faces.h"

namespace vdb_offset {
namespace {

using Index = std::array<int, 3>;
using Four = std::array<std::int32_t, 4>;

constexpr std::int32_t kNowhere = -1;

/// A face of a cell on a zone's surface: `at` is its first corner, a point.
struct Quad {
  int zone;
  BlockFace face;
  Index at;
};

/// Turns of a quad's corners (0, 0), (1, 0), (1, 1), (0, 1): which of the other's each meets.
constexpr std::array<std::array<std::size_t, 4>, 8> kTurns{{{0, 1, 2, 3},
                                                            {1, 2, 3, 0},
                                                            {2, 3, 0, 1},
                                                            {3, 0, 1, 2},
                                                            {0, 3, 2, 1},
                                                            {3, 2, 1, 0},
                                                            {2, 1, 0, 3},
                                                            {1, 0, 3, 2}}};

struct BitsHash {
  std::size_t operator()(const Vec3& p) const {
    std::uint64_t hash = 0;
    for (double x : p) {
      x += 0.0;  // -0 is 0
      std::uint64_t bits = 0;
      std::memcpy(&bits, &x, sizeof(bits));
      hash = (hash ^ bits) * 0x9E3779B97F4A7C15ULL;
      hash ^= hash >> 29U;
    }
    return hash;
  }
};

/// All faces of cells on the zones' surfaces, and which two are one.
class Quads {
 public:
  explicit Quads(const ZoneMesh& mesh) : mesh_(mesh) {
    std::size_t size = 0;
    for (std::size_t z = 0; z < mesh.zones.size(); ++z) {
      for (int f = 0; f < 6; ++f) {
        first_.push_back(size);
        const auto [na, nb] = cells_of(static_cast<int>(z), static_cast<BlockFace>(f));
        size += static_cast<std::size_t>(na) * static_cast<std::size_t>(nb);
      }
    }
    twin_.assign(size, -1);
    taken_.assign(size, 0);
    number_points();
    pair();
  }

  std::array<int, 2> cells_of(int zone, BlockFace face) const {
    const Index sizes = sizes_of(mesh_.zones[static_cast<std::size_t>(zone)]);
    const auto [a, b] = axes_along(face);
    return {sizes[a] - 1, sizes[b] - 1};
  }

  std::size_t index(const Quad& quad) const {
    const auto [a, b] = axes_along(quad.face);
    const auto na = static_cast<std::size_t>(cells_of(quad.zone, quad.face)[0]);
    return first_[static_cast<std::size_t>(quad.zone) * 6 + static_cast<std::size_t>(quad.face)] +
           static_cast<std::size_t>(quad.at[b]) * na + static_cast<std::size_t>(quad.at[a]);
  }

  /// `visit(quad)` along each face's lower axis fastest.
  template <typename Visit>
  void for_quads(const Visit& visit) const {
    for (std::size_t z = 0; z < mesh_.zones.size(); ++z) {
      for (int f = 0; f < 6; ++f) {
        const auto face = static_cast<BlockFace>(f);
        const Index sizes = sizes_of(mesh_.zones[z]);
        BlockRange whole{static_cast<int>(z), face, {}, {}};
        const std::size_t normal = axis_of(face);
        whole.begin[normal] = whole.end[normal] = is_max(face) ? sizes[normal] - 1 : 0;
        for (const std::size_t a : axes_along(face)) whole.end[a] = sizes[a] - 1;
        for_quads_in(whole, visit);
      }
    }
  }
  template <typename Visit>
  static void for_quads_in(const BlockRange& given, const Visit& visit) {
    const BlockRange range = ascending(given);
    const auto [a, b] = axes_along(range.face);
    Quad quad{range.block, range.face, range.begin};
    for (quad.at[b] = range.begin[b]; quad.at[b] < range.end[b]; ++quad.at[b]) {
      for (quad.at[a] = range.begin[a]; quad.at[a] < range.end[a]; ++quad.at[a]) visit(quad);
    }
  }

  /// Numbers of points; a point that is no number has none.
  Four corners(const Quad& quad) const {
    const auto [a, b] = axes_along(quad.face);
    Four out{};
    for (std::size_t c = 0; c < 4; ++c) {
      Index p = quad.at;
      p[a] += c == 1 || c == 2 ? 1 : 0;
      p[b] += c >= 2 ? 1 : 0;
      const Zone& zone = mesh_.zones[static_cast<std::size_t>(quad.zone)];
      const auto found = numbers_.find(zone.at(p[0], p[1], p[2]));
      out[c] = found == numbers_.end() ? kNowhere : found->second;
    }
    return out;
  }

  bool is_free(const Quad& quad) const {
    const std::size_t n = index(quad);
    return taken_[n] == 0 && twin_[n] >= 0 && taken_[static_cast<std::size_t>(twin_[n])] == 0;
  }
  bool is_taken(const Quad& quad) const { return taken_[index(quad)] != 0; }
  void take(const Quad& quad) { taken_[index(quad)] = 1; }
  void leave(const Quad& quad) { taken_[index(quad)] = 0; }
  /// The index of the other face there; -1: none, or several.
  std::int64_t twin(const Quad& quad) const { return twin_[index(quad)]; }
  bool is_taken(std::int64_t index) const { return taken_[static_cast<std::size_t>(index)] != 0; }

  Quad quad(std::int64_t index) const {
    const auto n = static_cast<std::size_t>(index);
    const auto face = std::ranges::upper_bound(first_, n) - first_.begin() - 1;
    Quad out{static_cast<int>(face / 6), static_cast<BlockFace>(face % 6), {0, 0, 0}};
    const auto [a, b] = axes_along(out.face);
    const auto na = static_cast<std::size_t>(cells_of(out.zone, out.face)[0]);
    const std::size_t rest = n - first_[static_cast<std::size_t>(face)];
    out.at[a] = static_cast<int>(rest % na);
    out.at[b] = static_cast<int>(rest / na);
    const std::size_t normal = axis_of(out.face);
    const Index sizes = sizes_of(mesh_.zones[static_cast<std::size_t>(out.zone)]);
    out.at[normal] = is_max(out.face) ? sizes[normal] - 1 : 0;
    return out;
  }

 private:
  void number_points() {
    for_quads([&](const Quad& quad) {
      const Zone& zone = mesh_.zones[static_cast<std::size_t>(quad.zone)];
      const auto [a, b] = axes_along(quad.face);
      for (const int c : {0, 1, 2, 3}) {
        Index p = quad.at;
        p[a] += c & 1;
        p[b] += c >> 1;
        numbers_.try_emplace(zone.at(p[0], p[1], p[2]), static_cast<std::int32_t>(numbers_.size()));
      }
    });
  }

  void pair() {
    std::vector<std::pair<Four, std::int64_t>> quads;
    for_quads([&](const Quad& quad) {
      Four key = corners(quad);
      std::ranges::sort(key);
      if (key.front() == kNowhere) return;
      if (std::ranges::unique(key).size() > 1) return;  // no area
      quads.emplace_back(key, static_cast<std::int64_t>(index(quad)));
    });
    std::ranges::sort(quads);
    for (std::size_t n = 0; n < quads.size();) {
      std::size_t end = n + 1;
      while (end < quads.size() && quads[end].first == quads[n].first) ++end;
      if (end == n + 2) {
        twin_[static_cast<std::size_t>(quads[n].second)] = quads[n + 1].second;
        twin_[static_cast<std::size_t>(quads[n + 1].second)] = quads[n].second;
      }
      n = end;
    }
  }

  const ZoneMesh& mesh_;
  std::unordered_map<Vec3, std::int32_t, BitsHash> numbers_;
  std::vector<std::size_t> first_;  ///< of the quads of each face of each zone
  std::vector<std::int64_t> twin_;
  std::vector<char> taken_;
};

/// The interface of two quads if the corners of the one are those of the other, turned so.
std::optional<Interface> meet(const Quads& surface, const Quad& one, const Quad& other,
                              const std::array<std::size_t, 4>& turn) {
  const Four p = surface.corners(one);
  const Four q = surface.corners(other);
  for (std::size_t c = 0; c < 4; ++c) {
    if (p[c] != q[turn[c]]) return {};
  }
  const auto [a, b] = axes_along(one.face);
  const std::array<std::size_t, 2> to = axes_along(other.face);
  const auto spot = [&](std::size_t c) {
    Index at = other.at;
    at[to[0]] += c == 1 || c == 2 ? 1 : 0;
    at[to[1]] += c >= 2 ? 1 : 0;
    return at;
  };
  Interface out{{one.zone, one.face, one.at, one.at}, {other.zone, other.face, {}, {}}};
  ++out.first.end[a];
  ++out.first.end[b];
  out.second.begin = spot(turn[0]);
  out.second.end = spot(turn[2]);
  const Index along = spot(turn[1]);
  for (const std::size_t axis : to) {
    const bool is_first = along[axis] != out.second.begin[axis];
    const int sign = out.second.end[axis] > out.second.begin[axis] ? 1 : -1;
    out.transform[is_first ? a : b] = sign * (static_cast<int>(axis) + 1);
  }
  const int through = static_cast<int>(axis_of(other.face)) + 1;
  out.transform[axis_of(one.face)] = is_max(one.face) != is_max(other.face) ? through : -through;
  return out;
}

/// Makes an interface longer along one of its axes while the next row of faces goes on with it.
class Growth {
 public:
  Growth(const Quads& surface, Interface& interface) : surface_(surface), one_(interface) {}

  void run() {
    for (const std::size_t axis : axes_along(one_.first.face)) {
      while (goes_on(axis)) {
        const auto m = static_cast<std::size_t>(std::abs(one_.transform[axis])) - 1;
        ++one_.first.end[axis];
        one_.second.end[m] += one_.transform[axis] > 0 ? 1 : -1;
      }
    }
  }

 private:
  bool goes_on(std::size_t axis) const {
    const auto [a, b] = axes_along(one_.first.face);
    const auto cells = surface_.cells_of(one_.first.block, one_.first.face);
    if (one_.first.end[axis] >= cells[axis == a ? 0 : 1]) return false;
    BlockRange row = one_.first;
    row.begin[axis] = row.end[axis];
    ++row.end[axis];
    bool goes = true;
    Quads::for_quads_in(row, [&](const Quad& quad) { goes = goes && fits(quad); });
    return goes;
  }

  /// Whether the face's corners are those of the face that the transform leads to.
  bool fits(const Quad& quad) const {
    if (!surface_.is_free(quad)) return false;
    const Quad other = surface_.quad(surface_.twin(quad));
    if (other.zone != one_.second.block || other.face != one_.second.face) return false;
    if (contains(one_.first, other)) return false;
    return std::ranges::any_of(kTurns, [&](const auto& turn) {
      const auto met = meet(surface_, quad, other, turn);
      return met && met->transform == one_.transform && leads_to(*met);
    });
  }

  static bool contains(const BlockRange& range, const Quad& quad) {
    if (range.block != quad.zone || range.face != quad.face) return false;
    return std::ranges::all_of(axes_along(range.face), [&](std::size_t a) {
      return range.begin[a] <= quad.at[a] && quad.at[a] < range.end[a];
    });
  }

  bool leads_to(const Interface& met) const {
    Index to = one_.second.begin;
    for (std::size_t n = 0; n < 3; ++n) {
      const int direction = one_.transform[n];
      to[static_cast<std::size_t>(std::abs(direction)) - 1] +=
          (direction > 0 ? 1 : -1) * (met.first.begin[n] - one_.first.begin[n]);
    }
    return to == met.second.begin;
  }

  const Quads& surface_;
  Interface& one_;
};

std::uint64_t faces_in(const BlockRange& range) {
  std::uint64_t count = 0;
  Quads::for_quads_in(range, [&](const Quad&) { ++count; });
  return count;
}

/// Boundaries that have the volume on both sides are given back to the interfaces.
std::vector<BoundaryFace> take_internal(ZoneMesh& mesh, Quads& surface) {
  std::vector<BoundaryFace> internal;
  std::erase_if(mesh.boundary_faces, [&](const BoundaryFace& face) {
    bool is_internal = true;
    Quads::for_quads_in(face.range, [&](const Quad& quad) {
      const std::int64_t twin = surface.twin(quad);
      is_internal = is_internal && twin >= 0 && !surface.is_taken(twin);
    });
    if (!is_internal) return false;
    Quads::for_quads_in(face.range, [&](const Quad& quad) { surface.leave(quad); });
    internal.push_back(face);
    return true;
  });
  return internal;
}

/// The largest interface that begins with a face and its twin.
Interface interface_at(const Quads& surface, const Quad& quad) {
  Interface best;
  std::uint64_t most = 0;
  for (const auto& turn : kTurns) {
    auto found = meet(surface, quad, surface.quad(surface.twin(quad)), turn);
    if (!found) continue;
    Growth(surface, *found).run();
    const std::uint64_t size = faces_in(found->first);
    if (size > most) best = *found;
    most = std::max(most, size);
  }
  return best;
}

/// Interfaces of the faces of `range` that are free yet.
void connect(ZoneMesh& mesh, Quads& surface, const BlockRange& range, const std::string& name) {
  Quads::for_quads_in(range, [&](const Quad& quad) {
    if (!surface.is_free(quad)) return;
    Interface found = interface_at(surface, quad);
    if (found.first.block < 0) return;
    found.name = name;
    const auto take = [&](const Quad& one) { surface.take(one); };
    Quads::for_quads_in(found.first, take);
    Quads::for_quads_in(found.second, take);
    mesh.interfaces.push_back(std::move(found));
  });
}

}  // namespace

void find_interfaces(ZoneMesh& mesh) {
  Quads surface(mesh);
  for (const BoundaryFace& face : mesh.boundary_faces) {
    Quads::for_quads_in(face.range, [&](const Quad& quad) { surface.take(quad); });
  }
  for (const BoundaryFace& face : take_internal(mesh, surface)) {
    connect(mesh, surface, face.range, face.name);
  }
  std::vector<Quad> quads;
  surface.for_quads([&](const Quad& quad) {
    if (surface.is_free(quad)) quads.push_back(quad);
  });
  for (const Quad& quad : quads) {
    BlockRange one{quad.zone, quad.face, quad.at, quad.at};
    for (const std::size_t a : axes_along(quad.face)) ++one.end[a];
    connect(mesh, surface, one, {});
  }
}

}  // namespace vdb_offset
