// The values that are graded are the lower envelope of what each node allows its neighbours, which
// spreads outward from the lowest as distances do: Dijkstra, A note on two problems in connexion
// with graphs, 1959.

#include "march/room.h"

#include <algorithm>
#include <functional>
#include <limits>
#include <queue>
#include <tuple>
#include <unordered_set>
#include <utility>

namespace vdb_offset {

namespace {

template <typename Visit>
void for_links(const Surface& surface, const Visit& visit) {
  for (std::size_t p = 0; p < surface.patches.size(); ++p) {
    const auto node = [&](int point) {
      return surface.patch_nodes[p][static_cast<std::size_t>(point)];
    };
    for_edges(surface.patches[p], [&](int a, int b) { visit(node(a), node(b)); });
  }
}

}  // namespace

Links links_of(const Surface& surface) {
  Links links;
  const std::size_t nodes = surface.nodes_world.size();
  links.first.assign(nodes + 1, 0);
  for_links(surface, [&](int a, int b) {
    ++links.first[static_cast<std::size_t>(a) + 1];
    ++links.first[static_cast<std::size_t>(b) + 1];
  });
  for (std::size_t n = 0; n < nodes; ++n) links.first[n + 1] += links.first[n];
  links.to.resize(links.first.back());
  std::vector<std::size_t> next(links.first.begin(), links.first.end() - 1);
  for_links(surface, [&](int a, int b) {
    links.to[next[static_cast<std::size_t>(a)]++] = b;
    links.to[next[static_cast<std::size_t>(b)]++] = a;
  });
  return links;
}

std::vector<Way> ways_from(const Surface& surface, const Links& links,
                           const std::vector<int>& nodes, double reach_world) {
  const auto is_farther = [](const Way& a, const Way& b) {
    return std::tie(a.length_world, a.node, a.from) > std::tie(b.length_world, b.node, b.from);
  };
  std::priority_queue<Way, std::vector<Way>, decltype(is_farther)> ahead(is_farther);
  for (const int node : nodes) ahead.push({node, node, 0});
  std::unordered_set<int> done;
  std::vector<Way> ways;
  while (!ahead.empty()) {
    const Way way = ahead.top();
    ahead.pop();
    if (!done.insert(way.node).second) continue;
    ways.push_back(way);
    const auto at = static_cast<std::size_t>(way.node);
    for (std::size_t l = links.first[at]; l < links.first[at + 1]; ++l) {
      const int next = links.to[l];
      const Vec3 edge =
          surface.nodes_world[static_cast<std::size_t>(next)] - surface.nodes_world[at];
      const double length = way.length_world + edge.norm();
      if (length < reach_world && !done.contains(next)) ahead.push({next, way.from, length});
    }
  }
  return ways;
}

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
