#include "surface/polygon_patch.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <numeric>
#include <tuple>
#include <utility>

#include "core/parallel.h"

namespace vdb_offset {
namespace {

std::size_t at(int index) { return static_cast<std::size_t>(index); }

/// The corners that differ, in order, the last twice where there are three; false if there are
/// fewer, or if the face touches itself.
bool tidy(std::array<int, 4>& face) {
  std::array<int, 4> corners{};
  std::size_t count = 0;
  for (std::size_t c = 0; c < 4; ++c) {
    if (face[c] != face[(c + 1) % 4]) corners[count++] = face[c];
  }
  if (count < 3 || (count == 4 && (face[0] == face[2] || face[1] == face[3]))) return false;
  if (count == 3) corners[3] = corners[2];
  face = corners;
  return true;
}

void merge_points(Patch& patch, std::vector<int>& nodes) {
  std::vector<int> order(nodes.size());
  std::iota(order.begin(), order.end(), 0);
  parallel::sort(order.begin(), order.end(), [&](int a, int b) {
    return std::tuple(nodes[at(a)], a) < std::tuple(nodes[at(b)], b);
  });
  std::vector<int> first(nodes.size());  // of the points of the same node
  for (std::size_t n = 0; n < order.size(); ++n) {
    const bool is_same = n > 0 && nodes[at(order[n])] == nodes[at(order[n - 1])];
    first[at(order[n])] = is_same ? first[at(order[n - 1])] : order[n];
  }
  std::vector<int> used(nodes.size(), 0);
  for (std::array<int, 4>& face : patch.faces) {
    for (int& corner : face) corner = first[at(corner)];
    if (!tidy(face)) face.fill(-1);
  }
  std::erase_if(patch.faces, [](const std::array<int, 4>& face) { return face[0] < 0; });
  for (const std::array<int, 4>& face : patch.faces) {
    for (const int corner : face) used[at(corner)] = 1;
  }
  int count = 0;
  for (std::size_t n = 0; n < used.size(); ++n) {
    if (used[n] == 0) continue;
    patch.points_world[at(count)] = patch.points_world[n];
    nodes[at(count)] = nodes[n];
    used[n] = count++;
  }
  patch.points_world.resize(at(count));
  nodes.resize(at(count));
  patch.ni = count;
  for (std::array<int, 4>& face : patch.faces) {
    for (int& corner : face) corner = used[at(corner)];
  }
}

/// An edge as its face runs along it.
struct FaceEdge {
  int from, to, face;

  std::pair<int, int> ends() const { return std::minmax({from, to}); }
};

/// Edges of one face alone, by where they begin.
std::vector<FaceEdge> rim_edges(const Patch& patch) {
  std::vector<FaceEdge> edges;
  for (std::size_t f = 0; f < patch.faces.size(); ++f) {
    const std::array<int, 4>& face = patch.faces[f];
    for (std::size_t c = 0; c < 4; ++c) {
      if (face[c] == face[(c + 1) % 4]) continue;
      edges.push_back({face[c], face[(c + 1) % 4], static_cast<int>(f)});
    }
  }
  parallel::sort(edges.begin(), edges.end(), [](const FaceEdge& a, const FaceEdge& b) {
    return std::tuple(a.ends(), a.face) < std::tuple(b.ends(), b.face);
  });
  std::vector<FaceEdge> rim;
  for (std::size_t e = 0; e < edges.size();) {
    std::size_t last = e + 1;
    while (last < edges.size() && edges[last].ends() == edges[e].ends()) ++last;
    if (last == e + 1) rim.push_back(edges[e]);
    e = last;
  }
  std::ranges::sort(rim, {}, [](const FaceEdge& e) { return std::tuple(e.from, e.to); });
  return rim;
}

/// Chains rim edges, each behind one that ends where it begins.
Rim find_rim(const Patch& patch) {
  const std::vector<FaceEdge> edges = rim_edges(patch);
  std::vector<char> taken(edges.size(), 0);
  const auto next_from = [&](int point) {
    auto e = std::ranges::lower_bound(edges, point, {}, &FaceEdge::from);
    while (e != edges.end() && e->from == point && taken[at(static_cast<int>(e - edges.begin()))]) {
      ++e;
    }
    return e != edges.end() && e->from == point ? e : edges.end();
  };
  Rim rim;
  for (auto first = edges.begin(); first != edges.end(); ++first) {
    if (taken[at(static_cast<int>(first - edges.begin()))] != 0) continue;
    if (!rim.points.empty()) {
      rim.points.push_back(-1);
      rim.faces.push_back(-1);
    }
    rim.points.push_back(first->from);
    for (auto e = first; e != edges.end(); e = next_from(e->to)) {
      taken[at(static_cast<int>(e - edges.begin()))] = 1;
      rim.points.push_back(e->to);
      rim.faces.push_back(e->face);
      if (e->to == first->from) break;
    }
    rim.faces.push_back(-1);
  }
  return rim;
}

}  // namespace

void settle_polygons(Patch& patch, std::vector<int>& nodes) {
  merge_points(patch, nodes);
  patch.rim = find_rim(patch);
}

}  // namespace vdb_offset
