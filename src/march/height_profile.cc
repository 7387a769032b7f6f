#include "march/height_profile.h"

#include <algorithm>
#include <cmath>

namespace vdb_offset {

namespace {

// An interval is left alone when its middle was predicted to this part: near enough for a Newton
// step on the exact distance to finish.
constexpr double kPrediction = 1e-5;
// The same for a column that stops short: near a focal point each exact distance costs a look at
// the whole wall.
constexpr double kPredictionShort = 1e-3;
// A start that is linear to this part at its middle and its end is taken as linear all along; where
// the slope is 1 that is a proof, since the distance changes no faster than the length.
constexpr double kLinear = 1e-10;
constexpr double kExact = 1e-9;  // relative miss of a level's height
// A Newton step that is shorter than this part of the height leaves no more than that: its miss is
// the step times the change of slope on the way.
constexpr double kShortStep = 1e-5;
constexpr int kMaxDepth = 13;

/// Cubic Hermite value at t in [0, 1] between (0, a) and (length, b).
template <typename Knot>
double hermite(const Knot& a, const Knot& b, double t) {
  const double length = b.s - a.s;
  const double u = 1 - t;
  return a.height + t * t * (3 - 2 * t) * (b.height - a.height) +
         length * t * u * (u * a.slope - t * b.slope);
}

}  // namespace

ColumnTracer::Height HeightProfile::height_at(double s) const {
  return home_ ? tracer_->own(*path_, s) : tracer_->exact(*path_, s);
}

void HeightProfile::refine(const Knot& a, const Knot& b, int depth) {
  const double s = 0.5 * (a.s + b.s);
  const auto [height, slope] = height_at(s);
  const Knot middle{s, height, slope};
  const bool done =
      std::abs(hermite(a, b, 0.5) - height) <= prediction_ * height || depth >= kMaxDepth;
  if (!done) refine(a, middle, depth + 1);
  knots_.push_back(middle);
  if (!done) refine(middle, b, depth + 1);
}

void HeightProfile::build(ColumnTracer& tracer, const ColumnPath& path, const ColumnEnd& end) {
  tracer_ = &tracer;
  path_ = &path;
  prediction_ = end.stop == Stop::Reached ? kPrediction : kPredictionShort;
  home_ = end.stop == Stop::Reached && tracer.stays_home(path, end);
  knots_.clear();
  const Knot wall{0, 0, end.slope_at_wall};
  knots_.push_back(wall);
  const double straight = std::min(path.knot(1).s_world, end.s_world);
  const auto at_straight = height_at(straight);
  const Knot first{straight, at_straight.height_world, at_straight.slope};
  refine(wall, first, 0);
  knots_.push_back(first);
  const auto is_linear = [&](const Knot& knot) {
    return std::abs(knot.height - wall.slope * knot.s) <= kLinear * knot.s;
  };
  linear_ = knots_.size() == 3 && is_linear(knots_[1]) && is_linear(knots_[2]) ? straight : 0;
  if (straight >= end.s_world) return;
  const auto at_end = height_at(end.s_world);
  const Knot last{end.s_world, end.height_world, at_end.slope};
  refine(first, last, 0);
  knots_.push_back(last);
}

double HeightProfile::length_at(double height_world, double from) {
  const double guess = predict(height_world);
  if (guess <= linear_) return guess;
  double s = std::max(guess, from);
  for (int n = 0; n < 5; ++n) {
    const auto [height, slope] = height_at(s);
    if (!(slope > 0.01) || std::abs(height - height_world) <= kExact * height_world) break;
    const double next = s - (height - height_world) / slope;
    if (!(next > from && next < knots_.back().s)) break;
    const bool is_last = std::abs(next - s) <= kShortStep * height_world && slope > 0.5;
    s = next;
    if (is_last) break;
  }
  return s;
}

double HeightProfile::predict(double height_world) const {
  const auto after = std::find_if(knots_.begin() + 1, knots_.end(),
                                  [&](const Knot& knot) { return knot.height >= height_world; });
  if (after == knots_.end()) return knots_.back().s;
  const Knot& a = *(after - 1);
  const Knot& b = *after;
  const double length = b.s - a.s;
  if (!(b.height > a.height) || !(length > 0)) return b.s;
  // Newton, kept inside a shrinking bracket.
  double lo = 0;
  double hi = 1;
  double t = (height_world - a.height) / (b.height - a.height);
  for (int n = 0; n < 60; ++n) {
    const double miss = hermite(a, b, t) - height_world;
    (miss > 0 ? hi : lo) = t;
    const double slope = 6 * t * (1 - t) * (b.height - a.height) +
                         length * ((1 - t) * (1 - 3 * t) * a.slope + t * (3 * t - 2) * b.slope);
    double next = slope > 0 ? t - miss / slope : 0.5 * (lo + hi);
    if (!(next > lo && next < hi)) next = 0.5 * (lo + hi);
    if (std::abs(next - t) <= 1e-15 || std::abs(miss) <= 1e-15 * height_world) break;
    t = next;
  }
  return a.s + t * length;
}

}  // namespace vdb_offset
