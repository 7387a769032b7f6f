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

}  // namespace vdb_offset
