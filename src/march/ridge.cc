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
constexpr double kOpens = 0.95 * kRidgeRise;  // where a ridge that rises so fast ends it is open
constexpr double kStepUp = 0.25;              // of the height, in one step up
constexpr std::size_t kMostSteps = 400;
constexpr int kMostStepsAlong = 1000;  // of a line: one that begins on a wall and keeps beside it

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
  for (int n = 0; first.away.dot(far.away) > kSameFront; ++n) {
    const bool at_wall = !(far.height > kAtCorner * first.height);
    if (hi >= line.length_world || at_wall || n == kMostStepsAlong) return std::nullopt;
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

/// The same ridge within a length of a point, sought across it.
std::optional<Ridge> ridge_near(WallSearch& search, const Ridge& ridge, const Vec3& point,
                                double length) {
  const Foot foot = foot_of(search, point);
  const bool is_near = foot.away.dot(ridge.away_near) >= foot.away.dot(ridge.away_far);
  const Vec3 across = (is_near ? 1.0 : -1.0) * (ridge.away_near - ridge.away_far).normalized();
  auto found = find_ridge(search, {point, across, length});
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
    const auto next = ridge_near(search, now, point, 4 * now.height_world);
    if ((next ? next->height_world : foot.height) > kFallsNoMore * now.height_world) return true;
    if (!next) return false;
    now = *next;
  }
  return false;
}

std::optional<Ridge> ridge_beside(WallSearch& search, const Line& up) {
  const Vec3 near = foot_of(search, up.from_world).away;
  const Vec3 across = near - near.dot(up.direction) * up.direction;
  if (!(across.norm() > std::sqrt(1 - kRidgeRise * kRidgeRise))) return std::nullopt;
  return find_ridge(search, {up.from_world, across.normalized(), up.length_world});
}

namespace {

/// One step up a ridge: what it is there, or the way from the foot on a third part of the wall.
struct Up {
  std::optional<Ridge> ridge;
  std::optional<Vec3> third;
};

Up step_up(WallSearch& search, const Ridge& now, double length) {
  const auto is_third = [&](const Vec3& away) {
    return away.dot(now.away_near) <= kSameFront && away.dot(now.away_far) <= kSameFront;
  };
  const Vec3 up = (now.away_near + now.away_far).normalized();
  const Vec3 point = now.point_world + length * up;
  const Foot foot = foot_of(search, point);
  if (is_third(foot.away)) return {std::nullopt, foot.away};
  const auto next = ridge_near(search, now, point, 2 * length);
  if (!next) return {};
  for (const Vec3& away : {next->away_near, next->away_far}) {
    if (is_third(away)) return {std::nullopt, away};
  }
  return {next, std::nullopt};
}

}  // namespace

std::optional<Climb> climb(WallSearch& search, const Ridge& ridge, double step_world,
                           double height_world) {
  Climb way{{ridge}};
  Up up;
  for (double length = step_world; way.ridges.size() < kMostSteps;) {
    const Ridge& now = way.ridges.back();
    if (now.height_world >= height_world) return way;
    if (length < kRidgeTolerance * step_world || !(now.rise() > kAtCorner)) break;
    up = step_up(search, now, std::min(length, kStepUp * now.height_world));
    if (up.ridge && up.ridge->height_world > now.height_world) {
      way.ridges.push_back(*up.ridge);
    } else {
      length *= 0.5;
    }
  }
  const Ridge& top = way.ridges.back();
  way.opens = !up.third && top.rise() > kOpens;
  if (way.opens) return way;
  if (!up.third) return std::nullopt;
  way.meets = true;
  for (const Vec3& away : {top.away_near, top.away_far}) {
    const Ridge met{0, top.height_world, top.point_world, away, *up.third};
    if (faces(search, met)) return way;
  }
  return std::nullopt;
}

}  // namespace vdb_offset
