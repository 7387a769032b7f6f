#include "blocks/window_repair.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

#include "blocks/cut_column.h"
#include "blocks/face_state.h"
#include "blocks/improve.h"
#include "blocks/keep_sides.h"
#include "blocks/lower_columns.h"
#include "blocks/meet_heights.h"
#include "core/parallel.h"
#include "vdb_offset/march/room_at.h"

namespace vdb_offset {
namespace {

constexpr int kRounds = 10;
constexpr int kRings = 4;            // around faces that failed, that move in the next round
constexpr int kDoublings = 2;        // of that, where it did not help
constexpr double kLower = 0.9;       // of a height, where there is no valid place at it
constexpr double kMuchLower = 0.75;  // and where that did not help
constexpr double kCare = 4;          // how much more a face that failed counts in the next round
constexpr double kMostCare = 64;
constexpr int kMisses = 3;  // rounds in which what is inverted alone became no less
/// Work in all, and on what is inverted still after the first of it, after which that is lowered:
/// corners that can be mended take less than half of it. About a millisecond a point.
constexpr double kMostWork = 4000;
constexpr double kMostOnInverted = 2000;
/// Times that, as a window has fewer faces than kSmallWindow; the root of it as it has more:
/// lowering a few corners costs less there than work on all of it, but long inner edges need some.
constexpr double kMostPatience = 8;
constexpr double kManyFirstCells = 2;    // times their height, above which columns keep to that
constexpr std::size_t kGrain = 64;       // faces, columns
constexpr double kRoomTolerance = 2e-3;  // of a height
constexpr double kSameEnd = 1e-6;        // of a height
constexpr double kRounding = 1e-14;      // of the wall's size: columns this high have no height

std::size_t at(int index) { return static_cast<std::size_t>(index); }

}  // namespace

double part_of_room(const Layers& layers) {
  double part = 0;
  for (std::size_t n = 0; n < layers.stop.size(); ++n) {
    if (layers.stop[n] != Stop::Collided || !(layers.room_world[n] > 0)) continue;
    part = std::max(part, layers.height_world[n] / layers.room_world[n]);
  }
  return part > 0 ? std::min(part, 1.0) : 1;
}

WindowRepair::WindowRepair(const Surface& surface, const MultiBlock& mesh, const Window& window,
                           const WindowGoal& goal)
    : surface_(surface),
      layers_(mesh.layers),
      shape_(make_shape(mesh, window, goal.quality)),
      graph_(shape_.window.faces, shape_.window.nodes.size()),
      of_room_(goal.of_room) {
  for (const std::vector<double>& heights : shape_.heights_world) asked_.push_back(heights.back());
  find_kept_from(surface_, shape_);
}

/// The rings that are to move around the columns of faces that fail: first of those that are
/// inverted alone, as long as they become fewer; then of those that fall short of their goal too.
/// They count more from now on; and where that did not help, heights sink.
std::vector<int> WindowRepair::failing(bool may_sink) {
  const std::vector<ColumnFace>& faces = shape_.window.faces;
  const std::vector<FaceState> states = judge_all(shape_);
  std::vector<int> rings(shape_.window.nodes.size(), 0);
  std::vector<double> sink(rings.size(), 1.0);
  const auto inverted = std::ranges::count(states, false, &FaceState::positive);
  positive_ = inverted == 0;
  misses_ += inverted < inverted_ ? 0 : 1;
  inverted_ = std::min(inverted, inverted_);
  for (std::size_t f = 0; f < states.size(); ++f) {
    FaceGoal& goal = shape_.goals[f];
    if (states[f].positive && ((mends_inverted_alone() && !positive_) || goal.misses > kDoublings ||
                               merit(states[f], goal) >= 1))
      continue;
    for (std::size_t c = 0; c < faces[f].count; ++c) {
      int& around = rings[at(faces[f].column[c])];
      around = std::max(around, kRings << std::min(goal.misses, kDoublings));
      if (states[f].positive || goal.weight <= kCare) continue;
      double& own = sink[at(faces[f].column[c])];
      own = std::min(own, goal.weight < kMostCare ? kLower : kMuchLower);
    }
    if (goal.tetrahedra) goal.weight = std::min(goal.weight * kCare, kMostCare);
    goal.tetrahedra = true;
  }
  const bool sinks = *std::min_element(sink.begin(), sink.end()) < 1;
  for (std::size_t s = 0; s < sink.size(); ++s) {
    const double height = shape_.heights_world[s].back();
    const double least = first_cells(layers_, at(shape_.window.nodes[s]));
    sink[s] *= height;
    if (asked_[s] > kManyFirstCells * least) sink[s] = std::max(sink[s], std::min(height, least));
  }
  if (may_sink && sinks) sink_to(std::move(sink));
  return rings;
}

/// After a miss the next window around these faces will be wider; where they were valid there will
/// be none, since wider ones are no better.
void WindowRepair::count(Outcome outcome, const Window& part) {
  int misses = 0;
  for (const int face : part.face_index) misses = std::max(misses, shape_.goals[at(face)].misses);
  if (outcome == Outcome::Mended) misses = 0;
  if (outcome == Outcome::Inverted) ++misses;
  if (outcome == Outcome::NoBetter) misses = kDoublings + 1;
  for (const int face : part.face_index) shape_.goals[at(face)].misses = misses;
}

/// Untangles around these columns alone. What was valid has to get better, or stays as it is.
void WindowRepair::mend(const std::vector<int>& rings, const Progress& progress) {
  std::vector<bool> columns(rings.size(), false);
  for (int doublings = 0; doublings <= kDoublings; ++doublings) {
    std::vector<bool> around(rings.size());
    for (std::size_t s = 0; s < rings.size(); ++s) around[s] = rings[s] == kRings << doublings;
    widen(graph_, kRings << doublings, around);
    for (std::size_t s = 0; s < rings.size(); ++s) columns[s] = columns[s] || around[s];
  }
  const auto held = columns.begin() + static_cast<std::ptrdiff_t>(shape_.window.free);
  std::fill(held, columns.end(), false);
  const std::vector<Window> parts = find_windows(graph_, columns);
  std::vector<int> steps(parts.size(), 0);
  std::vector<double> work(parts.size(), 0.0);
  parallel::for_ranges(parts.size(), 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t p = begin; p < end; ++p) {
      WindowShape cut = cut_out(shape_, parts[p]);
      if (const auto before = count_inverted(cut); before > 0) {
        steps[p] = untangle(surface_, Until::Valid, cut, progress);
        const std::ptrdiff_t after = count_inverted(cut);
        if (!mends_inverted_alone() || after <= before) put_back(cut, parts[p], shape_);
        count(after > 0 ? Outcome::Inverted : Outcome::Mended, parts[p]);
      } else if (improve(surface_, cut, steps[p], progress)) {
        put_back(cut, parts[p], shape_);
      } else {
        count(Outcome::NoBetter, parts[p]);
      }
      work[p] = cut.work * static_cast<double>(parts[p].free);
    }
  });
  const double all = std::accumulate(work.begin(), work.end(), 0.0);
  shape_.work += all / static_cast<double>(shape_.window.free);
  if (!steps.empty()) steps_ += *std::max_element(steps.begin(), steps.end());
}

/// Columns end where the room at their ends allows it; whether any did not.
bool WindowRepair::sink_to_room() {
  const std::size_t last = shape_.points_world.levels() - 1;
  std::vector<double> heights;
  for (const std::vector<double>& own : shape_.heights_world) heights.push_back(own.back());
  std::vector<char> sinks(heights.size(), 0);
  parallel::for_ranges(shape_.window.free, kGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t s = begin; s < end; ++s) {
      if (!(heights[s] > 0)) continue;
      const Vec3 top = shape_.points_world.get(s, last);
      const double height = surface_.wall->closest_place(top).distance_world;
      const auto room = room_at(surface_, top, (1 + kRoomTolerance) * height / of_room_);
      if (!room || height <= (1 + kRoomTolerance) * of_room_ * *room) continue;
      heights[s] *= of_room_ * *room / height;
      sinks[s] = 1;
    }
  });
  if (std::find(sinks.begin(), sinks.end(), 1) == sinks.end()) return false;
  sink_to(std::move(heights));
  return true;
}

/// The march made columns end before facing walls' fronts; where they lean elsewhere there may be
/// less room.
void WindowRepair::keep_apart(const Progress& progress) {
  for (int n = 0; n < kRounds && sink_to_room(); ++n) {
    const std::vector<int> rings = failing(/*may_sink=*/false);
    if (!positive_ && n + 1 < kRounds && !is_spent()) mend(rings, progress);
  }
}

void WindowRepair::grade_heights(std::vector<double>& heights_world) const {
  Grading grading = kOfHeights;
  grading.ratio = std::max(grading.ratio, layers_.spacing.growth);
  const auto foot = [&](std::size_t slot) { return shape_.points_world.get(slot, 0); };
  grade(links_of(graph_, shape_.window.free, foot), grading, heights_world);
}

/// Lowers heights, and neighbours' with them, so that they do not step.
void WindowRepair::sink_to(std::vector<double> heights_world) {
  grade_heights(heights_world);
  for (std::size_t s = 0; s < shape_.window.free; ++s) set_height(s, heights_world[s]);
}

/// Puts a column's levels to a height that is lesser by more than rounding, along the column as it
/// is; and ever lower, as long as shorter ways between them go through an internal surface.
void WindowRepair::set_height(std::size_t slot, double height_world) {
  constexpr int kTimes = 20;
  if (!(height_world < (1 - 1e-9) * shape_.heights_world[slot].back())) return;
  shape_.ends_on[slot] = -1;
  put_to(slot, height_world);
  for (int n = 0; n < kTimes && !keeps_side(surface_, shape_, slot); ++n) {
    height_world *= kLower;
    put_to(slot, height_world);
  }
}

void WindowRepair::put_to(std::size_t slot, double height_world) {
  std::vector<double>& heights = shape_.heights_world[slot];
  const double first = layers_.first_asked_world[at(shape_.window.nodes[slot])];
  const std::vector<double> lower = rescale(layers_.spacing, height_world, first);
  const BoundarySet on = surface_.boundaries_of(at(shape_.window.nodes[slot]));
  const Vec3List points = cut_column(surface_, {heights, lower, on}, [&](std::size_t k) {
    return shape_.points_world.get(slot, k);
  });
  for (std::size_t n = 1; n < points.size(); ++n) shape_.points_world.set(slot, n, points[n]);
  heights = lower;
}

bool WindowRepair::mends_inverted_alone() const { return misses_ < kMisses; }
bool WindowRepair::is_spent() const {
  const double smaller =
      static_cast<double>(kSmallWindow) / static_cast<double>(shape_.window.faces.size());
  const double patience = smaller < 1 ? std::sqrt(smaller) : std::min(smaller, kMostPatience);
  const double on_inverted = patience * kMostOnInverted;
  return shape_.work > patience * kMostWork || (!positive_ && shape_.work - settled_ > on_inverted);
}

std::vector<bool> WindowRepair::face_is_inverted() const {
  const std::vector<FaceState> states = judge_all(shape_);
  std::vector<bool> found;
  for (const FaceState& state : states) found.push_back(!state.positive);
  return found;
}

void WindowRepair::run(const Progress& progress) {
  const State before = state();
  const std::ptrdiff_t inverted_before = count_inverted(shape_);
  if (work_in_corners(progress)) {
    if (positive_) meet_heights(surface_, shape_);
    keep_apart(progress);
  } else {
    restore(before);  // far from anything valid
  }
  if (!positive_) {
    lower(progress);
    if (positive_) meet_heights(surface_, shape_);
  }
  if (positive_ || count_inverted(shape_) <= inverted_before) return;
  restore(before);  // better as it was
}

/// With columns as high as they can be in sharp corners; where that fails, capped there.
bool WindowRepair::work_in_corners(const Progress& progress) {
  const WindowShape fresh = shape_;
  const std::ptrdiff_t capped = cap_sharp_corners(Sharp::Most);
  const bool has_hope = work(progress);
  if (has_hope && positive_) return true;
  WindowShape tried = std::move(shape_);
  shape_ = fresh;
  if (cap_sharp_corners(Sharp::All) == capped) {
    shape_ = std::move(tried);
    return has_hope;
  }
  inverted_ = std::numeric_limits<std::ptrdiff_t>::max();
  misses_ = 0;
  return work(progress);
}

/// False where there is no hope.
bool WindowRepair::work(const Progress& progress) {
  steps_ = untangle(surface_, Until::Settled, shape_, progress);
  settled_ = shape_.work;
  if (is_hopeless(shape_, steps_)) return false;
  for (int round = 0;; ++round) {
    const bool is_last = round == kRounds || is_spent();
    const std::vector<int> rings = failing(/*may_sink=*/!is_last);
    if (is_last || *std::max_element(rings.begin(), rings.end()) == 0) return true;
    mend(rings, progress);
  }
}

/// Where the end of a column moved: back onto the internal surface that it was on, if it is off by
/// rounding alone, else it ends there no longer.
void WindowRepair::leave_internal(std::size_t node, Vec3& end, Layers& layers) const {
  const int on = layers.ends_on[node];
  const Boundary& internal = surface_.boundaries->list()[at(on)];
  const Vec3 foot = internal.project(end);
  if (internal.covers(end) && (foot - end).norm() <= kSameEnd * layers.height_world[node]) {
    end = foot;
    return;
  }
  layers.ends_on[node] = -1;
  layers.stop[node] = Stop::Repaired;
}

double WindowRepair::write(MultiBlock& mesh) const {
  Layers& layers = mesh.layers;
  const auto levels = at(layers.levels());
  double farthest = 0;
  for (std::size_t s = 0; s < shape_.window.free; ++s) {
    const std::size_t node = at(shape_.window.nodes[s]);
    Vec3* const points = layers.points_world.data() + node * levels;
    const Vec3 end = points[levels - 1];
    const double height = (shape_.points_world.get(s, levels - 1) - points[0]).norm();
    const bool stands = height > kRounding * surface_.wall->bounds().size();
    for (std::size_t k = 1; k < levels; ++k) {
      points[k] = stands ? shape_.points_world.get(s, k) : points[0];
    }
    const bool was_on = layers.ended_on(shape_.window.nodes[s]) >= 0;
    if (was_on && points[levels - 1] != end) leave_internal(node, points[levels - 1], layers);
    layers.first_cell_world[node] = surface_.wall->closest_place(points[1]).distance_world;
    layers.height_world[node] = surface_.wall->closest_place(points[levels - 1]).distance_world;
    if (!stands) layers.height_world[node] = layers.first_cell_world[node] = 0;
    const double beyond = asked_[s] > 0 ? layers.height_world[node] / asked_[s] - 1 : 0;
    farthest = std::max(farthest, beyond);
    const bool is_on = layers.ended_on(shape_.window.nodes[s]) >= 0;
    if (std::abs(beyond) > kSameEnd && !is_on) layers.stop[node] = Stop::Repaired;
  }
  return farthest;
}

}  // namespace vdb_offset
