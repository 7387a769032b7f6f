#include "surface/curve_tails.h"

#include <map>

#include "core/sets.h"

namespace vdb_offset {

namespace {

constexpr double kTail = 0.2;  // of a curve's size

Vec3 in_plane(const Vec3& p) { return {p.x(), p.y(), 0}; }

/// Nodes of cells that hang together; the box of each, by its root.
std::map<int, Box> join_cells(const OpenSurface& surface, Sets& sets) {
  for (std::size_t p = 0; p < surface.grids.patches.size(); ++p) {
    const std::vector<int>& nodes = surface.grids.nodes[p];
    for (const int n : nodes) sets.join(n, nodes.front());
  }
  std::map<int, Box> boxes;
  for (std::size_t n = 0; n < surface.nodes_world.size(); ++n) {
    boxes[sets.root(static_cast<int>(n))].add(in_plane(surface.nodes_world[n]));
  }
  return boxes;
}

}  // namespace

std::vector<std::array<Vec3, 2>> leave_open_tails(const OpenSurface& surface, PlaneFinder& finder) {
  Sets sets(surface.nodes_world.size());
  const std::map<int, Box> boxes = join_cells(surface, sets);
  std::map<int, std::vector<FreeEdge*>> ends;  // of each curve
  for (FreeEdge& edge : finder.edges()) {
    const bool is_across =
        in_plane(finder.node(edge.a) - finder.node(edge.b)).norm() <= finder.tolerance();
    if (is_across) ends[sets.root(edge.a)].push_back(&edge);
  }
  std::vector<std::array<Vec3, 2>> tails;
  for (const auto& [root, of_curve] : ends) {
    if (of_curve.size() != 2) continue;
    FreeEdge& a = *of_curve[0];
    FreeEdge& b = *of_curve[1];
    const std::array<Vec3, 2> places{in_plane(finder.node(a.a)), in_plane(finder.node(b.a))};
    const Vec3 gap = places[1] - places[0];
    const bool is_body = gap.dot(a.normal - b.normal) < 0;
    if (a.taken || b.taken || !is_body || gap.norm() > kTail * boxes.at(root).size()) continue;
    a.taken = b.taken = true;
    tails.push_back(places);
  }
  return tails;
}

}  // namespace vdb_offset
