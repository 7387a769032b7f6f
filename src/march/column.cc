// Section 4.4 of Wang, Guibault, Camarero: equation 13 with a fourth-order Runge-Kutta method, and
// the two stopping criteria of figure 6, each located by the true distance.
//
// Near the wall. At a convex node the gradient lines of the exact distance are straight: if the
// distance at the far end of a straight line equals its length, it does so all along (the distance
// changes no faster than the path). So a column starts straight where that holds to twice the
// length, else in the grid's field, whose differences through the wall average the directions of a
// concave corner. Where body or gap are thinner than the stencil the grid's direction contradicts
// the nearest feature's, and the latter takes over.

#include "march/column.h"

#include <algorithm>
#include <cmath>

#include "march/ridge.h"
#include "vdb_offset/rasterize/rasterize.h"

namespace vdb_offset {

namespace {

// A straight start must rise with this part of its initial slope, over twice its length.
constexpr double kStraight = 0.98;
constexpr double kConcave = 0.9;  // slope at the wall below which a node is on an inner edge
// phi rises at least this fast along a column, or another front is in the way: grad phi of the
// grid is sin(a) on the bisector of a wedge of inner angle 2a. Below 20 degrees its directions
// jitter across the bisector, and some columns stop there.
constexpr double kLeastRise = 0.02;
// A column longer than this many distances creeps along a ridge of phi.
constexpr double kLongest = 60;

constexpr double kLook = 2;  // voxels between two looks for a ridge
// A ridge that was found to be a concave corner's is looked at again when phi rises slower along it
// by this factor.
constexpr double kLowerRise = 0.8;

// A column that is longer than its height by less than this part never came near another wall: the
// distance rises at most as fast as the length, so nothing on the way is off by more.
constexpr double kDetour = 2e-4;

double smoothstep(double lo, double hi, double x) {
  const double t = std::clamp((x - lo) / (hi - lo), 0.0, 1.0);
  return t * t * (3 - 2 * t);
}

bool are_planes(const std::vector<Boundary>& boundaries) {
  return std::all_of(boundaries.begin(), boundaries.end(),
                     [](const Boundary& boundary) { return boundary.is_plane(); });
}

}  // namespace

ColumnTracer::ColumnTracer(const Surface& surface, const DistanceField& field,
                           const MarchOptions& options)
    : boundaries_(surface.boundaries.get()),
      search_(*surface.wall, boundaries_),
      sampler_(field),
      distance_world_(field.distance_world),
      voxel_world_(field.voxel_world),
      step_world_(options.step_voxels * field.voxel_world),
      gap_margin_(options.gap_margin),
      may_be_straight_(boundaries_ == nullptr || are_planes(boundaries_->list())) {}

/// Within the boundaries that the column stands on.
Vec3 ColumnTracer::hold(const Vec3& point_world) const {
  return on_ == 0 ? point_world : boundaries_->hold(on_, point_world);
}

/// The same, and not beyond any other.
Vec3 ColumnTracer::keep(const Vec3& point_world) const {
  if (boundaries_ == nullptr) return point_world;
  const Vec3 held = hold(point_world);
  return boundaries_->side(held) < 0 ? boundaries_->contain(point_world, on_) : held;
}

/// Turned towards the column's lean, as far as that, unless it leans more already.
Vec3 ColumnTracer::leaning(const Vec3& direction) const {
  const double sine = lean_.norm();
  if (!(sine > 0) || direction.dot(lean_) >= sine * sine) return direction;
  const Vec3 across = direction - direction.dot(lean_) / (sine * sine) * lean_;
  const double length = across.norm();
  if (!(length > 0)) return direction;
  return std::sqrt(1 - sine * sine) / length * across + lean_;
}

/// The same for the field's direction. Past a free edge that is away from the edge, and leans by
/// itself: there it is the wall's normal that turns.
Vec3 ColumnTracer::leaning_at(const Vec3& point_world, const Vec3& direction) {
  if (lean_.isZero(0)) return direction;
  const WallPoint nearest = search_.nearest(point_world);
  return leaning(nearest.on_free_edge ? Vec3(side_ * nearest.normal) : direction);
}

Vec3 ColumnTracer::steer(const Vec3& point_world, const Vec3& direction) const {
  if (on_ == 0) return direction;
  const Vec3 within = boundaries_->along(on_, point_world, direction);
  return within.squaredNorm() > 0 ? within : direction;
}

Vec3 ColumnTracer::point(const ColumnPath& path, double s_world) const {
  return keep(path.point(s_world));
}

Vec3 ColumnTracer::blend(const FieldSample& sample, const WallPoint& nearest,
                         const Vec3& point_world) const {
  Vec3 exact = side_ * nearest.normal;
  if (nearest.distance_world > 1e-9 * voxel_world_) {
    exact = (point_world - nearest.point_world) / nearest.distance_world;
  }
  const double magnitude = sample.gradient.norm();
  if (!sample.inside || !(magnitude > 0)) return exact;
  const Vec3 grid = (side_ / magnitude) * sample.gradient;
  // On the bisector of a wedge of inner angle 2a both figures are sin a.
  const double trust = smoothstep(0.02, 0.15, grid.dot(exact)) * smoothstep(0.02, 0.15, magnitude);
  const Vec3 mixed = trust * grid + (1 - trust) * exact;
  const double length = mixed.norm();
  return length > 0.1 ? Vec3(mixed / length) : exact;
}

Vec3 ColumnTracer::direction(const Vec3& point_world, State* state) {
  const FieldSample sample = sampler_.at(point_world);
  const double phi = side_ * sample.phi_world;
  if (sample.inside && phi >= kSeedReachVoxels * voxel_world_) {
    if (state != nullptr) *state = {phi, false, true};
    const double magnitude = sample.gradient.norm();
    const Vec3 grid = (side_ / magnitude) * sample.gradient;
    if (magnitude > 0) return steer(point_world, leaning_at(point_world, grid));
  }
  const WallPoint nearest = search_.nearest(point_world);
  if (state != nullptr) *state = {nearest.distance_world, true, sample.inside};
  return steer(point_world, leaning_at(point_world, blend(sample, nearest, point_world)));
}

/// How fast the distance rises at the wall, and the length over which no other wall interferes with
/// that: the column's own triangles are the nearest at its end.
std::pair<double, double> ColumnTracer::slope_at_wall(const ColumnStart& start) {
  double length = std::min(0.05 * start.spacing_world, 0.05 * voxel_world_);
  for (int n = 0; n < 60; ++n, length *= 0.5) {
    const Vec3 point = keep(start.point_world + length * start.direction);
    const double own = search_.nearest_own(point).distance_world;
    if (search_.nearest(point).distance_world < own * (1 - 1e-6)) continue;
    return {std::min(1.0, own / length), length};
  }
  return {0, length};
}

/// The first knots; returns the slope of the distance at the wall.
double ColumnTracer::start_path(const ColumnStart& start, ColumnPath& path) {
  side_ = start.side;
  search_.begin(start.triangles);
  path.clear();
  path.add({0, start.point_world, start.direction});
  const auto [slope, probe] = slope_at_wall(start);
  double straight = 0;
  if (slope > kLeastRise) {
    straight = std::min(kSeedReachVoxels * voxel_world_, 1.01 * distance_world_ / slope);
    // By steps as long as the distance at their start: none jumps over a wall.
    for (double s = probe, height = slope * probe; s < 2 * straight;) {
      const double before = s;
      s = std::min(s + height, 2 * straight);
      height = search_.nearest(hold(start.point_world + s * start.direction)).distance_world;
      if (height >= kStraight * slope * s) continue;
      // The grid's field would draw a fan's columns together, and turn those of an inner edge away
      // from its bisector: they are straight as far as it goes.
      const bool is_far = before >= 2 * probe;
      straight = is_far && (start.in_fan || slope < kConcave) ? 0.5 * before : 0;
    }
  }
  const double first = straight > 0 ? straight : probe;
  const Vec3 to = keep(start.point_world + first * start.direction);
  path.add({first, to, steer(to, start.direction)});
  return slope;
}

/// One Runge-Kutta step; false when it leaves the band. The field's direction at its end is the
/// next step's first slope.
bool ColumnTracer::step(ColumnPath& path, double length_world, State& state) {
  const ColumnPath::Knot from = path.back();
  const Vec3 k1 = heading_;
  const Vec3 k2 = direction(from.point_world + 0.5 * length_world * k1);
  const Vec3 k3 = direction(from.point_world + 0.5 * length_world * k2);
  const Vec3 k4 = direction(from.point_world + length_world * k3);
  const Vec3 to = keep(from.point_world + (length_world / 6) * (k1 + 2 * k2 + 2 * k3 + k4));
  heading_ = direction(to, &state);
  if (!state.inside) return false;
  path.add({from.s_world + length_world, to, heading_});
  return true;
}

namespace {

ColumnTracer::Height height_of(const WallPoint& nearest, const Vec3& point,
                               const Vec3& derivative) {
  if (!(nearest.distance_world > 0)) return {0, 0};
  const Vec3 away = (point - nearest.point_world) / nearest.distance_world;
  return {nearest.distance_world, away.dot(derivative)};
}

}  // namespace

ColumnTracer::Height ColumnTracer::exact(const ColumnPath& path, double s_world) {
  const Vec3 x = hold(path.point(s_world));
  return height_of(search_.nearest(x), x, path.derivative(s_world));
}

ColumnTracer::Height ColumnTracer::own(const ColumnPath& path, double s_world) const {
  const Vec3 x = hold(path.point(s_world));
  return height_of(search_.nearest_own(x), x, path.derivative(s_world));
}

bool ColumnTracer::stays_home(const ColumnPath& path, const ColumnEnd& end) {
  if (end.s_world - end.height_world > kDetour * end.height_world) return false;
  const double straight = std::min(path.knot(1).s_world, end.s_world);
  for (const double s : {end.s_world, 0.5 * (straight + end.s_world)}) {
    const double true_height = s == end.s_world ? end.height_world : exact(path, s).height_world;
    if (own(path, s).height_world > true_height * (1 + 1e-12)) return false;
  }
  return true;
}

/// Whether the column crosses the distance between two lengths, and where: the own wall's distance,
/// never too small, says no at once, and where it says yes the true one is asked.
bool ColumnTracer::arrives(const ColumnPath& path, double from, double to, ColumnEnd& end) {
  if (own(path, to).height_world < distance_world_) return false;
  // Where phi has a kink the grid can be off by more than the guard: the crossing lies before.
  if (own(path, from).height_world >= distance_world_) from = 0;
  const auto solve = [&](const auto& height_at) {
    double lo = from;
    double hi = to;
    double s = to;
    for (int n = 0; n < 60 && hi - lo > 1e-15 * hi; ++n) {
      const Height height = height_at(s);
      const double miss = height.height_world - distance_world_;
      if (std::abs(miss) <= 1e-13 * distance_world_) break;
      (miss > 0 ? hi : lo) = s;
      s -= height.slope > 0 ? miss / height.slope : 0.0;
      if (!(s > lo && s < hi)) s = 0.5 * (lo + hi);
    }
    return s;
  };
  double s = solve([&](double at) { return own(path, at); });
  double height = exact(path, s).height_world;
  if (height < distance_world_ * (1 - 1e-12)) {
    if (exact(path, to).height_world < distance_world_) return false;
    s = solve([&](double at) { return exact(path, at); });
    height = exact(path, s).height_world;
  }
  end = {Stop::Reached, s, height, 1};
  return true;
}

/// The last step crossed a ridge of phi: go straight on from the knot before it, across the ridge,
/// and find the largest true distance on the way. A Runge-Kutta step over the ridge bends back.
ColumnEnd ColumnTracer::locate_turn(ColumnPath& path) {
  const double on = 2 * (path.back().s_world - path.knot(path.size() - 2).s_world);
  if (path.size() > 2) path.drop_last();
  const ColumnPath::Knot last = path.back();
  path.add({last.s_world + on, hold(last.point_world + on * last.tangent), last.tangent});
  const double from = path.size() > 3 ? path.knot(path.size() - 3).s_world : 0;
  const ColumnEnd turn = highest(path, from, path.back().s_world);
  ColumnEnd sooner;
  const bool far = turn.height_world >= distance_world_;
  return far && arrives(path, from, turn.s_world, sooner) ? sooner : turn;
}

ColumnEnd ColumnTracer::highest(const ColumnPath& path, double from, double to) {
  constexpr double kGolden = 0.6180339887498949;
  const double tolerance = std::min(0.02 * voxel_world_, 5e-3 * (to - from));
  double a = to - kGolden * (to - from);
  double b = from + kGolden * (to - from);
  double fa = exact(path, a).height_world;
  double fb = exact(path, b).height_world;
  while (to - from > tolerance) {
    if (fa >= fb) {
      to = b;
      b = a;
      fb = fa;
      a = to - kGolden * (to - from);
      fa = exact(path, a).height_world;
    } else {
      from = a;
      a = b;
      fa = fb;
      b = from + kGolden * (to - from);
      fb = exact(path, b).height_world;
    }
  }
  const double s = fa >= fb ? a : b;
  return {Stop::Collided, s, std::max(fa, fb), 1};
}

/// Whether the column met the front of a facing wall since it was last looked at, and where: there
/// the true distance rises slower than the length. The grid's field bends before a ridge, so the
/// search goes straight on from a knot before that.
bool ColumnTracer::collides(ColumnPath& path, ColumnEnd& end) {
  const double s_now = path.back().s_world;
  const double height = exact(path, s_now).height_world;
  const double rise = (height - checked_.height_world) / (s_now - checked_.s_world);
  checked_ = {s_now, height};
  if (rise >= local_rise_ * kLowerRise) return false;
  std::size_t before = path.size() - 2;
  while (before > 1 && s_now - path.knot(before).s_world < kBend * voxel_world_) --before;
  const ColumnPath::Knot from = path.knot(before);
  const auto ridge =
      find_ridge(search_, {from.point_world, from.tangent, 2 * (s_now - from.s_world)});
  if (!ridge) return false;
  if (!faces(search_, *ridge)) {
    local_rise_ = rise;
    return false;
  }
  end = end_at(*ridge, from.s_world, path);
  return true;
}

ColumnEnd ColumnTracer::follow(ColumnPath& path) {
  double s = path.back().s_world;
  double height = exact(path, s).height_world;
  ColumnEnd end;
  if (height >= distance_world_ && arrives(path, 0, s, end)) return end;
  if (height < path.knot(1).s_world * kLeastRise) return highest(path, 0, s);
  // The grid is off by parts of a voxel, more so far from the wall: look at the distance early.
  const double guard = std::max(0.75 * voxel_world_, 0.02 * distance_world_);
  const double longest = kLongest * distance_world_ + 100 * step_world_;
  State before{height, true, true};
  heading_ = direction(path.back().point_world);
  local_rise_ = kRidgeRise / kLowerRise;
  checked_ = {s, height};
  while (s < longest) {
    // No step reaches as far as a wall: a thin gap would be jumped over.
    const double length =
        before.is_exact ? std::min(step_world_, 0.5 * before.phi_world) : step_world_;
    State now;
    if (!step(path, length, now)) break;
    const double s_now = path.back().s_world;
    if (now.phi_world > distance_world_ - guard && arrives(path, s, s_now, end)) {
      ColumnEnd sooner;
      return collides(path, sooner) ? sooner : end;
    }
    const bool reversed = path.back().tangent.dot(path.knot(path.size() - 2).tangent) < 0;
    const bool rises = !reversed && now.is_exact == before.is_exact &&
                       now.phi_world - before.phi_world > kLeastRise * length;
    if (!rises) {
      const double gain = exact(path, s_now).height_world - exact(path, s).height_world;
      if (reversed || gain <= kLeastRise * length) return locate_turn(path);
    }
    const double since = s_now - checked_.s_world;
    const bool look = since >= std::min(kLook * voxel_world_, kLook * checked_.height_world);
    if (look && collides(path, end)) return end;
    before = now;
    s = s_now;
  }
  height = exact(path, s).height_world;
  if (height >= distance_world_ && arrives(path, path.knot(1).s_world, s, end)) return end;
  return {s < longest ? Stop::LeftBand : Stop::Collided, s, height, 1};
}

ColumnEnd ColumnTracer::trace(const ColumnStart& node, double distance_world, ColumnPath& path) {
  distance_world_ = distance_world;
  on_ = node.boundaries;
  lean_ = node.lean / std::hypot(1, node.lean.norm());
  ColumnStart start = node;
  start.direction = steer(node.point_world, leaning(node.direction));
  if (goes_straight(start, path)) {
    return {Stop::Reached, distance_world_, distance_world_, 1, -1, 0, true};
  }
  const double slope = start_path(start, path);
  ColumnEnd end = follow(path);
  if (end.stop == Stop::Collided) climb_corner(path, end);
  look_ahead(path, end);
  if (boundaries_ != nullptr && boundaries_->has_internal()) end_on_internal(path, end);
  end.slope_at_wall = slope;
  return end;
}

ColumnEnd ColumnTracer::cut(const ColumnPath& path, const ColumnEnd& whole, double height_world) {
  distance_world_ = height_world;
  ColumnEnd end = whole;
  if (arrives(path, 0, whole.s_world, end)) end.slope_at_wall = whole.slope_at_wall;
  return end;
}

}  // namespace vdb_offset
