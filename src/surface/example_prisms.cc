#include <array>
#include <cmath>
#include <numbers>
#include <utility>

#include "surface/example_grid.h"

// Prisms whose section is a ring of kites about the z axis, for walls with sharp inner edges.

namespace vdb_offset::example {

namespace {

constexpr double kWedgeRadius = 0.5;  // of the circle that its section circumscribes
constexpr double kTipRadius = 0.5;
constexpr double kValleyRadius = 0.25;

Vec3 on_circle(double radius, double angle) {
  return {radius * std::cos(angle), radius * std::sin(angle), 0};
}

/// The quadrilateral `centre`, `first`, `far`, `second`, counter-clockwise, `count` cells a side.
Patch kite(std::string name, const std::array<Vec3, 4>& corners, int count) {
  const auto& [centre, first, far, second] = corners;
  return transfinite(std::move(name), {line(centre, first, count), line(first, far, count),
                                       line(second, far, count), line(centre, second, count)});
}

}  // namespace

Patches wedge(const ExampleOptions& options) {
  // Three kites, with right angles where they meet the notch and each other. For every notch on
  // offer their other angles are 63 to 117 degrees.
  const double part = (2 * std::numbers::pi - options.angle) / 3;
  const int count = cells(options, kWedgeRadius);
  const Vec3 centre = Vec3::Zero();
  std::array<Vec3, 4> spoke;
  std::array<Vec3, 3> tip;
  for (std::size_t k = 0; k < 4; ++k) {
    const double angle = 0.5 * options.angle + static_cast<double>(k) * part;
    spoke[k] = on_circle(kWedgeRadius, angle);
    if (k < 3) tip[k] = on_circle(kWedgeRadius / std::cos(0.5 * part), angle + 0.5 * part);
  }

  Face face;
  for (std::size_t k = 0; k < 3; ++k) {
    face.parts.push_back(
        kite(std::to_string(k + 1), {centre, spoke[k], tip[k], spoke[k + 1]}, count));
  }
  const auto half = [count](const Vec3& a, const Vec3& b) { return line(a, b, count); };
  face.outline = {{"notch upper", half(centre, spoke[0])},
                  {"side 1", half(spoke[0], tip[0])},
                  {"side 2", join(half(tip[0], spoke[1]), half(spoke[1], tip[1]))},
                  {"side 3", join(half(tip[1], spoke[2]), half(spoke[2], tip[2]))},
                  {"side 4", half(tip[2], spoke[3])},
                  {"notch lower", half(spoke[3], centre)}};
  Patches patches = extrude(face, cells(options, 1));
  set_family(patches, "wedge");
  return patches;
}

Patches star(const ExampleOptions& options) {
  const int count = cells(options, 0.35);
  const int full = 8 * options.tips;  // steps of a turn
  const auto at = [full](double radius, int step) -> Vec3 {
    const Eigen::Vector2d p = radius * turn(step, full);
    return {p.x(), p.y(), 0};
  };
  Face face;
  for (int k = 0; k < options.tips; ++k) {
    const std::string name = std::to_string(k + 1);
    const Vec3 before = at(kValleyRadius, 8 * k + full - 4);
    const Vec3 tip = at(kTipRadius, 8 * k);
    const Vec3 after = at(kValleyRadius, 8 * k + 4);
    face.parts.push_back(kite(name, {Vec3::Zero(), before, tip, after}, count));
    face.outline.push_back({"rise " + name, line(before, tip, count)});
    face.outline.push_back({"fall " + name, line(tip, after, count)});
  }
  Patches patches = extrude(face, cells(options, 1));
  set_family(patches, "star");
  return patches;
}

}  // namespace vdb_offset::example
