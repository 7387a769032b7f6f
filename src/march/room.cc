// The values that are graded are the lower envelope of what each node allows its neighbours, which
// spreads outward from the lowest as distances do: Dijkstra, A note on two problems in connexion
// with graphs, 1959.

#include "march/room.h"

#include <algorithm>
#include <functional>
#include <limits>
#include <queue>
#include <utility>

namespace vdb_offset {

namespace {

/// Neighbours of each node along grid lines.
struct Links {
  std::vector<std::size_t> first;  // of each node, and the end
  std::vector<int> to;
};

template <typename Visit>
void for_edges(const Surface& surface, const Visit& visit) {
  for (std::size_t p = 0; p < surface.patches.size(); ++p) {
    const Patch& patch = surface.patches[p];
    for (int j = 0; j < patch.nj; ++j) {
      for (int i = 0; i < patch.ni; ++i) {
        const int n = surface.node(static_cast<int>(p), i, j);
        if (i + 1 < patch.ni) visit(n, surface.node(static_cast<int>(p), i + 1, j));
        if (j + 1 < patch.nj) visit(n, surface.node(static_cast<int>(p), i, j + 1));
      }
    }
  }
}

Links links_of(const Surface& surface) {
  Links links;
  const std::size_t nodes = surface.nodes_world.size();
  links.first.assign(nodes + 1, 0);
  for_edges(surface, [&](int a, int b) {
    ++links.first[static_cast<std::size_t>(a) + 1];
    ++links.first[static_cast<std::size_t>(b) + 1];
  });
  for (std::size_t n = 0; n < nodes; ++n) links.first[n + 1] += links.first[n];
  links.to.resize(links.first.back());
  std::vector<std::size_t> next(links.first.begin(), links.first.end() - 1);
  for_edges(surface, [&](int a, int b) {
    links.to[next[static_cast<std::size_t>(a)]++] = b;
    links.to[next[static_cast<std::size_t>(b)]++] = a;
  });
  return links;
}

}  // namespace

void grade(const Surface& surface, const Grading& grading, std::vector<double>& values) {
  const Links links = links_of(surface);
  using Entry = std::pair<double, int>;
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> lowest;
  for (std::size_t n = 0; n < values.size(); ++n) lowest.emplace(values[n], static_cast<int>(n));
  while (!lowest.empty()) {
    const auto [value, node] = lowest.top();
    lowest.pop();
    const auto at = static_cast<std::size_t>(node);
    if (value > values[at]) continue;
    for (std::size_t l = links.first[at]; l < links.first[at + 1]; ++l) {
      const auto other = static_cast<std::size_t>(links.to[l]);
      const double length = (surface.nodes_world[other] - surface.nodes_world[at]).norm();
      double most = std::numeric_limits<double>::infinity();
      if (value > 0) most = value * grading.ratio;
      // Nodes of a fan stand at one place: no slope there.
      if (grading.slope > 0 && length > 0) most = std::min(most, value + grading.slope * length);
      if (!(most < values[other])) continue;
      values[other] = most;
      lowest.emplace(most, links.to[l]);
    }
  }
}

}  // namespace vdb_offset
