#pragma once

// Small surfaces whose distances are known by formula.

#include <array>
#include <functional>
#include <optional>
#include <random>
#include <string>

#include "vdb_offset/surface/patch.h"
#include "vdb_offset/surface/surface.h"

namespace vdb_offset::test {

/// A patch from a function of the parameters (u, v) in [0, 1]^2.
Patch make_patch(const std::string& name, int ni, int nj,
                 const std::function<Vec3(double, double)>& point);

/// The rectangle from `corner` along `u` and `v`, normal u x v.
Patch rectangle(const std::string& name, std::array<int, 2> points, const Vec3& corner,
                const std::array<Vec3, 2>& sides);

/// Two plates facing each other across `gap` along z, from (0, 0) to (1, 1), normals inward.
Patches plates(int points, double gap);

/// The two walls of an inner corner of `angle` radians, 1 long, 1 deep along y, shared edge on y.
Patches wedge(int points, double angle);

/// A wall of 1 x 1 in x >= 0, `ni x nj` points, j along y, whose edge i = 0 lies exactly in the
/// plane x = 0. Its normal points into the fluid, and there it meets the plane at `angle` radians,
/// in (0, pi): at pi / 2 it is the floor z = 0, below that it rises and leaves an acute corner.
Patches wall_at_plane(std::array<int, 2> points, double angle);

/// Every patch moved and turned by an orthogonal map (a mirror turns the patches round again).
Patches mapped(Patches patches, const Eigen::Matrix3d& map, const Vec3& shift);

/// Uniformly random point of a box.
Vec3 random_point(std::mt19937_64& random, const Box& box);

/// Distance by looking at every triangle, in long double: the definition, without a hierarchy.
double brute_force_distance(const Wall& wall, const Vec3& query);

/// The same for many points: passes over triangles whose bounding ball is too far away.
class BruteForce {
 public:
  explicit BruteForce(const Wall& wall);
  double distance(const Vec3& query) const;

 private:
  struct Ball {
    Vec3 centre;
    double radius;
  };
  const Wall& wall_;
  std::vector<Ball> balls_;
};

/// Folder of the real geometry that is not part of a clone; nothing when it is absent.
std::optional<std::string> shared_data();

}  // namespace vdb_offset::test
