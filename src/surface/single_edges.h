#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "vdb_offset/surface/patch.h"

namespace vdb_offset {

/// Edges of cells, to find those of one cell alone.
class CellEdges {
 public:
  /// The corners in order, some of them once more; those of collapsed edges are none.
  template <typename Corners>
  void add(const Corners& corners) {
    for (std::size_t c = 0; c < corners.size(); ++c) {
      const int a = corners[c];
      const int b = corners[(c + 1) % corners.size()];
      if (a != b) edges_.push_back({a < b ? a : b, a < b ? b : a});
    }
  }

  /// Takes them: the edges of one cell alone, the lower end first, in order.
  std::vector<std::array<int, 2>> single() &&;

 private:
  std::vector<std::array<int, 2>> edges_;
};

/// How many of the patches' cells, by nodes.
std::size_t count_single_edges(const Patches& patches,
                               const std::vector<std::vector<int>>& patch_nodes);

}  // namespace vdb_offset
