#include "blocks/part_crossed.h"

#include <algorithm>
#include <limits>

#include "blocks/lower_columns.h"

namespace vdb_offset {

int part_crossed(const Surface& surface, const ColumnGraph& graph, MultiBlock& mesh) {
  constexpr int kTimes = 24;
  constexpr double kLower = 0.85;  // of a height, or to below the cell where that is more
  Layers& layers = mesh.layers;
  int lowered = 0;
  for (int n = 0; n < kTimes; ++n) {
    const auto crossed = crossed_cells(surface, mesh);
    if (crossed.empty()) break;
    std::vector<double> most(layers.height_world.size(), std::numeric_limits<double>::infinity());
    for (const auto& [nodes, level] : crossed) {
      for (const int node : nodes) {
        if (node < 0) continue;
        const auto at = static_cast<std::size_t>(node);
        const double below = layers.heights(at)[static_cast<std::size_t>(level)];
        most[at] = std::min(most[at], std::max(below, kLower * layers.height_world[at]));
      }
    }
    const int now = lower_columns(surface, graph, most, layers);
    if (now == 0) break;
    lowered += now;
  }
  return lowered;
}

}  // namespace vdb_offset
