#include "vdb_offset/surface/open_gaps.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <set>
#include <utility>
#include <vector>

#include "surface/facing_sides.h"
#include "surface/joined_cells.h"
#include "surface/point_tree.h"
#include "surface/segments.h"

namespace vdb_offset {
namespace {

constexpr double kMost = 0.5;  // tolerances are below

std::size_t at(int n) { return static_cast<std::size_t>(n); }

/// Nodes of free edges.
struct OpenRim {
  std::vector<std::array<int, 2>> edges;  // of nodes
  std::map<int, std::size_t> number;      // of each node below
  std::vector<int> nodes;
  std::vector<int> body;
  Vec3List places;
  std::vector<double> spacing;  // shortest edge at each
};

void add_edges(const Surface& surface, OpenRim& rim) {
  for (const Edge& edge : surface.topology.edges) {
    if (edge.kind != EdgeKind::Free) continue;
    for_segments(surface, edge, [&](int a, int b) {
      if (std::max(a, b) >= surface.wall_nodes) return;
      rim.edges.push_back({a, b});
      for (const int n : {a, b}) {
        if (!rim.number.try_emplace(n, rim.nodes.size()).second) continue;
        rim.nodes.push_back(n);
        rim.body.push_back(surface.patches[at(edge.first.patch)].body);
        rim.places.push_back(surface.nodes_world[at(n)]);
      }
    });
  }
}

void measure_spacing(const Surface& surface, OpenRim& rim) {
  rim.spacing.assign(rim.nodes.size(), std::numeric_limits<double>::infinity());
  for (std::size_t p = 0; p < surface.patches.size(); ++p) {
    for_edges(surface.patches[p], [&](int a, int b) {
      const double length =
          (surface.patches[p].points_world[at(a)] - surface.patches[p].points_world[at(b)]).norm();
      if (length <= 0) return;
      for (const int point : {a, b}) {
        const auto found = rim.number.find(surface.patch_nodes[p][at(point)]);
        if (found == rim.number.end()) continue;
        double& spacing = rim.spacing[found->second];
        spacing = std::min(spacing, length);
      }
    });
  }
}

/// What a node is joined to, and the tolerance that does it; infinite: none below 0.5.
struct Partner {
  int node = -1;
  double needed = std::numeric_limits<double>::infinity();
};

/// Not across an open end of something thin.
std::vector<Partner> partners(const Surface& surface, const OpenRim& rim, double weld) {
  std::vector<FacingSides::Cell> cells;
  for_joined_cells(surface, [&](int, const FacingSides::Cell& cell) { cells.push_back(cell); });
  const FacingSides sides(std::move(cells), surface.nodes_world, FacingSides::Oriented::No);
  const auto place = [&](std::size_t n) {
    return static_cast<int>(surface.stands_at(at(rim.nodes[n])));
  };
  const PointTree tree(rim.places);
  std::vector<Partner> nearest(rim.nodes.size());
  std::vector<PointTree::Found> found;
  for (std::size_t n = 0; n < rim.nodes.size(); ++n) {
    const double reach = kMost * rim.spacing[n];
    if (!std::isfinite(reach)) continue;
    tree.within(rim.places[n], reach, found);
    for (const auto& [other, distance2] : found) {
      if (other == n || rim.body[other] != rim.body[n]) continue;
      const double needed = std::sqrt(distance2) / std::min(rim.spacing[n], rim.spacing[other]);
      if (needed < weld || needed >= nearest[n].needed) continue;
      if (sides.face_each_other(place(n), place(other))) continue;
      nearest[n] = {rim.nodes[other], needed};
    }
  }
  return nearest;
}

/// Of two digits, and a little above: distances are rounded, too.
double rounded_up(double tolerance) {
  const double unit = std::pow(10, std::floor(std::log10(tolerance)) - 1);
  return std::min(std::ceil(1.01 * tolerance / unit) * unit, 0.49999);
}

}  // namespace

OpenGaps open_gaps(const Surface& surface, double weld) {
  OpenGaps gaps;
  if (surface.flat) return gaps;
  OpenRim rim;
  add_edges(surface, rim);
  if (rim.edges.empty()) return gaps;
  measure_spacing(surface, rim);
  const std::vector<Partner> nearest = partners(surface, rim, weld);
  const std::set<std::array<int, 2>> edges(rim.edges.begin(), rim.edges.end());
  // Of an edge, by what its ends are joined to; one end may be where a gap begins.
  const auto joins = [&](int from, int to) {
    const Partner& start = nearest[rim.number.at(from)];
    const Partner& end = nearest[rim.number.at(to)];
    const bool is_tip = edges.contains({from, end.node}) || edges.contains({end.node, from});
    return is_tip ? end.needed : std::max(start.needed, end.needed);
  };
  double first = kMost;
  double last = 0;
  for (const auto& [a, b] : rim.edges) {
    const double needed = std::min(joins(a, b), joins(b, a));
    if (!(needed < kMost) || !(needed > 0)) continue;
    ++gaps.edges;
    last = std::max(last, needed);
    if (needed >= first) continue;
    first = needed;
    gaps.first_world = {surface.nodes_world[at(a)], surface.nodes_world[at(b)]};
  }
  if (gaps.edges == 0) return gaps;
  gaps.weld_first = rounded_up(first);
  gaps.weld_all = rounded_up(last);
  return gaps;
}

}  // namespace vdb_offset
