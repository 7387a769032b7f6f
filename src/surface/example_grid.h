#pragma once

#include <Eigen/Core>
#include <string>
#include <utility>
#include <vector>

#include "vdb_offset/core/vec.h"
#include "vdb_offset/surface/example.h"
#include "vdb_offset/surface/patch.h"

/// Grid making for the built-in surfaces: curves, fractions, transfinite patches.
namespace vdb_offset::example {

using Curve = Vec3List;

/// Of `fuselage`, on which the root of `wing-on-cylinder` ends.
inline constexpr double kFuselageRadius = 0.5;

/// `share` of the cells of a typical patch's side, rounded, at least `least`.
int cells(const ExampleOptions& options, double share, int least = 1);

/// Cosine and sine of `k / count` of a full turn, exactly periodic; k >= 0, four divides `count`.
Eigen::Vector2d turn(int k, int count);

/// `count` equal cells; bit for bit the reverse of the line from b to a.
Curve line(const Vec3& a, const Vec3& b, int count);

Curve reversed(Curve curve);

/// `second` continues `first`; their common point is kept once.
Curve join(Curve first, const Curve& second);

/// Fractions of a length, 0 to 1 in `count` cells that start near `first` and end near `last` (both
/// fractions of the length) and change smoothly between (Vinokur, On one-dimensional stretching
/// functions for finite-difference calculations, 1983).
std::vector<double> stretch(int count, double first, double last);

/// The four sides of a patch: south and north run along i, west and east along j.
struct Sides {
  Curve south, east, north, west;
};

/// Coons patch: its sides hold exactly the points of `sides` (south and north win at corners).
Patch transfinite(std::string name, const Sides& sides);

/// The same points with i reversed: the normal turns over.
Patch turned(Patch patch);

/// A patch of `ni x nj` points `point(i, j)`.
template <class Point>
Patch tabulate(std::string name, int ni, int nj, Point&& point) {
  Patch patch{std::move(name), {}, ni, nj, {}};
  patch.points_world.reserve(static_cast<std::size_t>(ni) * static_cast<std::size_t>(nj));
  for (int j = 0; j < nj; ++j) {
    for (int i = 0; i < ni; ++i) patch.points_world.push_back(point(i, j));
  }
  return patch;
}

/// Replace every point by `move(point)`.
template <class Move>
Patch moved(Patch patch, Move&& move) {
  for (Vec3& p : patch.points_world) p = move(p);
  return patch;
}

/// A face in z = 0: the parts that fill it, their normals along z, and its outline's curves, which
/// run round it counter-clockwise.
struct Face {
  struct Edge {
    std::string name;
    Curve curve;
  };
  Patches parts;
  std::vector<Edge> outline;
};

/// The closed bar on `face`, from z = 0 to z = 1 in `count` cells: a patch for each curve of its
/// outline, then of each part a "near end" (z = 0) and a "far end"; stitched, outward.
Patches extrude(const Face& face, int count);

void set_family(Patches& patches, const std::string& family);

/// Make side points that agree to rounding equal bit for bit.
///
/// The same curve, computed for two patches by two formulas, differs in its last bits; every such
/// point takes the coordinates of the first patch that has it.
void stitch(Patches& patches);

// The builders, one for each name.
Patches sphere(const ExampleOptions& options);
Patches cube(const ExampleOptions& options);
Patches torus(const ExampleOptions& options);
Patches bumpy_torus(const ExampleOptions& options);
Patches sphere_pair(const ExampleOptions& options);
Patches l_bar(const ExampleOptions& options);
Patches u_slot(const ExampleOptions& options);
Patches wedge(const ExampleOptions& options);
Patches star(const ExampleOptions& options);
Patches naca0012_wing(const ExampleOptions& options);
Patches draft_tube(const ExampleOptions& options);
Patches quarter_cylinder(const ExampleOptions& options);
Patches wing_on_cylinder(const ExampleOptions& options);
Patches fuselage(const ExampleOptions& options);
Patches channel(const ExampleOptions& options);
Patches airfoil(const ExampleOptions& options);
Patches circle(const ExampleOptions& options);

}  // namespace vdb_offset::example
