#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

#include "blocks/window.h"
#include "core/grading.h"
#include "vdb_offset/core/vec.h"
#include "vdb_offset/surface/surface.h"

namespace vdb_offset {

/// Neighbours of each column along edges of faces, of the first `free` alone: others keep their
/// heights. `foot(column)` is its place on the wall.
template <typename Foot>
Links links_of(const ColumnGraph& graph, std::size_t free, const Foot& foot) {
  Links links;
  links.first.push_back(0);
  for (std::size_t n = 0; n + 1 < graph.first.size(); ++n) {
    for (std::size_t f = graph.first[n]; f < graph.first[n + 1]; ++f) {
      const ColumnFace& face = graph.faces[static_cast<std::size_t>(graph.around[f])];
      for (std::size_t c = 0; c < face.count; ++c) {
        if (static_cast<std::size_t>(face.column[c]) != n) continue;
        for (const int other : {face.next(c), face.previous(c)}) {
          if (static_cast<std::size_t>(other) >= free) continue;
          links.to.push_back(other);
          links.length_world.push_back((foot(static_cast<std::size_t>(other)) - foot(n)).norm());
        }
      }
    }
    links.first.push_back(links.to.size());
  }
  return links;
}

/// A column whose levels stand at `from_world`, to be put to lesser heights.
struct ColumnCut {
  const std::vector<double>& from_world;
  const std::vector<double>& to_world;
  BoundarySet on = 0;  ///< what its points stay on
};

/// The levels' new points, along the column as it is; `point(level)` is where they are now.
template <typename Point>
Vec3List cut_column(const Surface& surface, const ColumnCut& cut, const Point& point) {
  const std::vector<double>& from = cut.from_world;
  Vec3List points;
  std::size_t k = 0;
  for (const double h : cut.to_world) {
    if (!(h > 0)) {  // no height at all is the foot to the bit
      points.push_back(point(0));
      continue;
    }
    while (k + 2 < from.size() && from[k + 1] < h) ++k;
    const double part = std::clamp((h - from[k]) / (from[k + 1] - from[k]), 0.0, 1.0);
    const Vec3 straight = (1 - part) * point(k) + part * point(k + 1);
    // Between two points of a column on a curved boundary a straight line leaves it.
    const bool is_free = cut.on == 0 || points.empty();
    points.push_back(is_free ? straight : surface.boundaries->hold(cut.on, straight));
  }
  return points;
}

}  // namespace vdb_offset
