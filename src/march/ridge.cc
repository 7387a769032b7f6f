// The medial axis near a column. Gradient lines of phi run into it and merge: at once in a concave
// corner, where it starts at the wall, and where two fronts meet that come from walls apart. The
// latter is what criterion 1 of figure 6 (Wang, Guibault, Camarero) is for, but phi falls only
// where the walls are antiparallel; elsewhere it goes on rising along the medial axis.
//
// On it grad phi is the mean of the unit vectors a, b away from both feet. Planes through the feet
// meet at the length phi / |(a + b) / 2| down the ridge: the corner itself in a wedge. Most of that
// way at a time, the descent gets to a corner in a few steps, or finds that phi falls no more.

#include "march/ridge.h"

#include <algorithm>
#include <cmath>

namespace vdb_offset {

namespace {

constexpr double kDescent = 0.75;      // part of the way to the planes' corner in one step
constexpr double kLongestDescent = 2;  // of phi, in one step
constexpr double kAtCorner = 1e-4;     // phi over its first value: near enough to the corner
constexpr double kFallsNoMore = 0.9;   // of phi, in a step that should leave 1 - kDescent
constexpr double kFree = 0.9;          // of the distance to the wall: a step that meets no wall
constexpr double kRidgeTolerance = 1e-3;

struct Foot {
  double height;
  Vec3 away;
  double side;
};

Foot foot_of(WallSearch& search, const Vec3& point) {
  const WallPoint nearest = search.nearest(point);
  if (!(nearest.distance_world > 0)) return {0, nearest.normal, 1};
  return {nearest.distance_world, (point - nearest.point_world) / nearest.distance_world,
          nearest.side(point)};
}

}  // namespace

std::optional<Ridge> find_ridge(WallSearch& search, const Line& line) {
  const auto at = [&](double s) { return Vec3(line.from_world + s * line.direction); };
  const Foot first = foot_of(search, line.from_world);
  Foot near = first;
  Foot far = first;
  double lo = 0;
  double hi = 0;
  while (first.away.dot(far.away) > kSameFront) {
    const bool at_wall = !(far.height > kAtCorner * first.height);
    if (hi >= line.length_world || at_wall) return std::nullopt;
    near = far;
    lo = hi;
    hi = std::min(hi + kFree * far.height, line.length_world);
    far = foot_of(search, at(hi));
  }
  const double tolerance = kRidgeTolerance * std::min(line.length_world, first.height);
  for (int n = 0; n < 60 && hi - lo > tolerance; ++n) {
    const double s = 0.5 * (lo + hi);
    const Foot foot = foot_of(search, at(s));
    const bool is_near = first.away.dot(foot.away) > kSameFront;
    (is_near ? lo : hi) = s;
    (is_near ? near : far) = foot;
  }
  if (near.away.dot(far.away) > kSameFront) return std::nullopt;
  return Ridge{lo, near.height, at(lo), near.away, far.away};
}

namespace {

/// The same ridge near `point`, sought across it.
std::optional<Ridge> ridge_near(WallSearch& search, const Ridge& ridge, const Vec3& point) {
  const Foot foot = foot_of(search, point);
  const bool is_near = foot.away.dot(ridge.away_near) >= foot.away.dot(ridge.away_far);
  const Vec3 across = (is_near ? 1.0 : -1.0) * (ridge.away_near - ridge.away_far).normalized();
  auto found = find_ridge(search, {point, across, 4 * ridge.height_world});
  if (found && !is_near) std::swap(found->away_near, found->away_far);
  return found;
}

}  // namespace

bool faces(WallSearch& search, const Ridge& ridge) {
  const double side = foot_of(search, ridge.point_world).side;
  Ridge now = ridge;
  for (int n = 0; n < 40 && now.height_world > kAtCorner * ridge.height_world; ++n) {
    const double rise = std::max(now.rise(), 1e-3);
    const Vec3 down = -(now.away_near + now.away_far) / (2 * rise);
    const double length = std::min(kDescent / rise, kLongestDescent) * now.height_world;
    const Vec3 point = now.point_world + length * down;
    const Foot foot = foot_of(search, point);
    if (foot.side != side) return false;  // through the wall: the corner is rounded
    const auto next = ridge_near(search, now, point);
    if ((next ? next->height_world : foot.height) > kFallsNoMore * now.height_world) return true;
    if (!next) return false;
    now = *next;
  }
  return false;
}

}  // namespace vdb_offset
