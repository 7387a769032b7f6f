#include <algorithm>
#include <cmath>
#include <numbers>

#include "surface/example_grid.h"
#include "surface/naca_section.h"

// Bodies in the plane z = 0: closed curves, counter-clockwise.

namespace vdb_offset::example {

namespace {

Patch curve_patch(std::string name, Curve curve) {
  return {std::move(name), {}, static_cast<int>(curve.size()), 1, std::move(curve)};
}

/// From the trailing edge over the upper surface, round the nose, and back.
Curve airfoil_loop(const NacaSection& section, int count) {
  // Even angles of a half circle over the chord; k / count is exact where x is 0 or 1.
  const auto x = [count](int k) {
    const double s = std::sin(0.5 * std::numbers::pi * k / count);
    return k == count ? 1.0 : s * s;
  };
  Curve loop;
  for (int k = count; k > 0; --k) loop.push_back(section.point(x(k), 1));
  for (int k = 0; k <= count; ++k) loop.push_back(section.point(x(k), -1));
  loop[static_cast<std::size_t>(count)].y() += 0.0;  // the nose: no -0
  if (section.sharp) loop.back() = loop.front();
  return loop;
}

}  // namespace

Patches airfoil(const ExampleOptions& options) {
  NacaSection section = parse_naca(options.naca);
  section.sharp = options.closed;
  const Curve loop = airfoil_loop(section, options.points - 1);
  Patches patches{curve_patch("airfoil", loop)};
  set_family(patches, "airfoil");
  if (options.closed) return patches;
  const double base = (loop.front() - loop.back()).norm();
  const double edge = (loop[1] - loop[0]).norm();
  const int most = static_cast<int>(loop.size()) - 1;
  const int count = static_cast<int>(std::clamp(std::round(base / edge), 1.0, most * 1.0));
  patches.push_back(curve_patch("trailing edge", line(loop.back(), loop.front(), count)));
  patches.back().family = "trailing edge";
  return patches;
}

Patches circle(const ExampleOptions& options) {
  const int count = 4 * (options.points - 1);
  Curve curve;
  for (int k = 0; k <= count; ++k) {
    const Eigen::Vector2d p = 0.5 * turn(k % count, count);
    curve.push_back({p.x(), p.y(), 0});
  }
  Patches patches{curve_patch("circle", std::move(curve))};
  set_family(patches, "circle");
  return patches;
}

}  // namespace vdb_offset::example
