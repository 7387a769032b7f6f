// What untangling could not make valid is made valid by its height: near the wall a cell is what
// the wall's corners and the directions of its columns make it, so straight columns that see all
// cells around them leave it positive if they are low enough. Where no direction sees them all, the
// column gets no height, and the cells around it lose an edge.

#include <Eigen/Geometry>
#include <algorithm>

#include "blocks/face_state.h"
#include "blocks/window_repair.h"
#include "core/most_normal.h"

namespace vdb_offset {
namespace {

constexpr int kLowerings = 40;
constexpr double kHalf = 0.5;           // of a height, again and again
constexpr double kLeastVisible = 0.02;  // cosine below which a column counts as if it saw no cell

std::size_t at(int index) { return static_cast<std::size_t>(index); }

}  // namespace

/// Of the corners of the faces around it, on the wall.
Visible WindowRepair::way_out(std::size_t slot) const {
  Vec3List normals;
  const auto wall = [&](int column) { return shape_.points_world.get(at(column), 0); };
  const Vec3 own = shape_.points_world.get(slot, 0);
  for (std::size_t f = graph_.first[slot]; f < graph_.first[slot + 1]; ++f) {
    const ColumnFace& face = shape_.window.faces[at(graph_.around[f])];
    for (std::size_t c = 0; c < face.count; ++c) {
      if (at(face.column[c]) != slot) continue;
      const Vec3 normal = (wall(face.next(c)) - own).cross(wall(face.previous(c)) - own);
      if (normal.squaredNorm() > 0) normals.push_back(normal.normalized());
    }
  }
  if (normals.empty()) return {Vec3::Zero(), -1};
  Vec3 sum = Vec3::Zero();
  for (const Vec3& normal : normals) sum += normal;
  const Visible best = most_normal(normals, sum.norm() > 1e-3 ? sum.normalized() : normals.front());
  const BoundarySet on = surface_.boundaries_of(at(shape_.window.nodes[slot]));
  if (on == 0) return best;
  const Vec3 within = surface_.boundaries->along(on, own, best.direction);
  return {within, least_cosine(within, normals)};
}

/// Puts a column on a straight line out, or, where there is none, on its foot.
void WindowRepair::straighten(std::size_t slot, const Visible& out, double height_world) {
  std::vector<double>& heights = shape_.heights_world[slot];
  const Vec3 foot = shape_.points_world.get(slot, 0);
  const BoundarySet on = surface_.boundaries_of(at(shape_.window.nodes[slot]));
  const bool is_gone = !(out.least_cosine > kLeastVisible) || !(height_world > 0);
  if (is_gone) {
    std::fill(heights.begin(), heights.end(), 0.0);
  } else {
    const double first = layers_.first_asked_world[at(shape_.window.nodes[slot])];
    heights = rescale(layers_.spacing, height_world, first);
  }
  for (std::size_t k = 1; k < heights.size(); ++k) {
    const Vec3 point = is_gone ? foot : Vec3(foot + heights[k] / out.least_cosine * out.direction);
    shape_.points_world.set(slot, k,
                            on == 0 || is_gone ? point : surface_.boundaries->hold(on, point));
  }
}

/// Straight columns, ever lower, around cells that are inverted, until none is.
void WindowRepair::lower(const Progress& progress) {
  std::vector<bool> is_straight(shape_.window.free, false);
  std::vector<double> heights(shape_.window.nodes.size());
  for (int n = 0; n < kLowerings; ++n) {
    progress.check();
    const std::vector<bool> fails = inverted_columns();
    positive_ = std::find(fails.begin(), fails.end(), true) == fails.end();
    if (positive_) return;
    for (std::size_t s = 0; s < heights.size(); ++s) heights[s] = shape_.heights_world[s].back();
    for (std::size_t s = 0; s < shape_.window.free; ++s) {
      if (fails[s] && is_straight[s]) heights[s] *= kHalf;
      if (fails[s] && !is_straight[s] && !(way_out(s).least_cosine > kLeastVisible)) heights[s] = 0;
      is_straight[s] = is_straight[s] || fails[s];
    }
    grade_heights(heights);
    for (std::size_t s = 0; s < shape_.window.free; ++s) {
      if (is_straight[s]) {
        straighten(s, way_out(s), heights[s]);
      } else {
        set_height(s, heights[s]);
      }
    }
  }
  positive_ = inverted() == 0;
}

}  // namespace vdb_offset
