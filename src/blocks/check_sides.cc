// What the march and the repair promise, counted, so that nothing of it is broken without a word.

#include "vdb_offset/blocks/check_sides.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>
#include <utility>

#include "blocks/window.h"
#include "core/parallel.h"

namespace vdb_offset {
namespace {

constexpr std::size_t kGrain = 64;     // columns, faces
constexpr double kSameNormal = 1e-12;  // of unit normals, and parts of lengths

std::size_t at(int index) { return static_cast<std::size_t>(index); }

/// The sums of parts, in their order.
Astray add_up(const std::string& name, const std::vector<Astray>& parts) {
  Astray sum;
  sum.name = name;
  for (const Astray& part : parts) {
    if (part.count == 0) continue;
    if (sum.count == 0) sum.place_world = part.place_world;
    sum.count += part.count;
    sum.farthest_world = std::max(sum.farthest_world, part.farthest_world);
  }
  return sum;
}

/// The boundaries that lie in one plane with another: points beyond them are the nearest's.
std::vector<Vec3> places_beside(const std::vector<Boundary>& list, const Boundary& boundary) {
  std::vector<Vec3> places;
  for (const Boundary& other : list) {
    if (&other == &boundary || !other.is_plane() || !boundary.is_plane()) continue;
    if ((other.plane().normal - boundary.plane().normal).norm() > kSameNormal) continue;
    const Vec3 apart = other.plane().point_world - boundary.plane().point_world;
    if (std::abs(apart.dot(boundary.plane().normal)) > kSameNormal * apart.norm()) continue;
    places.push_back(other.plane().point_world);
  }
  return places;
}

/// Points of one column beyond a boundary.
Astray beyond(const Boundary& boundary, const std::vector<Vec3>& beside, const Layers& layers,
              int node) {
  Astray found;
  const double near = kBeyond * layers.distance_world;
  const double foot = std::min(0.0, boundary.side(layers.at(node, 0)));
  for (int k = 1; k < layers.levels(); ++k) {
    const double side = boundary.side(layers.at(node, k));
    if (!(side < foot - near)) continue;
    const Vec3 off = layers.at(node, k) - boundary.plane().point_world;
    if (std::ranges::any_of(beside, [&](const Vec3& other) {
          return (layers.at(node, k) - other).norm() < off.norm();
        })) {
      continue;
    }
    if (found.count++ == 0) found.place_world = layers.at(node, k);
    found.farthest_world = std::max(found.farthest_world, -side);
  }
  return found;
}

/// Points of one column that marches on a boundary, where that has ended: it goes on as a plane.
Astray past_rim(const Boundary& boundary, const Layers& layers, int node) {
  Astray found;
  if (boundary.is_plane()) return found;
  for (int k = 0; k < layers.levels(); ++k) {
    const Vec3& point = layers.at(node, k);
    const double off = boundary.side(point);
    if (!(off > kBeyond * layers.distance_world) || boundary.covers(point)) continue;
    if (found.count++ == 0) found.place_world = point;
    found.farthest_world = std::max(found.farthest_world, off);
  }
  return found;
}

/// Where the first edge of a cell is cut: of the face below it, and its columns, and above.
class Cuts {
 public:
  Cuts(const Boundary& boundary, const Layers& layers) : boundary_(boundary), layers_(layers) {}

  Astray over(const ColumnFace& face) const {
    Astray found;
    std::optional<Vec3> below = in_level(face, 0);
    for (int k = 0; k + 1 < layers_.levels(); ++k) {
      const std::optional<Vec3> above = in_level(face, k + 1);
      std::optional<Vec3> cut = below ? below : above;
      for (std::size_t c = 0; c < face.count && !cut; ++c) {
        cut = edge(layers_.at(face.column[c], k), layers_.at(face.column[c], k + 1));
      }
      if (cut && found.count++ == 0) found.place_world = *cut;
      below = above;
    }
    return found;
  }

 private:
  std::optional<Vec3> in_level(const ColumnFace& face, int k) const {
    for (std::size_t c = 0; c < face.count; ++c) {
      const auto cut = edge(layers_.at(face.column[c], k), layers_.at(face.next(c), k));
      if (cut) return cut;
    }
    return {};
  }

  std::optional<Vec3> edge(const Vec3& from, const Vec3& to) const {
    if (!boundary_.parts(from, to)) return {};
    const auto part = boundary_.crossing(from, to);
    return part ? Vec3(from + *part * (to - from)) : from;
  }

  const Boundary& boundary_;
  const Layers& layers_;
};

/// The sum of of(n), n < count.
template <typename Of>
Astray sum_of(const std::string& name, std::size_t count, const Of& of) {
  std::vector<Astray> parts(count);
  parallel::for_ranges(count, kGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t n = begin; n < end; ++n) parts[n] = of(n);
  });
  return add_up(name, parts);
}

void keep(Astray found, std::vector<Astray>& list) {
  if (found.count > 0) list.push_back(std::move(found));
}

}  // namespace

SidesReport check_sides(const Surface& surface, const MultiBlock& mesh, const Progress& progress) {
  SidesReport report;
  if (!surface.boundaries || surface.boundaries->empty()) return report;
  const Layers& layers = mesh.layers;
  const ColumnGraph graph(mesh);
  for (std::size_t b = 0; b < surface.boundaries->list().size(); ++b) {
    progress.check();
    const Boundary& boundary = surface.boundaries->list()[b];
    if (boundary.is_internal()) {
      const Cuts cuts(boundary, layers);
      const auto over = [&](std::size_t f) { return cuts.over(graph.faces[f]); };
      keep(sum_of(boundary.name(), graph.faces.size(), over), report.cut);
      continue;
    }
    const auto of_nodes = [&](bool on, const auto& of) {
      return sum_of(boundary.name(), at(mesh.nodes()), [&](std::size_t n) {
        const bool is_on = (surface.boundaries_of(n) >> b & 1U) != 0;
        return is_on == on ? of(boundary, layers, static_cast<int>(n)) : Astray{};
      });
    };
    const std::vector<Vec3> beside = places_beside(surface.boundaries->list(), boundary);
    const auto beyond_this = [&](const Boundary& of, const Layers& columns, int node) {
      return beyond(of, beside, columns, node);
    };
    keep(of_nodes(false, beyond_this), report.beyond);
    keep(of_nodes(true, past_rim), report.past);
  }
  return report;
}

}  // namespace vdb_offset
