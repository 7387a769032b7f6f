#include "blocks/lower_columns.h"

#include <algorithm>

#include "blocks/cut_column.h"
#include "vdb_offset/march/spacing.h"

namespace vdb_offset {
namespace {

constexpr double kSame = 1e-9;  // of a height

/// Puts the levels of a column to a lesser height, along the column as it is.
void lower(const Surface& surface, std::size_t node, double height_world, Layers& layers) {
  const std::vector<double> heights = layers.heights(node);
  const std::vector<double> lower =
      rescale(layers.spacing, height_world, layers.first_asked_world[node]);
  Vec3* const points = layers.points_world.data() + node * heights.size();
  const Vec3List moved = cut_column(surface, {heights, lower, surface.boundaries_of(node)},
                                    [&](std::size_t k) -> const Vec3& { return points[k]; });
  std::copy(moved.begin() + 1, moved.end(), points + 1);
  if (!layers.ends_on.empty()) layers.ends_on[node] = -1;
  layers.stop[node] = Stop::Repaired;
  layers.height_world[node] = surface.wall->closest_place(moved.back()).distance_world;
  layers.first_cell_world[node] = surface.wall->closest_place(moved[1]).distance_world;
}

}  // namespace

double first_cells(const Layers& layers, std::size_t node) {
  return static_cast<double>(layers.levels() - 1) * layers.first_asked_world[node];
}

int lower_columns(const Surface& surface, const ColumnGraph& graph,
                  const std::vector<double>& most_world, Layers& layers) {
  Grading grading = kOfHeights;
  grading.ratio = std::max(grading.ratio, layers.spacing.growth);
  const Links links = links_of(graph, most_world.size(), [&](std::size_t n) -> const Vec3& {
    return layers.at(static_cast<int>(n), 0);
  });
  // What steps for other reasons, as columns that were repaired do, is no matter here.
  std::vector<double> before = layers.height_world;
  std::vector<double> after = before;
  for (std::size_t n = 0; n < after.size(); ++n) after[n] = std::min(after[n], most_world[n]);
  grade(links, grading, before);
  grade(links, grading, after);
  int lowered = 0;
  for (std::size_t n = 0; n < after.size(); ++n) {
    const double height = std::min(layers.height_world[n], after[n]);
    if (!(height > 0 && height < (1 - kSame) * layers.height_world[n])) continue;
    if (!(after[n] < (1 - kSame) * before[n])) continue;
    lower(surface, n, height, layers);
    lowered += surface.is_copy(n) ? 0 : 1;
  }
  return lowered;
}

}  // namespace vdb_offset
