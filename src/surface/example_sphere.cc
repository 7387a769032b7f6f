#include <cmath>
#include <numbers>

#include "surface/example_grid.h"

// Bodies whose shared points come out equal by symmetry of the formulas alone.

namespace vdb_offset::example {

namespace {

/// The six faces of the cube [-1, 1]^3, normals outward, on the lines `t` (from -1 to 1).
Patches cube_faces(const std::vector<double>& t) {
  static constexpr const char* kAxis[3] = {"x", "y", "z"};
  Patches patches;
  const int n = static_cast<int>(t.size());
  for (int face = 0; face < 6; ++face) {
    const int d = face / 2;
    const bool far = face % 2 == 1;
    const std::string name = std::string(kAxis[d]) + (far ? " max" : " min");
    patches.push_back(tabulate(name, n, n, [&](int i, int j) {
      Vec3 p;
      p[d] = far ? 1.0 : -1.0;
      p[(d + 1) % 3] = t[static_cast<std::size_t>(far ? i : j)];
      p[(d + 2) % 3] = t[static_cast<std::size_t>(far ? j : i)];
      return p;
    }));
  }
  return patches;
}

Patches unit_sphere(int count) {
  std::vector<double> t;
  for (int k = 0; k <= count; ++k) {
    t.push_back(std::tan(0.25 * std::numbers::pi * (2 * k - count) / count));
  }
  t.front() = -1;  // so that faces meet exactly: tan(pi / 4) is not 1 in floating point
  t.back() = 1;
  Patches patches = cube_faces(t);
  for (Patch& patch : patches) {
    patch = moved(std::move(patch), [](const Vec3& p) -> Vec3 { return p / p.norm(); });
  }
  return patches;
}

}  // namespace

Patches sphere(const ExampleOptions& options) {
  Patches patches = unit_sphere(cells(options, 1));
  set_family(patches, "sphere");
  return patches;
}

Patches sphere_pair(const ExampleOptions& options) {
  Patches patches;
  for (int body = 1; body <= 2; ++body) {
    const std::string family = "body " + std::to_string(body);
    const Vec3 centre((body == 1 ? -1 : 1) * (1 + 0.5 * options.gap), 0, 0);
    for (Patch& patch : unit_sphere(cells(options, 1))) {
      patch = moved(std::move(patch), [&](const Vec3& p) -> Vec3 { return p + centre; });
      patch.name = family + " " + patch.name;
      patch.family = family;
      patches.push_back(std::move(patch));
    }
  }
  return patches;
}

Patches cube(const ExampleOptions& options) {
  const int n = cells(options, 1);
  std::vector<double> t;
  for (int k = 0; k <= n; ++k) t.push_back(static_cast<double>(2 * k - n) / n);
  Patches patches = cube_faces(t);
  for (Patch& patch : patches) {
    patch = moved(std::move(patch), [](const Vec3& p) -> Vec3 { return 0.5 * p; });
  }
  set_family(patches, "cube");
  return patches;
}

namespace {

/// Bumps of a height, 9 around and 4 about the tube: about as long as wide.
Patches torus_of(const ExampleOptions& options, double bump, const std::string& family) {
  constexpr double kMajor = 1.0;
  constexpr double kMinor = 0.4;
  const int n = cells(options, 1);
  Patches patches;
  for (int part = 0; part < 8; ++part) {
    const bool inner = part >= 4;
    const std::string name = (inner ? "inner " : "outer ") + std::to_string(part % 4 + 1);
    patches.push_back(tabulate(name, n + 1, n + 1, [&](int i, int j) -> Vec3 {
      const int at_ring = (part % 4) * n + i;
      // Half a turn of the tube a patch, from its lowest line (outer) or its highest (inner).
      const int at_tube = (inner ? n : 3 * n) + 2 * j;
      const Eigen::Vector2d ring = turn(at_ring, 4 * n);
      const Eigen::Vector2d tube = turn(at_tube, 4 * n);
      const double height = bump * turn(9 * at_ring, 4 * n).y() * turn(4 * at_tube, 4 * n).y();
      const double radius = kMajor + (kMinor + height) * tube.x();
      return {radius * ring.x(), radius * ring.y(), (kMinor + height) * tube.y()};
    }));
  }
  set_family(patches, family);
  return patches;
}

}  // namespace

Patches torus(const ExampleOptions& options) { return torus_of(options, 0, "torus"); }

Patches bumpy_torus(const ExampleOptions& options) {
  return torus_of(options, 0.05, "bumpy torus");
}

}  // namespace vdb_offset::example
