#pragma once

#include <span>
#include <vector>

#include "vdb_offset/core/vec.h"
#include "vdb_offset/surface/wall.h"

namespace vdb_offset {

/// Which way out of each wall vertex, and how fine the wall is there.
struct NodeDirections {
  Vec3List direction;  ///< unit; angle-weighted mean of the normals, or the one that sees all of
                       ///< them best
  std::vector<double> spacing_world;  ///< shortest edge at the vertex
  std::vector<bool> blind;            ///< no direction at all sees all of them

  /// Triangles at a node, in index order.
  std::span<const int> triangles(std::size_t node) const {
    return {triangle_list.data() + first_triangle[node],
            first_triangle[node + 1] - first_triangle[node]};
  }
  /// visit(edge) for the grid's edges at a node, some of them twice; those to the middle of a cell
  /// are none.
  template <typename Visit>
  void for_edges(const Wall& wall, std::size_t node, const Visit& visit) const {
    for (const int t : triangles(node)) {
      for (const int v : wall.triangles()[static_cast<std::size_t>(t)]) {
        const auto other = static_cast<std::size_t>(v);
        if (other < direction.size() && other != node) {
          visit(Vec3(wall.vertices()[other] - wall.vertices()[node]));
        }
      }
    }
  }
  std::vector<std::size_t> first_triangle;  ///< of each node in the list, and the list's end
  std::vector<int> triangle_list;
};

NodeDirections node_directions(const Wall& wall, int nodes);

}  // namespace vdb_offset
