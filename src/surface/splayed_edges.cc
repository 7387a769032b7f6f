#include "vdb_offset/surface/splayed_edges.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <map>

#include "surface/segments.h"

namespace vdb_offset {
namespace {

// A slit is narrower than this part of its length: a point on an edge is one to rounding in a file.
constexpr double kSlit = 1e-4;

/// `visit(a, b)`: the nodes of every free edge that splays.
template <typename Visit>
void for_splayed(const Surface& surface, const Visit& visit) {
  const auto tapers = [&](int n) { return std::ranges::binary_search(surface.taper_nodes, n); };
  for (const Edge& edge : surface.topology.edges) {
    if (edge.kind != EdgeKind::Free || edge.boundary >= 0) continue;
    for_segments(surface, edge, [&](int a, int b) {
      const auto stands = [&](int n) {
        return static_cast<int>(surface.stands_at(static_cast<std::size_t>(n))) %
               surface.wall_nodes;
      };
      if (!tapers(stands(a)) || !tapers(stands(b))) visit(a, b);
    });
  }
}

/// Drops those that are the rim of a face.
void drop_faces(const Surface& surface, std::map<std::array<int, 3>, SmallHole>& holes) {
  for (std::size_t p = 0; p < surface.patches.size() && !holes.empty(); ++p) {
    for_cells(surface.patches[p], [&](std::array<int, 4> c) {
      for (int& corner : c) corner = surface.patch_nodes[p][static_cast<std::size_t>(corner)];
      std::ranges::sort(c);
      if (std::unique(c.begin(), c.end()) - c.begin() == 3) holes.erase({c[0], c[1], c[2]});
    });
  }
}

bool is_slit(const std::array<Vec3, 3>& x) {
  double longest = 0;
  for (std::size_t c = 0; c < 3; ++c) longest = std::max(longest, (x[(c + 1) % 3] - x[c]).norm());
  return (x[1] - x[0]).cross(x[2] - x[0]).norm() < kSlit * longest * longest;
}

}  // namespace

SplayedEdges splayed_edges(const Surface& surface) {
  SplayedEdges found;
  std::map<int, std::vector<int>> next;  // of each node along free edges
  for_splayed(surface, [&](int a, int b) {
    const auto place = [&](int n) { return surface.nodes_world[static_cast<std::size_t>(n)]; };
    if (found.edges++ == 0) found.first_world = {place(a), place(b)};
    if (surface.flat || std::max(a, b) >= surface.wall_nodes) return;
    next[a].push_back(b);
    next[b].push_back(a);
  });
  std::map<std::array<int, 3>, SmallHole> holes;
  for (const auto& [a, ends] : next) {
    const int b = std::ranges::min(ends);
    const int c = std::ranges::max(ends);
    if (ends.size() != 2 || !(a < b && b < c)) continue;
    const auto& others = next.at(b);
    if (others.size() != 2 || next.at(c).size() != 2 || std::ranges::count(others, c) == 0)
      continue;
    const auto place = [&](int n) { return surface.nodes_world[static_cast<std::size_t>(n)]; };
    const std::array<Vec3, 3> corners{place(a), place(b), place(c)};
    holes[{a, b, c}] = {corners, is_slit(corners)};
  }
  drop_faces(surface, holes);
  for (const auto& [nodes, hole] : holes) found.small_holes.push_back(hole);
  return found;
}

}  // namespace vdb_offset
