#pragma once

#include <cstddef>

#include "surface/topology.h"
#include "vdb_offset/surface/surface.h"

namespace vdb_offset {

/// visit(a, b): the nodes of each edge of a cell that an edge of patches is made of, as its first
/// side has them.
template <typename Visit>
void for_segments(const Surface& surface, const Edge& edge, const Visit& visit) {
  const auto p = static_cast<std::size_t>(edge.first.patch);
  const auto node = [&](int s) {
    const int point = side_point(surface.patches[p], edge.first.side, s);
    return surface.patch_nodes[p][static_cast<std::size_t>(point)];
  };
  for (int s = edge.first.begin; s < edge.first.end; ++s) visit(node(s), node(s + 1));
}

}  // namespace vdb_offset
