#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "vdb_offset/core/vec.h"
#include "vdb_offset/surface/wall.h"

namespace vdb_offset {

/// How far Winding::number may be off.
inline constexpr double kWindingError = 0.01;
/// Points along the edge of the cube of Winding::inside_of_cube.
inline constexpr int kWindingCube = 8;

/// The generalised winding number of triangles that need not close: how often they go round a
/// point, their solid angles over 4 pi (Jacobson, Kavan, Sorkine-Hornung, Robust inside-outside
/// segmentation using generalized winding numbers, 2013). Behind a surface whose normals point out
/// it is 1, in front of it 0; where there are gaps or faces too many it is in between, smoothly.
///
/// Far groups of triangles count as one dipole (Barill, Dickson, Schmidt, Levin, Jacobson, Fast
/// winding numbers for soups and clouds, 2018): error below
/// kWindingError.
/// Cost    building O(n log n), 100 bytes a triangle; a query about log n, some 10 microseconds;
///         of a cube of points a twentieth to a fortieth of that for each.
/// Threads queries are const and may run side by side.
class Winding {
 public:
  explicit Winding(const Wall& wall);

  double number(const Vec3& query_world) const;
  /// Whether the number's size is above a half: the normals may point either way.
  bool is_inside(const Vec3& query_world) const;

  /// A word for each x, in it the bit 8 y + z.
  using CubeMask = std::array<std::uint64_t, kWindingCube>;
  /// is_inside of the 8^3 points spacing * (first + (x, y, z)), x, y, z = 0, ..., 7. Where the
  /// number is not a half all over, that is told by the number and its gradient at a few places,
  /// with a bound on the rest.
  CubeMask inside_of_cube(const std::array<int, 3>& first, double spacing_world) const;

 private:
  friend class WindingCube;
  /// Radii of a group from which it is a dipole.
  static constexpr double kFarGroup = 4;

  struct Node {
    Vec3 centre = Vec3::Zero();  // mean of its triangles, by area
    Vec3 area = Vec3::Zero();    // sum of their area vectors
    double radius = 0;           // of a ball about the centre that holds them
    std::uint32_t first = 0, last = 0;
    std::uint32_t right = 0;  // child; the left one is the next node; 0: a leaf
  };

  std::uint32_t build(std::span<const TriangleGeometry> triangles, std::uint32_t first,
                      std::uint32_t last);

  double solid_angle_of(std::uint32_t group, const Vec3& query_world) const;

  std::vector<TriangleGeometry> triangles_;  // in the nodes' order
  std::vector<Node> nodes_;
};

}  // namespace vdb_offset
