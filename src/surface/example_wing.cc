#include <cmath>

#include "surface/example_grid.h"
#include "surface/naca_section.h"

// A straight wing of NACA 0012 section, its trailing edge blunt: x along the chord, y along the
// span, z up. The flat tip is a core about the chord and a rim that follows the outline, so that no
// corner lies on the round nose. The root lies in the plane y = 0, or on a cylinder: a fuselage.

namespace vdb_offset::example {

namespace {

constexpr double kHalfSpan = 2.0;
constexpr double kNose = 0.03;     // upper and lower patches begin here
constexpr double kCore = 0.04;     // the tip's core begins here ...
constexpr double kCorePart = 0.5;  // ... and is this part of the section's thickness there

double half_thickness(double x) { return NacaSection{}.half_thickness(x); }

/// Curves of the section in the plane y = 0, all from the nose to the tail or upward.
struct WingSection {
  Curve nose, upper, lower;
  Curve core_front, core_upper, core_lower;
  Curve rim_front_upper, rim_front_lower, rim_tail_upper, rim_tail_lower, core_tail;
};

Curve mirrored(Curve curve) {
  for (Vec3& p : curve) p.z() = -p.z();
  return curve;
}

WingSection make_section(const ExampleOptions& options) {
  const int nose_half = cells(options, 0.125);
  const int chord = cells(options, 1);
  const int rim = cells(options, 1.0 / 16);
  WingSection section;
  for (int k = -nose_half; k <= nose_half; ++k) {  // even steps of sqrt(x) follow the curvature
    const double s = static_cast<double>(k) / nose_half;
    const double x = kNose * s * s;
    section.nose.push_back({x, 0, std::copysign(half_thickness(x), s)});
  }
  // Equal cells across the trailing edge, which is thin: no narrower beside the lines along the
  // span than they need be.
  const double tail_part = static_cast<double>(nose_half) / (nose_half + rim);
  const double first = kNose * (2 - 1.0 / nose_half) / nose_half / (1 - kNose);
  for (const double t : stretch(chord, first, 0.35 / chord)) {
    const double x = kNose + (1 - kNose) * t;
    const double x_core = kCore + (1 - kCore) * t;
    section.upper.push_back({x, 0, half_thickness(x)});
    const double part = (1 - t) * kCorePart + t * tail_part;
    section.core_upper.push_back({x_core, 0, part * half_thickness(x_core)});
  }
  section.lower = mirrored(section.upper);
  section.core_lower = mirrored(section.core_upper);
  section.core_front = line(section.core_lower.front(), section.core_upper.front(), 2 * nose_half);
  section.core_tail = line(section.core_lower.back(), section.core_upper.back(), 2 * nose_half);
  section.rim_front_upper = line(section.core_upper.front(), section.upper.front(), rim);
  section.rim_tail_upper = line(section.core_upper.back(), section.upper.back(), rim);
  section.rim_front_lower = reversed(mirrored(section.rim_front_upper));
  section.rim_tail_lower = reversed(mirrored(section.rim_tail_upper));
  return section;
}

/// Where the lines along the span begin, and their fractions of the way to the tip.
struct Span {
  double fuselage_radius = 0;  ///< of a cylinder about the x axis; 0: the plane y = 0
  std::vector<double> fractions;

  double root(double z) const {
    const double r = fuselage_radius;
    return r > 0 ? std::sqrt((r - z) * (r + z)) : 0;
  }
};

/// `curve` swept from the root to the tip, i along the curve.
Patch sweep_span(std::string name, const Curve& curve, const Span& span) {
  const int ni = static_cast<int>(curve.size());
  const int nj = static_cast<int>(span.fractions.size());
  return tabulate(std::move(name), ni, nj, [&](int i, int j) -> Vec3 {
    const Vec3& p = curve[static_cast<std::size_t>(i)];
    const double t = span.fractions[static_cast<std::size_t>(j)];
    return {p.x(), (1 - t) * span.root(p.z()) + t * kHalfSpan, p.z()};
  });
}

/// A part of the tip; `sides` run along x and up, which looks inward.
Patch tip_part(std::string name, const Sides& sides) {
  return turned(moved(transfinite(std::move(name), sides), [](const Vec3& p) -> Vec3 {
    return {p.x(), kHalfSpan, p.z()};
  }));
}

Patches make_wing(const ExampleOptions& options, double fuselage_radius) {
  const WingSection s = make_section(options);
  const int count = cells(options, 1);
  const Span span{fuselage_radius, stretch(count, 1.6 / count, 0.25 / count)};
  const Curve tail = join(join(s.rim_tail_lower, s.core_tail), s.rim_tail_upper);

  Patches wing{sweep_span("upper", s.upper, span), turned(sweep_span("lower", s.lower, span)),
               sweep_span("nose", s.nose, span)};
  set_family(wing, "wing");
  Patches tip{
      tip_part("tip core", {s.core_lower, s.core_tail, s.core_upper, s.core_front}),
      tip_part("tip upper", {s.core_upper, s.rim_tail_upper, s.upper, s.rim_front_upper}),
      tip_part("tip lower", {s.lower, s.rim_tail_lower, s.core_lower, s.rim_front_lower}),
      tip_part("tip nose", {s.rim_front_lower, s.core_front, reversed(s.rim_front_upper), s.nose})};
  set_family(tip, "tip");
  Patch edge = turned(sweep_span("trailing edge", tail, span));
  edge.family = "trailing edge";

  wing.push_back(std::move(edge));
  wing.insert(wing.end(), tip.begin(), tip.end());
  stitch(wing);
  return wing;
}

}  // namespace

Patches naca0012_wing(const ExampleOptions& options) { return make_wing(options, 0); }

Patches wing_on_cylinder(const ExampleOptions& options) {
  return make_wing(options, kFuselageRadius);
}

}  // namespace vdb_offset::example
