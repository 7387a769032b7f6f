#include "blocks/part_crossed.h"

#include <algorithm>
#include <cstddef>
#include <limits>

#include "blocks/lower_columns.h"

namespace vdb_offset {
namespace {

std::size_t at(int index) { return static_cast<std::size_t>(index); }

}  // namespace

int part_crossed(const Surface& surface, const ColumnGraph& graph, MultiBlock& mesh) {
  constexpr int kTimes = 24;
  constexpr int kPatience = 4;     // times without fewer crossed cells: walls near by cross
  constexpr double kLower = 0.85;  // of a height, or to below the cell where that is more
  Layers& layers = mesh.layers;
  int lowered = 0;
  int misses = 0;
  std::size_t fewest = std::numeric_limits<std::size_t>::max();
  for (int n = 0; n < kTimes && misses < kPatience; ++n) {
    const auto crossed = lowest_crossed(surface, mesh);
    if (crossed.empty()) break;
    misses = crossed.size() < fewest ? 0 : misses + 1;
    fewest = std::min(fewest, crossed.size());
    std::vector<double> most(layers.height_world.size(), std::numeric_limits<double>::infinity());
    for (const auto& [nodes, level] : crossed) {
      const bool may_spare = std::ranges::any_of(nodes, [&](int node) {
        return node >= 0 && layers.height_world[at(node)] > first_cells(layers, at(node));
      });
      for (const int node : nodes) {
        if (node < 0) continue;
        const double height = layers.height_world[at(node)];
        const double below = layers.heights(at(node))[at(level)];
        double lower = std::max(below, kLower * height);
        if (may_spare) lower = std::max(lower, std::min(height, first_cells(layers, at(node))));
        most[at(node)] = std::min(most[at(node)], lower);
      }
    }
    const int now = lower_columns(surface, graph, most, layers);
    if (now == 0) break;
    lowered += now;
  }
  return lowered;
}

}  // namespace vdb_offset
