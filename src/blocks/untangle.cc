// Garanzha, Kaporin, Kudryavtseva, Protais, Ray, Sokolov, Foldover-free maps in 50 lines of code,
// 2021, with a term that holds levels to their distance. Truncated Newton: Nocedal, Wright,
// Numerical Optimization, 2006, chapter 7.

#include "blocks/untangle.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <limits>

namespace vdb_offset {
namespace {

double env(const char* name, double preset) {
  const char* text = std::getenv(name);
  return text ? std::atof(text) : preset;
}

double kHeightWeight = env("VO_W", 8);
int kMaxSteps = int(env("VO_STEPS", 80));
int kMaxInner = int(env("VO_INNER", 100));
double kForcing = env("VO_FORCING", 0.1);

std::size_t at(int index) { return static_cast<std::size_t>(index); }

double dot(const ColumnVector& a, const ColumnVector& b) {
  double sum = 0;
  const std::vector<double>& x = a.values();
  const std::vector<double>& y = b.values();
  for (std::size_t n = 0; n < x.size(); ++n) sum += x[n] * y[n];
  return sum;
}

/// y += factor x
void add(ColumnVector& y, double factor, const ColumnVector& x) {
  for (std::size_t n = 0; n < x.values().size(); ++n) y.values()[n] += factor * x.values()[n];
}

/// The plane that stands for the distance near a point, and the height that the point should have.
struct HeightTerm {
  struct Plane {
    Vec3 normal = Vec3::Zero();
    double offset = 0;  // phi = normal . x + offset
    double distance(const Vec3& x) const { return normal.dot(x) + offset; }
  };
  std::array<Plane, 2> plane;
  std::size_t count = 0;
  Plane other;  // the last one in another direction
  double height = 0;
  double layer = 0;

  double weight() const { return kHeightWeight / (layer * layer * static_cast<double>(count)); }
  /// A new nearest plane; beside it stays the last one in another direction, while it is as near.
  void see(const Plane& nearest, const Vec3& x) {
    constexpr double kOtherWay = 0.9;
    if (count > 0 && plane[0].normal.dot(nearest.normal) < kOtherWay) other = plane[0];
    plane[0] = nearest;
    count = 1;
    if (!(other.normal.squaredNorm() > 0) || other.normal.dot(nearest.normal) > kOtherWay) return;
    if (std::abs(other.distance(x) - nearest.distance(x)) < 0.25 * layer) plane[count++] = other;
  }
};

/// As long as on the wall, or as the columns have spread.
std::vector<double> lengths_of(const ColumnVector& x, std::size_t a, std::size_t b) {
  std::vector<double> lengths(x.levels());
  for (std::size_t k = 0; k < lengths.size(); ++k) {
    lengths[k] = (x.get(a, k) - x.get(b, k)).norm();
    if (k > 0) lengths[k] = std::max(lengths[0], lengths[k] - lengths[0]);
  }
  return lengths;
}

CornerIdeal ideal_of(const ColumnVector& x, const Corner& corner) {
  constexpr double kSharpest = 0.94;  // cosine of 20 degrees: a needle on the wall stays one
  const Vec3 a = x.get(at(corner.next), 0) - x.get(at(corner.column), 0);
  const Vec3 b = x.get(at(corner.previous), 0) - x.get(at(corner.column), 0);
  const double lengths = a.norm() * b.norm();
  const double cosine = lengths > 0 ? a.dot(b) / lengths : 0;
  return {lengths_of(x, at(corner.next), at(corner.column)),
          lengths_of(x, at(corner.previous), at(corner.column)),
          std::clamp(cosine, -kSharpest, kSharpest)};
}

class Untangler {
 public:
  Untangler(const Surface& surface, const Window& window, WindowShape& shape);
  UntangleReport run(const Progress& progress);

 private:
  void measure_heights();
  CornerEnergy::Sum value();
  CornerEnergy::Sum expand();
  void hold(ColumnVector& v) const;
  int solve(ColumnVector& step);
  void move_to(const ColumnVector& start, double length, const ColumnVector& step);
  double search(const ColumnVector& step, CornerEnergy::Sum& now);

  const Surface& surface_;
  const Window& window_;
  WindowShape& shape_;
  std::size_t levels_;
  std::vector<Corner> corners_;
  std::vector<HeightTerm> terms_;  // free slot by free slot
  CornerEnergy energy_;
  ColumnSystem system_;
  ColumnVector gradient_;
};

Untangler::Untangler(const Surface& surface, const Window& window, WindowShape& shape)
    : surface_(surface),
      window_(window),
      shape_(shape),
      levels_(shape.points_world.levels()),
      terms_(window.free * levels_),
      energy_(levels_),
      system_(window, levels_),
      gradient_(window.nodes.size(), levels_) {
  for (const ColumnFace& face : window.faces) {
    for (std::size_t c = 0; c < face.count; ++c) {
      Corner corner{face.column[c], face.next(c), face.previous(c), {}};
      const int lowest = std::min({corner.column, corner.next, corner.previous});
      if (at(lowest) >= window.free) continue;
      corner.ideal = ideal_of(shape.points_world, corner);
      if (!(corner.ideal.first_world[0] > 0 && corner.ideal.second_world[0] > 0)) continue;
      corners_.push_back(corner);
    }
  }
  for (std::size_t s = 0; s < window.free; ++s) {
    const std::vector<double>& heights = shape.heights_world[s];
    for (std::size_t k = 1; k < levels_; ++k) {
      double layer = heights[k] - heights[k - 1];
      if (k + 1 < levels_) layer = std::min(layer, heights[k + 1] - heights[k]);
      terms_[s * levels_ + k].height = heights[k];
      terms_[s * levels_ + k].layer = layer;
    }
  }
}

void Untangler::measure_heights() {
  const Boundaries* boundaries = surface_.boundaries.get();
  for (std::size_t s = 0; s < window_.free; ++s) {
    int guess = -1;
    for (std::size_t k = 1; k < levels_; ++k) {
      HeightTerm& term = terms_[s * levels_ + k];
      const Vec3 x = shape_.points_world.get(s, k);
      Vec3 place;
      double distance = 0;
      if (boundaries != nullptr && !boundaries->empty()) {
        const Folded folded = boundaries->fold(x);
        const WallPoint near = surface_.wall->closest_from(guess, folded.point_world());
        guess = near.triangle;
        place = folded.unfold(near.point_world);
        distance = near.distance_world;
      } else {
        const WallPoint near = surface_.wall->closest_from(guess, x);
        guess = near.triangle;
        place = near.point_world;
        distance = near.distance_world;
      }
      if (!(distance > 0)) continue;
      const Vec3 normal = (x - place) / distance;
      term.see({normal, distance - normal.dot(x)}, x);
    }
  }
}

CornerEnergy::Sum Untangler::value() {
  CornerEnergy::Sum sum{0, std::numeric_limits<double>::infinity()};
  for (const Corner& corner : corners_) {
    const CornerEnergy::Sum part =
        energy_.value(corner, shape_.points_world, shape_.heights_world[at(corner.column)]);
    sum.energy += part.energy;
    sum.least = std::min(sum.least, part.least);
  }
  for (std::size_t s = 0; s < window_.free; ++s) {
    for (std::size_t k = 1; k < levels_; ++k) {
      const HeightTerm& term = terms_[s * levels_ + k];
      for (std::size_t n = 0; n < term.count; ++n) {
        const double off = term.plane[n].distance(shape_.points_world.get(s, k)) - term.height;
        sum.energy += term.weight() * off * off;
      }
    }
  }
  return sum;
}

CornerEnergy::Sum Untangler::expand() {
  std::fill(gradient_.values().begin(), gradient_.values().end(), 0.0);
  system_.clear();
  CornerEnergy::Sum sum{0, std::numeric_limits<double>::infinity()};
  for (const Corner& corner : corners_) {
    const CornerEnergy::Sum part =
        energy_.expand(corner, shape_.points_world, shape_.heights_world[at(corner.column)],
                       gradient_, system_);
    sum.energy += part.energy;
    sum.least = std::min(sum.least, part.least);
  }
  for (std::size_t s = 0; s < window_.free; ++s) {
    for (std::size_t k = 1; k < levels_; ++k) {
      const HeightTerm& term = terms_[s * levels_ + k];
      for (std::size_t n = 0; n < term.count; ++n) {
        const Vec3& normal = term.plane[n].normal;
        const double off = term.plane[n].distance(shape_.points_world.get(s, k)) - term.height;
        sum.energy += term.weight() * off * off;
        gradient_.set(s, k, gradient_.get(s, k) + 2 * term.weight() * off * normal);
        system_.add_diagonal(s, k, 2 * term.weight() * normal * normal.transpose());
      }
    }
  }
  hold(gradient_);
  return sum;
}

/// The part of a vector that the boundaries leave free, and nothing at level 0 or on fixed columns.
void Untangler::hold(ColumnVector& v) const {
  for (std::size_t s = 0; s < window_.nodes.size(); ++s) {
    for (std::size_t a = 0; a < 3; ++a) {
      v.at(s, a)[0] = 0;
      if (s < window_.free) continue;
      std::fill_n(v.at(s, a), levels_, 0.0);
    }
    if (s >= window_.free) continue;
    const BoundarySet on = surface_.boundaries_of(at(shape_.surface_node[s]));
    if (on == 0) continue;
    for (std::size_t k = 1; k < levels_; ++k) {
      const Vec3 value = v.get(s, k);
      const double length = value.norm();
      if (!(length > 0)) continue;
      const Vec3 along = surface_.boundaries->along(on, shape_.points_world.get(s, k), value);
      v.set(s, k, along.dot(value) * along);
    }
  }
}

/// Conjugate gradients on the Newton equation.
int Untangler::solve(ColumnVector& step) {
  system_.factor_columns();
  std::fill(step.values().begin(), step.values().end(), 0.0);
  ColumnVector r = gradient_;
  for (double& value : r.values()) value = -value;
  ColumnVector z(window_.nodes.size(), levels_);
  ColumnVector q = z;
  system_.solve_columns(r, z);
  hold(z);
  ColumnVector p = z;
  double rz = dot(r, z);
  const double first = rz;
  int n = 0;
  for (; n < kMaxInner && rz > kForcing * kForcing * first && rz > 0; ++n) {
    system_.multiply(p, q);
    hold(q);
    const double pq = dot(p, q);
    if (!(pq > 0)) break;
    const double alpha = rz / pq;
    add(step, alpha, p);
    add(r, -alpha, q);
    system_.solve_columns(r, z);
    hold(z);
    const double next = dot(r, z);
    const double beta = next / rz;
    rz = next;
    for (std::size_t i = 0; i < p.values().size(); ++i) {
      p.values()[i] = z.values()[i] + beta * p.values()[i];
    }
  }
  return n;
}

void Untangler::move_to(const ColumnVector& start, double length, const ColumnVector& step) {
  shape_.points_world = start;
  for (std::size_t s = 0; s < window_.free; ++s) {
    const BoundarySet on = surface_.boundaries_of(at(shape_.surface_node[s]));
    for (std::size_t k = 1; k < levels_; ++k) {
      Vec3 x = start.get(s, k) + length * step.get(s, k);
      if (on != 0) x = surface_.boundaries->hold(on, x);
      shape_.points_world.set(s, k, x);
    }
  }
}

/// Shortens the step until the energy falls; its length, 0 if it never does.
double Untangler::search(const ColumnVector& step, CornerEnergy::Sum& now) {
  const ColumnVector start = shape_.points_world;
  const double slope = dot(gradient_, step);
  const double before = now.energy;
  for (double length = 1; length > 1e-6; length *= 0.5) {
    move_to(start, length, step);
    const CornerEnergy::Sum then = value();
    if (!(then.energy <= before + 1e-4 * length * slope)) continue;
    now = then;
    if (length < 1) return length;
    for (;;) {
      length *= 2;
      move_to(start, length, step);
      const CornerEnergy::Sum farther = value();
      if (!(farther.energy < now.energy)) break;
      now = farther;
    }
    length *= 0.5;
    move_to(start, length, step);
    return length;
  }
  shape_.points_world = start;
  return 0;
}

UntangleReport Untangler::run(const Progress& progress) {
  UntangleReport report;
  if (corners_.empty()) return report;
  const double corners = static_cast<double>(corners_.size() * 2 * (levels_ - 1));
  ColumnVector step(window_.nodes.size(), levels_);
  energy_.epsilon = 1e-9;
  measure_heights();
  CornerEnergy::Sum now = value();
  double floor = 1e-2;
  int calm = 0;
  for (; report.steps < kMaxSteps; ++report.steps) {
    progress.check();
    measure_heights();
    energy_.epsilon = now.least > 0.05 ? 1e-9 : std::sqrt(floor * floor + 0.04 * now.least * now.least);
    if (now.least > 1e-3 && now.least <= 0.05) energy_.epsilon = std::min(energy_.epsilon, 0.1 * now.least);
    now = expand();
    const double before = now.energy;
    const double least_before = now.least;
    const int inner = solve(step);
    report.inner_steps += inner;
    const double length = search(step, now);
    if (std::getenv("VO_TALK"))
      std::fprintf(stderr, "   step %d: eps %.2e energy %.6f -> %.6f least %.3e inner %d length %.3g\n",
                   report.steps, energy_.epsilon, before / corners, now.energy / corners, now.least, inner, length);
    const bool small = before - now.energy < 1e-3 * before;
    const bool rises = now.least > 1.02 * least_before && now.least < 0.3;
    if (now.least > 1e-3) {
      calm = small && !rises ? calm + 1 : 0;
      if (calm >= 2) { report.settled = true; break; }
    } else if (small) {
      floor = std::max(floor * 0.3, 1e-9);
    }
    if (length == 0 && now.least > 0) break;
    if (length == 0 && floor < 1e-8) break;
  }
  if (std::getenv("VO_TALK")) {
    std::vector<std::pair<double, const Corner*>> order;
    for (const Corner& c : corners_)
      order.emplace_back(energy_.value(c, shape_.points_world, shape_.heights_world[at(c.column)]).energy, &c);
    std::sort(order.begin(), order.end(), [](auto& a, auto& b) { return a.first > b.first; });
    for (int n = 0; n < 6; ++n) {
      const Corner& c = *order[n].second;
      const Vec3 x = shape_.points_world.get(at(c.column), 0);
      const auto sum = energy_.value(c, shape_.points_world, shape_.heights_world[at(c.column)]);
      std::fprintf(stderr, "  worst corner energy %.3f least %.3e at wall (%.3f %.3f %.3f) slots %d %d %d of %zu ideal %.3g %.3g %.3g\n",
                   order[n].first, sum.least, x[0], x[1], x[2], c.column, c.next, c.previous, window_.free,
                   c.ideal.first_world[0], c.ideal.second_world[0], c.ideal.cosine);
    }
  }
  report.energy = now.energy / corners;
  report.least = now.least;
  return report;
}

}  // namespace

UntangleReport untangle(const Surface& surface, const Window& window, WindowShape& shape,
                        const Progress& progress) {
  return Untangler(surface, window, shape).run(progress);
}

}  // namespace vdb_offset
