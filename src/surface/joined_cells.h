#pragma once

#include <array>
#include <cstddef>

#include "vdb_offset/surface/patch.h"
#include "vdb_offset/surface/surface.h"
#include "vdb_offset/surface/wall.h"

namespace vdb_offset {

/// visit(patch, corners) for all cells of the wall but those of fans; corners are nodes, one for
/// all nodes that stand in one place.
template <typename Visit>
void for_joined_cells(const Surface& surface, const Visit& visit) {
  for (std::size_t p = 0; p < surface.patches.size(); ++p) {
    if (surface.is_fan(p)) continue;
    for_cells(surface.patches[p], [&](std::array<int, 4> c) {
      for (int& corner : c) {
        const auto node = surface.patch_nodes[p][static_cast<std::size_t>(corner)];
        corner = static_cast<int>(surface.stands_at(static_cast<std::size_t>(node)));
      }
      visit(static_cast<int>(p), c);
    });
  }
}

/// visit(patch, triangle) for the two halves of these cells that have three nodes.
template <typename Visit>
void for_joined_triangles(const Surface& surface, const Visit& visit) {
  for_joined_cells(surface, [&](int patch, const std::array<int, 4>& c) {
    for (const Wall::Triangle& t : {Wall::Triangle{c[0], c[1], c[2]}, {c[0], c[2], c[3]}}) {
      if (t[0] != t[1] && t[1] != t[2] && t[2] != t[0]) visit(patch, t);
    }
  });
}

}  // namespace vdb_offset
