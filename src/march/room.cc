#include "march/room.h"

#include <queue>
#include <tuple>
#include <unordered_set>
#include <vector>

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
  links.length_world.resize(links.to.size());
  std::vector<std::size_t> next(links.first.begin(), links.first.end() - 1);
  const auto add = [&](std::size_t from, std::size_t to) {
    links.to[next[from]] = static_cast<int>(to);
    links.length_world[next[from]++] = (surface.nodes_world[to] - surface.nodes_world[from]).norm();
  };
  for_links(surface, [&](int a, int b) {
    add(static_cast<std::size_t>(a), static_cast<std::size_t>(b));
    add(static_cast<std::size_t>(b), static_cast<std::size_t>(a));
  });
  return links;
}

std::vector<Way> ways_from(const Links& links, const std::vector<int>& nodes, double reach_world) {
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
      const double length = way.length_world + links.length_world[l];
      if (length < reach_world && !done.contains(next)) ahead.push({next, way.from, length});
    }
  }
  return ways;
}

}  // namespace vdb_offset
