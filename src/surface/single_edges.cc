#include "surface/single_edges.h"

#include <functional>
#include <utility>

#include "core/parallel.h"

namespace vdb_offset {

std::vector<std::array<int, 2>> CellEdges::single() && {
  parallel::sort(edges_.begin(), edges_.end(), std::less<>());
  std::size_t kept = 0;
  for (std::size_t e = 0; e < edges_.size();) {
    const std::size_t first = e;
    while (e < edges_.size() && edges_[e] == edges_[first]) ++e;
    if (e == first + 1) edges_[kept++] = edges_[first];
  }
  edges_.resize(kept);
  return std::move(edges_);
}

std::size_t count_single_edges(const Patches& patches,
                               const std::vector<std::vector<int>>& patch_nodes) {
  CellEdges edges;
  for (std::size_t p = 0; p < patches.size(); ++p) {
    for_cells(patches[p], [&](std::array<int, 4> cell) {
      for (int& corner : cell) corner = patch_nodes[p][static_cast<std::size_t>(corner)];
      edges.add(cell);
    });
  }
  return std::move(edges).single().size();
}

}  // namespace vdb_offset
