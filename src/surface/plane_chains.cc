#include "surface/plane_chains.h"

#include <map>
#include <utility>

namespace vdb_offset {

std::vector<EdgeChain> chains_of(const PlaneFinder& finder, const std::vector<std::size_t>& edges) {
  std::map<int, std::vector<std::size_t>> at_node;
  for (const std::size_t e : edges) {
    at_node[finder.edges()[e].a].push_back(e);
    at_node[finder.edges()[e].b].push_back(e);
  }
  std::map<std::size_t, bool> seen;
  std::vector<EdgeChain> chains;
  for (const std::size_t first : edges) {
    if (std::exchange(seen[first], true)) continue;
    EdgeChain chain{{first}};
    for (std::size_t n = 0; n < chain.edges.size(); ++n) {
      for (const int end : {finder.edges()[chain.edges[n]].a, finder.edges()[chain.edges[n]].b}) {
        const std::vector<std::size_t>& here = at_node[end];
        chain.is_loop = chain.is_loop && here.size() == 2;
        for (const std::size_t next : here) {
          if (!std::exchange(seen[next], true)) chain.edges.push_back(next);
        }
      }
    }
    chains.push_back(std::move(chain));
  }
  return chains;
}

}  // namespace vdb_offset
