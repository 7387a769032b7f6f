#include "blocks/keep_faces.h"

#include <algorithm>
#include <utility>
#include <vector>

#include "blocks/window_repair.h"
#include "core/grading.h"
#include "vdb_offset/march/face_room.h"
#include "vdb_offset/march/spacing.h"

namespace vdb_offset {
namespace {

constexpr double kSame = 1e-9;  // of a height

std::size_t at(int index) { return static_cast<std::size_t>(index); }

/// Neighbours of each column along edges of faces.
Links links_of(const ColumnGraph& graph, const Layers& layers) {
  Links links;
  links.first.push_back(0);
  for (std::size_t n = 0; n + 1 < graph.first.size(); ++n) {
    for (std::size_t f = graph.first[n]; f < graph.first[n + 1]; ++f) {
      const ColumnFace& face = graph.faces[at(graph.around[f])];
      for (std::size_t c = 0; c < face.count; ++c) {
        if (at(face.column[c]) != n) continue;
        for (const int other : {face.next(c), face.previous(c)}) {
          links.to.push_back(other);
          const Vec3 edge = layers.at(other, 0) - layers.at(static_cast<int>(n), 0);
          links.length_world.push_back(edge.norm());
        }
      }
    }
    links.first.push_back(links.to.size());
  }
  return links;
}

/// Puts the levels of a column to a lesser height, along the column as it is.
void lower(const Surface& surface, std::size_t node, double height_world, Layers& layers) {
  const std::vector<double> heights = layers.heights(node);
  const std::vector<double> lower =
      rescale(layers.spacing, height_world, layers.first_asked_world[node]);
  Vec3* const points = layers.points_world.data() + node * heights.size();
  const BoundarySet on = surface.boundaries_of(node);
  std::vector<Vec3> moved;
  std::size_t k = 0;
  for (const double height : lower) {
    while (k + 2 < heights.size() && heights[k + 1] < height) ++k;
    const double part = std::clamp((height - heights[k]) / (heights[k + 1] - heights[k]), 0.0, 1.0);
    const Vec3 point = (1 - part) * points[k] + part * points[k + 1];
    moved.push_back(on == 0 || moved.empty() ? point : surface.boundaries->hold(on, point));
  }
  std::copy(moved.begin() + 1, moved.end(), points + 1);
  if (!layers.ends_on.empty()) layers.ends_on[node] = -1;
  layers.stop[node] = Stop::Repaired;
  layers.height_world[node] = surface.wall->closest_place(moved.back()).distance_world;
  layers.first_cell_world[node] = surface.wall->closest_place(moved[1]).distance_world;
}

}  // namespace

int keep_faces_apart(const Surface& surface, const ColumnGraph& graph, MultiBlock& mesh) {
  Layers& layers = mesh.layers;
  const std::vector<double> room = face_room(surface, layers, 1 - part_of_room(layers));
  if (room.empty()) return 0;
  Grading grading = kOfHeights;
  grading.ratio = std::max(grading.ratio, layers.spacing.growth);
  const Links links = links_of(graph, layers);
  // What steps for other reasons, as columns that were repaired do, is no matter here.
  std::vector<double> before = layers.height_world;
  std::vector<double> after = before;
  for (std::size_t n = 0; n < room.size(); ++n) after[n] = std::min(after[n], room[n]);
  grade(links, grading, before);
  grade(links, grading, after);
  int lowered = 0;
  for (std::size_t n = 0; n < room.size(); ++n) {
    const double height = std::min(layers.height_world[n], after[n]);
    if (!(height > 0 && height < (1 - kSame) * layers.height_world[n])) continue;
    if (!(after[n] < (1 - kSame) * before[n])) continue;
    lower(surface, n, height, layers);
    lowered += surface.is_copy(n) ? 0 : 1;
  }
  return lowered;
}

}  // namespace vdb_offset
