// Garanzha, Kaporin, Kudryavtseva, Protais, Ray, Sokolov, Foldover-free maps in 50 lines of code,
// 2021, with a term that holds levels to their distance. Truncated Newton steps: Nocedal, Wright,
// Numerical Optimization, 2006, chapter 7.

#include "blocks/untangle.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "blocks/colouring.h"
#include "blocks/column_algebra.h"
#include "blocks/face_state.h"
#include "blocks/keep_sides.h"
#include "blocks/level_heights.h"
#include "blocks/triad_energy.h"
#include "core/parallel.h"

namespace vdb_offset {
namespace {

constexpr int kMaxSteps = 60;
constexpr int kFewSteps = 3;
constexpr int kMaxInner = 100;          // steps of the linear solver
constexpr double kMostToSettle = 2000;  // work
constexpr int kShorter = 3;             // times that a step is made shorter
constexpr double kForcing = 0.1;        // its residual, relative
constexpr double kSmallStep = 1e-3;     // fall of the sum, relative
constexpr double kFirstEpsilon = 1e-2;
constexpr double kLastEpsilon = 1e-4;  // with corners inverted still: no valid place is near
constexpr std::size_t kGrain = 16;     // columns
constexpr std::size_t kRun = 32;       // faces

/// What a Newton step and a value of the sum take, beside a step of the linear solver.
constexpr double kWorkOfStep = 8;
constexpr double kWorkOfValue = 2;

std::size_t at(int index) { return static_cast<std::size_t>(index); }

/// Of the angle that a face has on the wall at one of its corners.
double wall_cosine(const ColumnVector& x, const ColumnFace& face, std::size_t corner) {
  constexpr double kSharpest = 0.94;  // of 20 degrees: a needle on the wall stays one
  const Vec3 own = x.get(at(face.column[corner]), 0);
  const Vec3 a = x.get(at(face.next(corner)), 0) - own;
  const Vec3 b = x.get(at(face.previous(corner)), 0) - own;
  const double lengths = a.norm() * b.norm();
  return lengths > 0 ? std::clamp(a.dot(b) / lengths, -kSharpest, kSharpest) : 0.0;
}

class Untangler {
 public:
  Untangler(const Surface& surface, WindowShape& shape);
  int run(Until until, const Progress& progress);

 private:
  using Sum = TriadEnergy::Sum;

  void add(Triad triad);
  void add_corners(std::size_t face);
  void add_tetrahedra(std::size_t face);
  Sum value();
  Sum expand();
  template <typename Body>
  Sum sum_triads(const Body& body) const;
  BoundarySet boundaries_of(std::size_t slot, std::size_t level) const;
  void hold(ColumnVector& v) const;
  void solve(ColumnVector& step);
  void move(const ColumnVector& start, double length, const ColumnVector& step);
  void move_column(std::size_t s, const ColumnVector& start, double t, const ColumnVector& step);
  using Found = std::pair<double, Sum>;  // length of the step, and the sum there
  Found search(const ColumnVector& start, const ColumnVector& step, Sum now);
  Sum advance(Until until, const ColumnVector& step, const Sum& before);
  void choose_epsilon(double least, Until until);

  const Surface& surface_;
  const Window& window_;
  WindowShape& shape_;
  std::size_t levels_;
  std::vector<Triad> triads_;       // face by face
  std::vector<std::size_t> first_;  // triad of each face, and the end
  ColouredRuns runs_;               // of faces
  double epsilon_ = kFirstEpsilon;
  double floor_ = kFirstEpsilon;                           // of epsilon, while corners are inverted
  double most_ = std::numeric_limits<double>::infinity();  // of epsilon from now on
  LevelHeights heights_;
  ColumnSystem system_;
  ColumnVector gradient_;
};

Untangler::Untangler(const Surface& surface, WindowShape& shape)
    : surface_(surface),
      window_(shape.window),
      shape_(shape),
      levels_(shape.points_world.levels()),
      heights_(surface, shape),
      system_(window_, levels_, [&](std::size_t f) { return shape.goals[f].tetrahedra; }),
      gradient_(window_.nodes.size(), levels_) {
  for (std::size_t f = 0; f < window_.faces.size(); ++f) {
    first_.push_back(triads_.size());
    add_corners(f);
    if (shape.goals[f].tetrahedra && window_.faces[f].count == 4) add_tetrahedra(f);
  }
  first_.push_back(triads_.size());
  const auto columns = [&](std::size_t f, auto visit) {
    const ColumnFace& face = window_.faces[f];
    for (std::size_t c = 0; c < face.count; ++c) visit(at(face.column[c]));
  };
  runs_ = ColouredRuns(window_.faces.size(), kRun, window_.nodes.size(), columns);
}

/// Unless none of its columns is free, or one of its edges has no length at any level, or it goes
/// up a column that has none. Not in the lowest cell where an edge of a fan has no length there.
void Untangler::add(Triad triad) {
  const auto is_free = [&](const Triad::Point& point) { return at(point.column) < window_.free; };
  if (std::none_of(triad.points.begin(), triad.points.end(), is_free)) return;
  for (std::size_t i = 0; i < 2; ++i) {
    const std::vector<double>& length = *triad.edges[i].length_world;
    if (!(length.back() > 0)) return;
    if (!(length[triad.edges[i].up] > 0)) triad.first = 1;
  }
  if (!(triad.heights_world->back() > 0)) return;
  triads_.push_back(triad);
}

/// At each corner, below and above: along the face's two edges, and up. Where a fan closes the two
/// are one on the wall, and not far from it above: there along one, and across the fan.
void Untangler::add_corners(std::size_t f) {
  const ColumnFace& face = window_.faces[f];
  const auto& edges = shape_.goals[f].edges_world;
  for (std::size_t c = 0; c < face.count; ++c) {
    const int own = face.column[c];
    for (const int up : {0, 1}) {
      Triad triad;
      triad.points = {{{own, up}, {face.next(c), up}, {face.previous(c), up}, {own, 1 - up}}};
      triad.edges[0] = {0, 1, &edges[c], at(up)};
      triad.edges[1] = {0, 2, &edges[(c + face.count - 1) % face.count], at(up)};
      const std::vector<double>& opposite = edges[(c + 1) % face.count];
      const bool closes_fan = face.count == 3 && !(opposite.front() > 0);
      if (closes_fan) triad.edges[1] = {1, 2, &opposite, at(up)};
      triad.edges[2] = up == 0 ? Triad::Edge{0, 3} : Triad::Edge{3, 0};
      triad.cosine = closes_fan ? 0 : wall_cosine(shape_.points_world, face, c);
      triad.heights_world = &shape_.heights_world[at(own)];
      triad.weight = shape_.goals[f].weight;
      add(triad);
    }
  }
}

/// The six round a diagonal: from one corner to the opposite one along three edges of the cell, in
/// any order.
void Untangler::add_tetrahedra(std::size_t f) {
  const ColumnFace& face = window_.faces[f];
  const auto& edges = shape_.goals[f].edges_world;
  static constexpr std::array<std::array<std::size_t, 3>, 6> kOrders{
      {{0, 1, 2}, {1, 0, 2}, {0, 2, 1}, {1, 2, 0}, {2, 0, 1}, {2, 1, 0}}};
  for (const auto& order : kOrders) {
    Triad triad;
    std::array<bool, 3> gone{};  // along i, j, up
    triad.heights_world = &shape_.heights_world[at(face.column[0])];
    for (std::size_t n = 0; n <= 3; ++n) {
      const std::size_t corner = gone[0] ? (gone[1] ? 2 : 1) : (gone[1] ? 3 : 0);
      triad.points[n] = {face.column[corner], gone[2] ? 1 : 0};
      if (n == 3) break;
      const std::size_t axis = order[n];
      const std::size_t level = gone[2] ? 1 : 0;
      // Side 0 of the face runs along i, and 2 back; 1 along j, and 3 back.
      const std::size_t side = axis == 0 ? (gone[1] ? 2U : 0U) : (gone[0] ? 1U : 3U);
      triad.edges[axis] = {n, n + 1, axis < 2 ? &edges[side] : nullptr, level};
      if (axis == 2) triad.heights_world = &shape_.heights_world[at(face.column[corner])];
      gone[axis] = true;
    }
    triad.cosine = wall_cosine(shape_.points_world, face, 0);
    triad.weight = shape_.goals[f].weight;
    add(triad);
  }
}

/// body(energy, triad) for each triad, in order face by face.
template <typename Body>
TriadEnergy::Sum Untangler::sum_triads(const Body& body) const {
  std::vector<Sum> sums(triads_.size());
  runs_.for_each([&](std::size_t begin, std::size_t end) {
    TriadEnergy energy(levels_, epsilon_);
    for (std::size_t n = first_[begin]; n < first_[end]; ++n) sums[n] = body(energy, triads_[n]);
  });
  Sum sum{0, std::numeric_limits<double>::infinity()};
  for (const Sum& part : sums) {
    sum.energy += part.energy;
    sum.least = std::min(sum.least, part.least);
  }
  return sum;
}

TriadEnergy::Sum Untangler::value() {
  shape_.work += kWorkOfValue;
  Sum sum = sum_triads([&](TriadEnergy& energy, const Triad& triad) {
    return energy.value(triad, shape_.points_world);
  });
  sum.energy += heights_.value(shape_.points_world);
  return sum;
}

/// Value, gradient and Hessian.
TriadEnergy::Sum Untangler::expand() {
  shape_.work += kWorkOfStep;
  for_values(gradient_, [&](std::size_t n) { gradient_.values()[n] = 0; });
  system_.clear();
  Sum sum = sum_triads([&](TriadEnergy& energy, const Triad& triad) {
    return energy.expand(triad, shape_.points_world, {gradient_, system_});
  });
  heights_.expand(shape_.points_world, gradient_, system_);
  for (std::size_t slot = 0; slot < window_.free; ++slot) {
    system_.hold(slot, shape_.first_free[slot]);
  }
  sum.energy += heights_.value(shape_.points_world);
  hold(gradient_);
  return sum;
}

/// What a point stays on: its node's boundaries, the last one the internal surface it ends on too.
BoundarySet Untangler::boundaries_of(std::size_t slot, std::size_t level) const {
  const BoundarySet on = surface_.boundaries_of(at(window_.nodes[slot]));
  const int end = shape_.ends_on[slot];
  return end < 0 || level + 1 < levels_ ? on : on | BoundarySet{1} << at(end);
}

/// The part of a vector that the boundaries leave free, and nothing where points are held.
void Untangler::hold(ColumnVector& v) const {
  for (std::size_t s = 0; s < window_.nodes.size(); ++s) {
    const std::size_t held = s < window_.free ? shape_.first_free[s] : levels_;
    for (std::size_t a = 0; a < 3; ++a) std::fill_n(v.at(s, a), held, 0.0);
    if (s >= window_.free) continue;
    for (std::size_t k = held; k < levels_; ++k) {
      const BoundarySet on = boundaries_of(s, k);
      const Vec3 value = v.get(s, k);
      if (on == 0 || !(value.squaredNorm() > 0)) continue;
      const Vec3 along = surface_.boundaries->along(on, shape_.points_world.get(s, k), value);
      v.set(s, k, along.dot(value) * along);
    }
  }
}

/// Conjugate gradients on the Newton equation.
void Untangler::solve(ColumnVector& step) {
  system_.factor_columns();
  std::fill(step.values().begin(), step.values().end(), 0.0);
  ColumnVector r = gradient_;
  for_values(r, [&](std::size_t n) { r.values()[n] = -r.values()[n]; });
  ColumnVector z(window_.nodes.size(), levels_);
  ColumnVector q = z;
  system_.solve_columns(r, z);
  hold(z);
  ColumnVector p = z;
  double rz = dot(r, z);
  const double enough = kForcing * kForcing * rz;
  for (int n = 0; n < kMaxInner && rz > enough; ++n) {
    ++shape_.work;
    system_.multiply(p, q);
    hold(q);
    const double pq = dot(p, q);
    if (!(pq > 0)) break;
    const double alpha = rz / pq;
    add_scaled(step, alpha, p);
    add_scaled(r, -alpha, q);
    system_.solve_columns(r, z);
    hold(z);
    const double next = dot(r, z);
    const double beta = next / rz;
    rz = next;
    for_values(p, [&](std::size_t i) { p.values()[i] = z.values()[i] + beta * p.values()[i]; });
  }
}

/// A column that would go through an internal surface goes less far, or not at all.
void Untangler::move(const ColumnVector& start, double length, const ColumnVector& step) {
  parallel::for_ranges(window_.free, kGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t s = begin; s < end; ++s) {
      move_column(s, start, length, step);
      for (const double part : {0.5, 0.25, 0.125, 0.0}) {
        if (!keeps_side(surface_, shape_, s)) move_column(s, start, part * length, step);
      }
    }
  });
}

void Untangler::move_column(std::size_t s, const ColumnVector& start, double t,
                            const ColumnVector& step) {
  for (std::size_t k = shape_.first_free[s]; k < levels_; ++k) {
    const BoundarySet on = boundaries_of(s, k);
    const Vec3 x = start.get(s, k);
    shape_.points_world.set(s, k, moved_inside(surface_, on, x, x + t * step.get(s, k)));
  }
}

/// Shortens the step until the sum falls, or lengthens it while it does; 0 if it never falls.
Untangler::Found Untangler::search(const ColumnVector& start, const ColumnVector& step, Sum now) {
  const double slope = dot(gradient_, step);
  const double before = now.energy;
  for (double length = 1; length > 1e-6; length *= 0.5) {
    move(start, length, step);
    const Sum then = value();
    if (!(then.energy <= before + 1e-4 * length * slope)) continue;
    now = then;
    while (length >= 1) {
      move(start, 2 * length, step);
      const Sum farther = value();
      if (!(farther.energy < now.energy)) break;
      now = farther;
      length *= 2;
    }
    move(start, length, step);
    return {length, now};
  }
  shape_.points_world = start;
  return {0, now};
}

/// A step of the points; the sum with what is nearest on the wall as it was before has to fall, and
/// so has the sum with what is nearest then: across a bisector that is another part of it. While
/// all settles it may rise, or points would not get across.
TriadEnergy::Sum Untangler::advance(Until until, const ColumnVector& step, const Sum& before) {
  const ColumnVector start = shape_.points_world;
  auto [length, sum] = search(start, step, before);
  if (until == Until::Settled) {
    heights_.measure(shape_.points_world);
    return sum;
  }
  for (int n = 0; n < kShorter && length > 0; ++n) {
    heights_.measure(shape_.points_world);
    const Sum now = value();
    if (now.energy < before.energy) return now;
    length *= 0.4;
    move(start, length, step);
  }
  shape_.points_world = start;
  heights_.measure(shape_.points_world);
  return before;
}

/// Large enough for steps to get across from D < 0, small enough not to hide that.
void Untangler::choose_epsilon(double least, Until until) {
  constexpr double kWellOff = 0.05;
  if (least > kWellOff) {
    epsilon_ = 1e-9;
  } else {
    // Once settled, never more again: where D < 0 costs less, more of them would become negative.
    epsilon_ = std::min(most_, std::sqrt(floor_ * floor_ + 0.04 * least * least));
    if (until != Until::Settled) most_ = epsilon_;
    const bool is_valid = least > 1e-3 || (until == Until::Better && least > 0);
    if (is_valid) epsilon_ = std::min(epsilon_, 0.1 * least);
  }
}

/// How many steps it took.
int Untangler::run(Until until, const Progress& progress) {
  if (triads_.empty()) return 0;
  ColumnVector step(window_.nodes.size(), levels_);
  heights_.measure(shape_.points_world);
  Sum now = value();
  int steps = 0;
  int calm = 0;
  const int most = until == Until::Better ? kFewSteps : kMaxSteps;
  for (; steps < most && calm < 2; ++steps) {
    progress.check();
    choose_epsilon(now.least, until);
    const double least_before = now.least;
    now = expand();
    const double before = now.energy;
    solve(step);
    now = advance(until, step, now);
    const bool is_small = before - now.energy < kSmallStep * before;
    if (until == Until::Settled && is_hopeless(shape_, steps + 1)) return steps + 1;
    if (until == Until::Settled && (is_small || shape_.work > kMostToSettle)) break;
    if (now.least > 1e-3) {
      const bool rises = now.least > 1.02 * least_before && now.least < 0.3;
      calm = is_small && !rises ? calm + 1 : 0;
    } else if (is_small && !(now.least > 0.9 * least_before)) {
      floor_ *= 0.3;
      if (floor_ < kLastEpsilon) break;
    }
  }
  return steps;
}

}  // namespace

int untangle(const Surface& surface, Until until, WindowShape& shape, const Progress& progress) {
  return Untangler(surface, shape).run(until, progress);
}

}  // namespace vdb_offset
