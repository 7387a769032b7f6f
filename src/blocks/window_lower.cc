// What untangling could not make valid is made valid by its height: near the wall a cell is what
// the wall's corners and the directions of its columns make it, so straight columns that see all
// cells around them leave it positive if they are low enough. Where no direction sees them all, the
// column gets no height, and the cells around it lose an edge.

#include <Eigen/Geometry>
#include <algorithm>

#include "blocks/face_state.h"
#include "blocks/keep_sides.h"
#include "blocks/nearest_image.h"
#include "blocks/window_repair.h"
#include "core/most_normal.h"

namespace vdb_offset {
namespace {

constexpr int kHalvings = 16;           // of a column, then one of its neighbours or it goes
constexpr int kLowerings = 160;         // in all: cells beyond those lowered may fail next
constexpr double kHalf = 0.5;           // of a height, again and again
constexpr double kProbe = 1e-3;         // of a height: where lines' distance from the wall is seen
constexpr double kLeastVisible = 0.02;  // cosine below which a column counts as if it saw no cell

std::size_t at(int index) { return static_cast<std::size_t>(index); }

}  // namespace

/// Of the corners of the faces around it, on the wall; that of a fan's column is its own.
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
  const std::size_t node = at(shape_.window.nodes[slot]);
  if (surface_.fans.leads(node)) {
    const Vec3& out = surface_.fans.direction[node];
    return {out, normals.empty() ? 1 : least_cosine(out, normals)};
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
  shape_.ends_on[slot] = -1;
  const Vec3 foot = shape_.points_world.get(slot, 0);
  const BoundarySet on = surface_.boundaries_of(at(shape_.window.nodes[slot]));
  const bool is_gone = !(out.least_cosine > kLeastVisible) || !(height_world > 0);
  double rise = 1;  // of the distance along the line, at its beginning
  if (!is_gone) {
    int guess = -1;
    const Vec3 probe = foot + kProbe * height_world * out.direction;
    const double distance = nearest_image(surface_, probe, guess).distance_world;
    rise = std::clamp(distance / (kProbe * height_world), out.least_cosine, 1.0);
    height_world *= free_part(surface_, shape_, slot, foot + height_world / rise * out.direction);
  }
  if (is_gone) {
    std::fill(heights.begin(), heights.end(), 0.0);
  } else {
    const double first = layers_.first_asked_world[at(shape_.window.nodes[slot])];
    heights = rescale(layers_.spacing, height_world, first);
  }
  for (std::size_t k = 1; k < heights.size(); ++k) {
    const Vec3 point = is_gone ? foot : Vec3(foot + heights[k] / rise * out.direction);
    shape_.points_world.set(slot, k,
                            on == 0 || is_gone ? point : surface_.boundaries->hold(on, point));
  }
}

/// Of each inverted face that has a column halved as often as may be, the one that sees least, if
/// each face around it has another one that stands.
std::vector<std::size_t> WindowRepair::to_collapse(const std::vector<int>& halvings) const {
  std::vector<std::size_t> gone;
  const auto stands = [&](int column) {
    return shape_.heights_world[at(column)].back() > 0 &&
           std::find(gone.begin(), gone.end(), at(column)) == gone.end();
  };
  const auto may_go = [&](int column) {
    const auto has_other = [&](int f) {
      const ColumnFace& face = shape_.window.faces[at(f)];
      return std::any_of(face.column.begin(),
                         face.column.begin() + static_cast<std::ptrdiff_t>(face.count),
                         [&](int other) { return other != column && stands(other); });
    };
    const auto around = graph_.around.begin();
    return at(column) < shape_.window.free && stands(column) &&
           std::all_of(around + static_cast<std::ptrdiff_t>(graph_.first[at(column)]),
                       around + static_cast<std::ptrdiff_t>(graph_.first[at(column) + 1]),
                       has_other);
  };
  const std::vector<bool> inverted = face_is_inverted();
  for (std::size_t f = 0; f < inverted.size(); ++f) {
    int worst = -1;
    const ColumnFace& face = shape_.window.faces[f];
    const auto is_low = [&](int column) {
      return at(column) < halvings.size() && halvings[at(column)] >= kHalvings;
    };
    if (!inverted[f] || std::none_of(face.column.begin(), face.column.begin() + face.count, is_low))
      continue;
    for (std::size_t c = 0; c < face.count; ++c) {
      const int column = face.column[c];
      if (!may_go(column)) continue;
      const auto sees = [&](int slot) { return way_out(at(slot)).least_cosine; };
      if (worst < 0 || sees(column) < sees(worst)) worst = column;
    }
    if (worst >= 0) gone.push_back(at(worst));
  }
  return gone;
}

/// What stands around a column that goes was lowered in vain: its heights are tried anew without.
void WindowRepair::raise_around(std::size_t gone, const std::vector<double>& asked,
                                std::vector<double>& heights, std::vector<int>& halvings) const {
  for (std::size_t f = graph_.first[gone]; f < graph_.first[gone + 1]; ++f) {
    const ColumnFace& face = shape_.window.faces[at(graph_.around[f])];
    for (std::size_t c = 0; c < face.count; ++c) {
      const std::size_t s = at(face.column[c]);
      if (s >= asked.size() || !(heights[s] > 0)) continue;
      heights[s] = asked[s];
      halvings[s] = 0;
    }
  }
}

WindowRepair::State WindowRepair::state() const {
  return {shape_.points_world, shape_.heights_world, shape_.ends_on};
}

void WindowRepair::restore(State state) {
  shape_.points_world = std::move(state.points_world);
  shape_.heights_world = std::move(state.heights_world);
  shape_.ends_on = std::move(state.ends_on);
}

/// Sum of the free columns' heights, of what was asked of each.
double WindowRepair::height_left() const {
  double sum = 0;
  for (std::size_t s = 0; s < shape_.window.free; ++s) {
    if (asked_[s] > 0) sum += shape_.heights_world[s].back() / asked_[s];
  }
  return sum;
}

/// Until nothing is inverted any more. Straight columns may turn their neighbours inside out in
/// their turn, the more the higher they are; so they are first made lower as they are, and where
/// that costs much or is no use, straight at once.
void WindowRepair::lower(const Progress& progress) {
  constexpr double kEnough = 0.98;
  constexpr int kCuts = 3;
  const State before = state();
  const double wanted = kEnough * height_left();
  lower_columns(kCuts, progress);
  if (positive_ && height_left() >= wanted) return;
  const double left = positive_ ? height_left() : -1;
  State lowered = state();
  restore(before);
  lower_columns(0, progress);
  if (left < 0 || (positive_ && height_left() >= left)) return;
  restore(std::move(lowered));
  positive_ = true;
}

/// Columns around cells that are inverted become ever lower: halved so often along themselves, then
/// straight.
void WindowRepair::lower_columns(int cuts, const Progress& progress) {
  const std::size_t free = shape_.window.free;
  std::vector<bool> is_straight(free, false);
  std::vector<int> cut(free, 0);
  std::vector<int> halvings(free, 0);
  std::vector<double> heights(shape_.window.nodes.size());
  std::vector<double> asked(free);
  for (std::size_t s = 0; s < free; ++s) asked[s] = shape_.heights_world[s].back();
  for (int n = 0; n < kLowerings; ++n) {
    progress.check();
    const std::vector<bool> inverted = face_is_inverted();
    positive_ = std::find(inverted.begin(), inverted.end(), true) == inverted.end();
    if (positive_) return;
    for (std::size_t s = 0; s < heights.size(); ++s) heights[s] = shape_.heights_world[s].back();
    std::vector<bool> fails(heights.size(), false);
    for (std::size_t f = 0; f < inverted.size(); ++f) {
      const ColumnFace& face = shape_.window.faces[f];
      for (std::size_t c = 0; inverted[f] && c < face.count; ++c) fails[at(face.column[c])] = true;
    }
    for (std::size_t s = 0; s < free; ++s) {
      if (!fails[s]) continue;
      if (!is_straight[s] && cut[s] < cuts) {
        ++cut[s];
        heights[s] *= kHalf;
        continue;
      }
      if (!is_straight[s] && !(way_out(s).least_cosine > kLeastVisible)) heights[s] = 0;
      if (is_straight[s] && halvings[s]++ < kHalvings) heights[s] *= kHalf;
      is_straight[s] = true;
    }
    for (const std::size_t s : to_collapse(halvings)) {
      heights[s] = 0;
      raise_around(s, asked, heights, halvings);
    }
    grade_heights(heights);
    for (std::size_t s = 0; s < free; ++s) {
      if (is_straight[s]) {
        straighten(s, way_out(s), heights[s]);
      } else {
        set_height(s, heights[s]);
      }
    }
  }
  positive_ = std::ranges::count(face_is_inverted(), true) == 0;
}

}  // namespace vdb_offset
