#include "blocks/improve.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "blocks/untangle.h"
#include "core/parallel.h"

namespace vdb_offset {
namespace {

constexpr double kMostCareAtOnce = 16;
constexpr double kMostCare = 1024;  // in all
constexpr double kWellOff = 0.95;   // what is wanted of them, to what they have
constexpr double kBetter = 0.95;    // of what was short, to be worth keeping
/// Higher goals come second: else what is good already gains at the cost of the worst.
constexpr double kFirstAim = 0.4;
constexpr int kTries = 16;          // of a few steps each
constexpr int kTriesMissed = 4;     // one after the other, to end them
constexpr std::size_t kGrain = 64;  // faces

std::size_t at(int index) { return static_cast<std::size_t>(index); }

/// How far a window is from what is wanted, its worst faces most; infinite while one is inverted.
double shortfall(const WindowShape& shape) {
  const std::vector<FaceState> states = judge_all(shape);
  double sum = 0;
  for (std::size_t f = 0; f < states.size(); ++f) {
    if (!states[f].positive) return std::numeric_limits<double>::infinity();
    sum += std::pow(std::max(0.0, 1 - merit(states[f], shape.goals[f])), 4);
  }
  return sum;
}

/// Makes faces that fall short count more, the worst most, and those that are well off less again.
void take_care(WindowShape& shape) {
  const std::vector<FaceState> states = judge_all(shape);
  for (std::size_t f = 0; f < states.size(); ++f) {
    const double missing = 1 / merit(states[f], shape.goals[f]);
    double& weight = shape.goals[f].weight;
    weight = std::min(weight * std::clamp(missing, 1.0, kMostCareAtOnce), kMostCare);
    if (missing < kWellOff) weight = std::max(1.0, weight * missing * missing);
  }
}

double worst(const WindowShape& shape) {
  const std::vector<FaceState> states = judge_all(shape);
  return std::ranges::min(states, {}, &FaceState::scaled_jacobian).scaled_jacobian;
}

/// Towards the goals as they are, with no cell below `floor` at the end.
bool climb(const Surface& surface, double floor, WindowShape& shape, int& steps,
           const Progress& progress) {
  const double before = shortfall(shape);
  double best = before;
  ColumnVector points = shape.points_world;
  int misses = 0;
  for (int tried = 0; tried < kTries && misses < kTriesMissed && best > 0; ++tried) {
    // What is valid is often at rest: with weights as they are it would stay so.
    take_care(shape);
    steps += untangle(surface, Until::Better, shape, progress);
    const double now = shortfall(shape);
    if (now < kBetter * best && (floor <= 0 || worst(shape) >= floor)) {
      best = now;
      points = shape.points_world;
      misses = 0;
    } else {
      shape.points_world = points;
      ++misses;
    }
  }
  shape.points_world = std::move(points);
  return best < kBetter * before;
}

}  // namespace

std::vector<FaceState> judge_all(const WindowShape& shape) {
  std::vector<FaceState> states(shape.window.faces.size());
  const auto point = [&](int slot, std::size_t level) {
    return shape.points_world.get(at(slot), level);
  };
  parallel::for_ranges(states.size(), kGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t f = begin; f < end; ++f) {
      states[f] = judge_face(shape.window.faces[f], shape.points_world.levels() - 1, point);
    }
  });
  return states;
}

std::ptrdiff_t count_inverted(const WindowShape& shape) {
  return std::ranges::count(judge_all(shape), false, &FaceState::positive);
}

double merit(const FaceState& state, const FaceGoal& goal) {
  return goal.least_quality > 0 ? state.scaled_jacobian / goal.least_quality : 1;
}

bool improve(const Surface& surface, WindowShape& shape, int& steps, const Progress& progress) {
  // All of them hold back, or others would be inverted than those that failed.
  for (FaceGoal& goal : shape.goals) goal.tetrahedra = true;
  const std::vector<FaceGoal> goals = shape.goals;
  bool is_high = false;
  for (FaceGoal& goal : shape.goals) {
    is_high = is_high || goal.least_quality > kFirstAim;
    goal.least_quality = std::min(goal.least_quality, kFirstAim);
  }
  const bool first = climb(surface, 0, shape, steps, progress);
  if (!is_high) return first;
  for (std::size_t f = 0; f < goals.size(); ++f) {
    shape.goals[f].least_quality = goals[f].least_quality;
  }
  return climb(surface, worst(shape), shape, steps, progress) || first;
}

}  // namespace vdb_offset
