#pragma once

// Nodes beside each other on a surface.

#include <cstddef>

#include "vdb_offset/surface/surface.h"

namespace vdb_offset::test {

/// Visits the two nodes of every grid edge.
template <typename Visit>
void for_neighbours(const Surface& surface, const Visit& visit) {
  for (std::size_t p = 0; p < surface.patches.size(); ++p) {
    const Patch& patch = surface.patches[p];
    const auto node = [&](int i, int j) {
      return static_cast<std::size_t>(surface.node(static_cast<int>(p), i, j));
    };
    for (int j = 0; j < patch.nj; ++j) {
      for (int i = 0; i < patch.ni; ++i) {
        if (i + 1 < patch.ni) visit(node(i, j), node(i + 1, j));
        if (j + 1 < patch.nj) visit(node(i, j), node(i, j + 1));
      }
    }
  }
}

inline double edge_length(const Surface& surface, std::size_t a, std::size_t b) {
  return (surface.nodes_world[a] - surface.nodes_world[b]).norm();
}

}  // namespace vdb_offset::test
