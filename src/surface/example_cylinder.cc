#include "surface/example_grid.h"

// Circular cylinders cut open: points of neighbouring patches come from the same formula with the
// same arguments, and so agree bit for bit.

namespace vdb_offset::example {

namespace {

constexpr double kRadius = 0.5;

// The caps' core is a quadrilateral with one corner on the axis, two on the planes at this part of
// the radius, and one at this part of x and of y: 72 degrees at the planes, 126 at the last corner.
constexpr double kCoreOnPlane = 0.5;
constexpr double kCoreCorner = 0.38;

/// Points of the quarter circle from y = 0 to x = 0 in the plane z = 0, `2 * half` cells.
struct Quarter {
  int half;

  Vec3 at(int k) const {
    const Eigen::Vector2d p = kRadius * turn(k, 8 * half);
    return {p.x(), p.y(), 0};
  }
  Curve arc(int from, int to) const {
    Curve curve{at(from)};
    for (int k = from; k != to;) curve.push_back(at(k += from < to ? 1 : -1));
    return curve;
  }
};

/// The quarter disc in the plane z = 0, normals up: a core about the axis and two rim patches.
Patches quarter_disc(const Quarter& quarter, int rim) {
  const Vec3 on_x(kCoreOnPlane * kRadius, 0, 0);
  const Vec3 on_y(0, kCoreOnPlane * kRadius, 0);
  const Vec3 corner(kCoreCorner * kRadius, kCoreCorner * kRadius, 0);
  const int half = quarter.half;
  const Curve core_east = line(on_x, corner, half);
  const Curve core_north = line(on_y, corner, half);
  const Curve diagonal = line(corner, quarter.at(half), rim);
  return {transfinite("core", {line(Vec3::Zero(), on_x, half), core_east, core_north,
                               line(Vec3::Zero(), on_y, half)}),
          transfinite("rim x",
                      {line(on_x, quarter.at(0), rim), quarter.arc(0, half), diagonal, core_east}),
          transfinite("rim y", {core_north, diagonal, quarter.arc(2 * half, half),
                                line(on_y, quarter.at(2 * half), rim)})};
}

/// The cap in z = 1 (top) or z = 0 (bottom), its normals out of the cylinder.
Patches cap(const Quarter& quarter, int rim, bool top) {
  const std::string family = top ? "top" : "bottom";
  const auto lift = [](const Vec3& p) -> Vec3 { return {p.x(), p.y(), 1}; };
  Patches parts = quarter_disc(quarter, rim);
  for (Patch& part : parts) {
    part = top ? moved(std::move(part), lift) : turned(std::move(part));
    part.name = family + " " + part.name;
    part.family = family;
  }
  return parts;
}

}  // namespace

Patches quarter_cylinder(const ExampleOptions& options) {
  const Quarter quarter{cells(options, 0.5)};
  const int height = cells(options, 1);
  Patches patches{tabulate("side", 2 * quarter.half + 1, height + 1, [&](int i, int j) -> Vec3 {
    return quarter.at(i) + Vec3(0, 0, static_cast<double>(j) / height);
  })};
  patches.front().family = "side";
  for (const bool top : {true, false}) {
    for (Patch& part : cap(quarter, cells(options, 0.375), top)) patches.push_back(std::move(part));
  }
  return patches;
}

Patches fuselage(const ExampleOptions& options) {
  // Quads leave the cylinder in the middle of their arcs, by 1 - cos(arc / 2) of the radius.
  const int eighth = cells(options, 1);
  const Curve axis = line(Vec3(-4, 0, 0), Vec3(5, 0, 0), cells(options, 4));
  Patches patches;
  int first = 7 * eighth;  // each patch is centred on an axis: no seam near the wing's root
  for (const char* name : {"y max", "z max", "y min", "z min"}) {
    const auto point = [&](int i, int j) -> Vec3 {
      const Eigen::Vector2d p = kFuselageRadius * turn(first + i, 8 * eighth);
      return {axis[static_cast<std::size_t>(j)].x(), p.x(), p.y()};
    };
    patches.push_back(tabulate(name, 2 * eighth + 1, static_cast<int>(axis.size()), point));
    first += 2 * eighth;
  }
  set_family(patches, "fuselage");
  return patches;
}

}  // namespace vdb_offset::example
