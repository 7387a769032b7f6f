// At a free edge every direction between the wall's normal and the way on along the wall is that of
// a gradient line of the distance: the edge itself is nearest to what lies past it. A column may
// lean there as it likes. Those beside follow, less and less, or the last row of cells would take
// up all of the fan: over kSplayReach = 2 distances the outer level is stretched by a factor of
// about 1 + 1.5 tan(30 degrees) / 2 = 1.43, with lengths that change smoothly.
//
// Free edges are taken in chains that turn by less than 30 degrees. Each asks a node for a lean
// w t tan(splay) along its own way out t, w falling from 1 at the edge to 0. A node grants them in
// the least squares sense, sum of w^2 ((v, t) - w tan(splay))^2: between opposite edges they
// cancel, and at a corner of two chains the column leans as much across either as the ones beside.

#include "march/lean.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>

#include "march/room.h"

namespace vdb_offset {

namespace {

constexpr double kSameChain = 0.866;  // cosine between the ways out of edges of one chain
constexpr double kFaint = 0.01;       // squared weight of what fades out

std::size_t at(int index) { return static_cast<std::size_t>(index); }

struct OpenEdge {
  int a, b;
  Vec3 out;  // unit, in the wall and away from it, upright on the edge
  std::size_t component;
};

bool tapers(const Surface& surface, int node) {
  const std::size_t stands = surface.stands_at(at(node)) % at(surface.wall_nodes);
  return std::ranges::binary_search(surface.taper_nodes, static_cast<int>(stands));
}

/// Nodes of a side of a grid, and of the grid lines beside it.
int side_node(const Surface& surface, const SideRange& side, int s, int in) {
  const Patch& patch = surface.patches[at(side.patch)];
  switch (side.side) {
    case Side::IMin:
      return surface.node(side.patch, in, s);
    case Side::IMax:
      return surface.node(side.patch, patch.ni - 1 - in, s);
    case Side::JMin:
      return surface.node(side.patch, s, in);
    case Side::JMax:
      break;
  }
  return surface.node(side.patch, s, patch.nj - 1 - in);
}

/// Two nodes of a side, and twice the way into the cell between them.
struct SideStep {
  int a, b;
  Vec3 in;
};

SideStep side_step(const Surface& surface, const SideRange& side, int s) {
  const Patch& patch = surface.patches[at(side.patch)];
  const auto point = [&](int n) { return surface.nodes_world[at(n)]; };
  if (patch.is_grid()) {
    const int a = side_node(surface, side, s, 0);
    const int b = side_node(surface, side, s + 1, 0);
    return {a, b,
            point(side_node(surface, side, s, 1)) + point(side_node(surface, side, s + 1, 1)) -
                point(a) - point(b)};
  }
  const std::vector<int>& nodes = surface.patch_nodes[at(side.patch)];
  const int a = nodes[at(patch.rim.points[at(s)])];
  const int b = nodes[at(patch.rim.points[at(s + 1)])];
  Vec3 in = Vec3::Zero();
  for (const int corner : patch.faces[at(patch.rim.faces[at(s)])]) {
    in += point(nodes[at(corner)]) - 0.5 * (point(a) + point(b));
  }
  return {a, b, in};
}

/// The grid edges of one free side, but those that have no length and those that taper.
void add_edges(const Surface& surface, const Edge& side, std::vector<OpenEdge>& edges) {
  const auto point = [&](int n) { return surface.nodes_world[at(n)]; };
  for (int s = side.first.begin; s < side.first.end; ++s) {
    const auto [a, b, in] = side_step(surface, side.first, s);
    const Vec3 along = (point(b) - point(a)).normalized();
    const Vec3 out = in.dot(along) * along - in;
    if (!(along.norm() > 0 && out.norm() > 0) || (tapers(surface, a) && tapers(surface, b)))
      continue;
    const auto component = at(surface.topology.component[at(side.first.patch)]);
    edges.push_back({a, b, out.normalized(), component});
  }
}

using Chain = std::vector<OpenEdge>;

/// Edges that meet in a node and go on smoothly there, together.
std::vector<Chain> chains_of(const std::vector<OpenEdge>& edges) {
  std::vector<std::size_t> parent(edges.size());
  std::iota(parent.begin(), parent.end(), 0U);
  const auto root = [&](std::size_t e) {
    while (parent[e] != e) e = parent[e] = parent[parent[e]];
    return e;
  };
  std::map<int, std::vector<std::size_t>> at_node;
  for (std::size_t e = 0; e < edges.size(); ++e) {
    for (const int n : {edges[e].a, edges[e].b}) {
      for (const std::size_t other : at_node[n]) {
        if (edges[e].out.dot(edges[other].out) > kSameChain) parent[root(e)] = root(other);
      }
      at_node[n].push_back(e);
    }
  }
  std::map<std::size_t, Chain> chains;
  for (std::size_t e = 0; e < edges.size(); ++e) chains[root(e)].push_back(edges[e]);
  std::vector<Chain> list;
  for (auto& [first, chain] : chains) list.push_back(std::move(chain));
  return list;
}

/// Of each component, the farthest that one can be from a free edge: a sheet that is narrower than
/// the reach leans over all of its half width.
std::vector<double> half_widths(const Surface& surface, const Links& links,
                                const std::vector<OpenEdge>& edges) {
  std::vector<std::size_t> component(surface.nodes_world.size());
  for (std::size_t p = 0; p < surface.patches.size(); ++p) {
    for (const int n : surface.patch_nodes[p]) component[at(n)] = at(surface.topology.component[p]);
  }
  std::vector<int> nodes;
  for (const OpenEdge& edge : edges) nodes.insert(nodes.end(), {edge.a, edge.b});
  std::vector<double> widths(at(surface.topology.components), 0);
  for (const Way& way : ways_from(links, nodes, std::numeric_limits<double>::infinity())) {
    double& width = widths[component[at(way.node)]];
    width = std::max(width, way.length_world);
  }
  return widths;
}

/// What the nodes are asked for: sums of w^2 t t' and w^3 t.
struct Wish {
  Eigen::Matrix3d matrix = Eigen::Matrix3d::Zero();
  Vec3 vector = Vec3::Zero();
};

void ask(const Chain& chain, const std::vector<Way>& ways, double reach,
         std::map<int, Wish>& wishes) {
  std::map<int, Vec3> out;
  for (const OpenEdge& edge : chain) {
    for (const int n : {edge.a, edge.b}) out.try_emplace(n, Vec3::Zero()).first->second += edge.out;
  }
  for (const Way& way : ways) {
    const double part = 1 - way.length_world / reach;
    const double weight = part * part * (3 - 2 * part);
    const Vec3 towards = out.at(way.from).normalized();
    Wish& wish = wishes[way.node];
    wish.matrix += weight * weight * towards * towards.transpose();
    wish.vector += weight * weight * weight * towards;
  }
}

}  // namespace

Vec3List lean(const Surface& surface, const MarchOptions& options, double distance_world) {
  std::vector<OpenEdge> edges;
  for (const Edge& side : surface.topology.edges) {
    if (side.kind == EdgeKind::Free && side.boundary < 0) add_edges(surface, side, edges);
  }
  if (edges.empty() || options.splay == 0) return {};
  const Links links = links_of(surface);
  const std::vector<double> widths = half_widths(surface, links, edges);
  std::map<int, Wish> wishes;
  for (const Chain& chain : chains_of(edges)) {
    std::vector<int> nodes;
    for (const OpenEdge& edge : chain) nodes.insert(nodes.end(), {edge.a, edge.b});
    const double width = widths[chain.front().component];
    const double farthest = kSplayReach * distance_world;
    const double reach = width > 0 ? std::min(farthest, width) : farthest;
    ask(chain, ways_from(links, nodes, reach), reach, wishes);
  }
  Vec3List result(surface.nodes_world.size(), Vec3::Zero());
  for (const auto& [node, wish] : wishes) {
    const Eigen::Matrix3d matrix = wish.matrix + kFaint * Eigen::Matrix3d::Identity();
    result[at(node)] = (1 + kFaint) * std::tan(options.splay) * matrix.ldlt().solve(wish.vector);
  }
  return result;
}

}  // namespace vdb_offset
