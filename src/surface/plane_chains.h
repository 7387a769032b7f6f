#pragma once

#include <cstddef>
#include <vector>

#include "surface/plane_finder.h"

namespace vdb_offset {

/// Free edges that hang together.
struct EdgeChain {
  std::vector<std::size_t> edges;  ///< of the finder's
  bool is_loop = true;             ///< each node has two of its edges
};

std::vector<EdgeChain> chains_of(const PlaneFinder& finder, const std::vector<std::size_t>& edges);

}  // namespace vdb_offset
