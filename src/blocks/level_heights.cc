#include "blocks/level_heights.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include "blocks/nearest_image.h"
#include "core/parallel.h"

namespace vdb_offset {
namespace {

/// What a level costs that is off by its layer, against 1 for each triad of a cell: more makes
/// corners worse where levels have no room, less lets levels sink.
constexpr double kWeight = 2;
/// How much more the outer level counts: its layer is the thickest, and its distance was asked for.
constexpr double kOuter = 6;
/// And the first, which was asked for too: what is about the corner of a coarse wall pulls at it.
constexpr double kFirst = 60;
/// A point that moved by less than this part of its layer keeps its planes: where the wall is
/// curved they are off by half the square of it.
constexpr double kStill = 0.03;
constexpr std::size_t kGrain = 16;  // columns

/// By slot, the largest weight of a face there: where cells count more, heights do too, or they
/// would give way.
std::vector<double> weights_beside(const WindowShape& shape) {
  std::vector<double> weights(shape.window.nodes.size(), 1.0);
  for (std::size_t f = 0; f < shape.goals.size(); ++f) {
    const ColumnFace& face = shape.window.faces[f];
    for (std::size_t c = 0; c < face.count; ++c) {
      double& own = weights[static_cast<std::size_t>(face.column[c])];
      own = std::max(own, shape.goals[f].weight);
    }
  }
  return weights;
}

}  // namespace

LevelHeights::LevelHeights(const Surface& surface, const WindowShape& shape)
    : surface_(surface), levels_(shape.points_world.levels()), terms_(shape.window.free * levels_) {
  const std::vector<double> beside = weights_beside(shape);
  for (std::size_t s = 0; s < shape.window.free; ++s) {
    const std::vector<double>& heights = shape.heights_world[s];
    // On a boundary half of the cells around it are missing, and half of what holds it counts: with
    // their images the sum would be twice as much.
    const BoundarySet on = surface.boundaries_of(static_cast<std::size_t>(shape.window.nodes[s]));
    const double shares = std::ldexp(1.0, -std::popcount(on));
    for (std::size_t k = shape.first_free[s]; k < levels_; ++k) {
      Term& term = terms_[s * levels_ + k];
      term.height = heights[k];
      const double own = k + 1 == levels_ ? kOuter : k == 1 ? kFirst : 1;
      term.wanted = kWeight * beside[s] * shares * own;
      term.layer = heights[k] - heights[k - 1];
      if (k + 1 < levels_) term.layer = std::min(term.layer, heights[k + 1] - heights[k]);
    }
  }
}

LevelHeights::Plane LevelHeights::nearest_plane(const Vec3& x, int& guess) const {
  const WallPoint near = nearest_image(surface_, x, guess);
  if (!(near.distance_world > 0)) return {};
  const Vec3 normal = (x - near.point_world) / near.distance_world;
  return {normal, near.distance_world - normal.dot(x)};
}

/// The plane of the nearest part of the wall; then, a little farther from all that were found,
/// those of parts that are nearer there.
void LevelHeights::find_planes(const Vec3& x, Term& term, int& guess) const {
  constexpr double kOtherWay = 0.9;  // cosine
  constexpr double kAsNear = 0.25;   // layers
  Vec3 away = Vec3::Zero();
  int last = guess;
  for (std::size_t n = 0; n < term.plane.size(); ++n) {
    const Plane plane = nearest_plane(x + kAsNear * term.layer * away, n == 0 ? guess : last);
    if (!(plane.normal.squaredNorm() > 0)) break;
    if (n == 0) {
      last = guess;
    } else {
      if (std::abs(plane.distance(x) - term.plane[0].distance(x)) > kAsNear * term.layer) break;
      bool is_new = true;
      for (std::size_t m = 0; m < n; ++m) {
        is_new = is_new && plane.normal.dot(term.plane[m].normal) < kOtherWay;
      }
      if (!is_new) break;
    }
    term.plane[n] = plane;
    term.count = n + 1;
    away += plane.normal;
  }
}

void LevelHeights::measure(const ColumnVector& x) {
  const std::size_t free = terms_.size() / levels_;
  parallel::for_ranges(free, kGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t s = begin; s < end; ++s) {
      int guess = -1;
      for (std::size_t k = 1; k < levels_; ++k) {
        Term& term = terms_[s * levels_ + k];
        if (!(term.layer > 0)) continue;  // held
        const Vec3 point = x.get(s, k);
        if ((point - term.taken_at).norm() < kStill * term.layer) continue;
        term.taken_at = point;
        find_planes(point, term, guess);
        if (term.count == 0) continue;
        term.weight = term.wanted / (term.layer * term.layer * static_cast<double>(term.count));
      }
    }
  });
}

/// body(level, weight, normal, how far off) for each plane of a column.
template <typename Visit>
void LevelHeights::visit(const ColumnVector& x, std::size_t slot, const Visit& body) const {
  for (std::size_t k = 1; k < levels_; ++k) {
    const Term& term = terms_[slot * levels_ + k];
    const Vec3 point = x.get(slot, k);
    for (std::size_t n = 0; n < term.count; ++n) {
      body(k, term.weight, term.plane[n].normal, term.plane[n].distance(point) - term.height);
    }
  }
}

double LevelHeights::value(const ColumnVector& x) const {
  const std::size_t free = terms_.size() / levels_;
  std::vector<double> sums(free, 0.0);
  parallel::for_ranges(free, kGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t s = begin; s < end; ++s) {
      visit(x, s, [&](std::size_t, double weight, const Vec3&, double off) {
        sums[s] += weight * off * off;
      });
    }
  });
  double sum = 0;
  for (const double part : sums) sum += part;
  return sum;
}

void LevelHeights::expand(const ColumnVector& x, ColumnVector& gradient,
                          ColumnSystem& hessian) const {
  const std::size_t free = terms_.size() / levels_;
  parallel::for_ranges(free, kGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t s = begin; s < end; ++s) {
      visit(x, s, [&](std::size_t k, double weight, const Vec3& normal, double off) {
        gradient.set(s, k, gradient.get(s, k) + 2 * weight * off * normal);
        hessian.add_diagonal(s, k, 2 * weight * normal * normal.transpose());
      });
    }
  });
}

}  // namespace vdb_offset
