#include "vdb_offset/surface/pierced.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cstddef>
#include <map>
#include <optional>

#include "surface/topology.h"

namespace vdb_offset {

namespace {

/// The free edges on one boundary, and the plane's own coordinates.
class OpeningRim {
 public:
  OpeningRim(const Surface& surface, int boundary)
      : surface_(surface),
        plane_(surface.boundaries->list()[static_cast<std::size_t>(boundary)].plane()),
        u_(plane_.normal.unitOrthogonal()),
        v_(plane_.normal.cross(u_)) {
    for (const Edge& edge : surface.topology.edges) {
      if (edge.kind == EdgeKind::Free && edge.boundary == boundary) add(edge.first);
    }
  }

  bool is_closed() const {
    std::map<int, int> uses;
    for (const auto& [a, b] : edges_) {
      ++uses[a];
      ++uses[b];
    }
    return !uses.empty() && std::ranges::all_of(uses, [](auto use) { return use.second == 2; });
  }

  /// Where one edge of the wall comes from beyond the plane, within the loops.
  std::optional<Vec3> passage(int below, int above) const {
    const double near = kOnPlane * surface_.wall->bounds().size();
    const double from = height(below);
    const double to = height(above);
    if (from >= -near || to < -near) return {};
    const double part = std::min(1.0, from / (from - to));
    const Vec3 place = node(below) + part * (node(above) - node(below));
    return holds(place) ? std::optional(place) : std::nullopt;
  }

 private:
  const Vec3& node(int n) const { return surface_.nodes_world[static_cast<std::size_t>(n)]; }
  double height(int n) const { return plane_.normal.dot(node(n) - plane_.point_world); }

  void add(const SideRange& range) {
    const auto p = static_cast<std::size_t>(range.patch);
    const auto node_of = [&](int s) {
      const int point = side_point(surface_.patches[p], range.side, s);
      return surface_.patch_nodes[p][static_cast<std::size_t>(point)];
    };
    for (int s = range.begin; s < range.end; ++s) edges_.push_back({node_of(s), node_of(s + 1)});
  }

  /// A ray along u passes an odd number of the edges.
  bool holds(const Vec3& place) const {
    bool is_in = false;
    for (const auto& [first, second] : edges_) {
      const Vec3 a = node(first) - place;
      const Vec3 b = node(second) - place;
      const double y = a.dot(v_);
      const double other = b.dot(v_);
      if ((y > 0) == (other > 0)) continue;
      is_in = is_in != ((a.dot(u_) * other - b.dot(u_) * y) / (other - y) > 0);
    }
    return is_in;
  }

  const Surface& surface_;
  const Plane plane_;
  const Vec3 u_, v_;
  std::vector<std::array<int, 2>> edges_;
};

std::optional<Vec3> first_passage(const Surface& surface, const OpeningRim& rim) {
  std::optional<Vec3> found;
  for (std::size_t p = 0; p < surface.patches.size() && !found; ++p) {
    const std::vector<int>& nodes = surface.patch_nodes[p];
    for_edges(surface.patches[p], [&](int a, int b) {
      const int from = nodes[static_cast<std::size_t>(a)];
      const int to = nodes[static_cast<std::size_t>(b)];
      if (!found) found = rim.passage(from, to);
      if (!found) found = rim.passage(to, from);
    });
  }
  return found;
}

}  // namespace

std::vector<PiercedOpening> find_pierced(const Surface& surface) {
  std::vector<PiercedOpening> pierced;
  if (!surface.boundaries || surface.flat) return pierced;
  const std::vector<Boundary>& list = surface.boundaries->list();
  for (std::size_t b = 0; b < list.size(); ++b) {
    if (!list[b].is_plane() || !list[b].is_local()) continue;
    const OpeningRim rim(surface, static_cast<int>(b));
    if (!rim.is_closed()) continue;
    if (const std::optional<Vec3> place = first_passage(surface, rim)) {
      pierced.push_back({static_cast<int>(b), *place});
    }
  }
  return pierced;
}

}  // namespace vdb_offset
