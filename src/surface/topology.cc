// Guibault, Un mailleur hybride structure/non structure en trois dimensions, 1998, as summed up in
// section 4.5 of Wang, Guibault, Camarero: edges are runs of grid edges with one pair of users.

#include "surface/topology.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <tuple>

#include "surface/orient.h"
#include "vdb_offset/core/error.h"

namespace vdb_offset {

int side_points(const Patch& patch, Side side) {
  if (!patch.is_grid()) return side == Side::JMin ? static_cast<int>(patch.rim.points.size()) : 0;
  return side == Side::IMin || side == Side::IMax ? patch.nj : patch.ni;
}

/// Point index within the patch of point `s` along a side.
int side_point(const Patch& patch, Side side, int s) {
  if (!patch.is_grid()) return patch.rim.points[static_cast<std::size_t>(s)];
  switch (side) {
    case Side::IMin:
      return s * patch.ni;
    case Side::IMax:
      return s * patch.ni + patch.ni - 1;
    case Side::JMin:
      return s;
    case Side::JMax:
      break;
  }
  return (patch.nj - 1) * patch.ni + s;
}

namespace {

constexpr std::array<Side, 4> kSides{Side::IMin, Side::IMax, Side::JMin, Side::JMax};

/// One grid edge on a patch side.
struct SideEdge {
  int lo, hi;  // nodes
  int patch;
  Side side;
  int at;        // between points at and at + 1
  bool forward;  // from lo to hi

  auto order() const { return std::tie(lo, hi, patch, side, at); }
  auto where() const { return std::tie(patch, side, at); }
};

/// Whether the points s and s + 1 of a side are of one loop.
bool is_side_edge(const Patch& patch, int s) {
  return patch.is_grid() || patch.rim.faces[static_cast<std::size_t>(s)] >= 0;
}

std::vector<SideEdge> side_edges(const Patches& patches,
                                 const std::vector<std::vector<int>>& nodes) {
  std::vector<SideEdge> edges;
  for (std::size_t p = 0; p < patches.size(); ++p) {
    for (const Side side : kSides) {
      for (int s = 0; s + 1 < side_points(patches[p], side); ++s) {
        if (!is_side_edge(patches[p], s)) continue;
        const auto node = [&](int t) {
          return nodes[p][static_cast<std::size_t>(side_point(patches[p], side, t))];
        };
        const int a = node(s);
        const int b = node(s + 1);
        edges.push_back({std::min(a, b), std::max(a, b), static_cast<int>(p), side, s, a < b});
      }
    }
  }
  return edges;
}

/// What a grid edge is to a run: its kind, and for an interface its partner edge.
struct Use {
  SideEdge edge;
  EdgeKind kind;
  SideEdge partner;
  bool reversed;  // the partner's index runs the other way
  int boundary = -1;
};

std::vector<Use> pair_up(const Patches& patches, std::vector<SideEdge> edges) {
  std::sort(edges.begin(), edges.end(),
            [](const SideEdge& a, const SideEdge& b) { return a.order() < b.order(); });
  std::vector<Use> uses;
  for (std::size_t first = 0; first < edges.size();) {
    std::size_t last = first + 1;
    while (last < edges.size() && edges[last].lo == edges[first].lo &&
           edges[last].hi == edges[first].hi) {
      ++last;
    }
    const SideEdge& e = edges[first];
    if (e.lo == e.hi) {
      for (std::size_t u = first; u < last; ++u) {
        uses.push_back({edges[u], EdgeKind::Degenerate, edges[u], false});
      }
    } else if (last - first == 1) {
      uses.push_back({e, EdgeKind::Free, e, false});
    } else if (last - first == 2) {
      const SideEdge& f = edges[first + 1];
      uses.push_back({e, EdgeKind::Interface, f, e.forward != f.forward});
      uses.push_back({f, EdgeKind::Interface, e, e.forward != f.forward});
    } else {
      const Patch& patch = patches[static_cast<std::size_t>(e.patch)];
      const int point = side_point(patch, e.side, e.at);
      throw InputError(
          fmt::format("the surface is not a manifold: {} patch sides share the edge at {}",
                      last - first, place(patch, e.patch, point % patch.ni, point / patch.ni)),
          {e.patch});
    }
    first = last;
  }
  std::sort(uses.begin(), uses.end(),
            [](const Use& a, const Use& b) { return a.edge.where() < b.edge.where(); });
  return uses;
}

/// An edge lies on the first boundary that both its nodes lie on; inside the wall that is an
/// internal one.
void find_boundaries_of(std::vector<Use>& uses, const std::vector<BoundarySet>& on) {
  for (Use& use : uses) {
    const BoundarySet both =
        on[static_cast<std::size_t>(use.edge.lo)] & on[static_cast<std::size_t>(use.edge.hi)];
    const bool is_edge = use.kind == EdgeKind::Free || use.kind == EdgeKind::Interface;
    if (is_edge && both != 0) use.boundary = std::countr_zero(both);
  }
}

bool leads(const Use& use) { return use.edge.where() < use.partner.where(); }

/// True when `next` continues the run that ends with `last`.
bool continues(const Use& last, const Use& next) {
  if (next.edge.patch != last.edge.patch || next.edge.side != last.edge.side) return false;
  if (next.edge.at != last.edge.at + 1) return false;
  if (next.kind != last.kind) return false;
  if (next.kind != EdgeKind::Interface) return next.boundary == last.boundary;
  if (next.boundary != last.boundary) return false;
  const int step = next.reversed ? -1 : 1;
  return next.partner.patch == last.partner.patch && next.partner.side == last.partner.side &&
         next.reversed == last.reversed && next.partner.at == last.partner.at + step &&
         leads(next) == leads(last);
}

Edge make_edge(const Use& first, const Use& last) {
  Edge edge;
  edge.kind = first.kind;
  edge.boundary = first.boundary;
  edge.first = {first.edge.patch, first.edge.side, first.edge.at, last.edge.at + 1};
  if (first.kind == EdgeKind::Interface) {
    edge.second = {first.partner.patch, first.partner.side,
                   first.reversed ? first.partner.at + 1 : first.partner.at,
                   first.reversed ? last.partner.at : last.partner.at + 1};
  }
  return edge;
}

}  // namespace

Topology build_topology(const Patches& patches, const std::vector<std::vector<int>>& nodes,
                        const std::vector<BoundarySet>& on) {
  std::vector<Use> uses = pair_up(patches, side_edges(patches, nodes));
  if (!on.empty()) find_boundaries_of(uses, on);
  Topology topology;
  for (std::size_t first = 0; first < uses.size();) {
    std::size_t last = first;
    while (last + 1 < uses.size() && continues(uses[last], uses[last + 1])) ++last;
    if (uses[first].kind != EdgeKind::Interface || leads(uses[first])) {
      topology.edges.push_back(make_edge(uses[first], uses[last]));
    }
    first = last + 1;
  }
  const auto node = [&](const SideRange& range, int s) {
    const auto p = static_cast<std::size_t>(range.patch);
    return nodes[p][static_cast<std::size_t>(side_point(patches[p], range.side, s))];
  };
  std::vector<int>& vertices = topology.vertices;
  for (const Edge& edge : topology.edges) {
    vertices.push_back(node(edge.first, edge.first.begin));
    vertices.push_back(node(edge.first, edge.first.end));
  }
  std::sort(vertices.begin(), vertices.end());
  vertices.erase(std::unique(vertices.begin(), vertices.end()), vertices.end());
  for (Edge& edge : topology.edges) {
    const auto find = [&](int n) {
      return static_cast<int>(std::lower_bound(vertices.begin(), vertices.end(), n) -
                              vertices.begin());
    };
    edge.vertices = {find(node(edge.first, edge.first.begin)),
                     find(node(edge.first, edge.first.end))};
  }
  return topology;
}

}  // namespace vdb_offset
