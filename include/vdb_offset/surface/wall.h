#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <memory>
#include <span>
#include <vector>

#include "vdb_offset/core/vec.h"

namespace vdb_offset {

/// The nearest place on a wall to a query point.
struct WallPoint {
  double distance_world = std::numeric_limits<double>::infinity();  ///< >= 0
  Vec3 point_world = Vec3::Zero();                                  ///< the nearest point itself
  Vec3 normal = Vec3::Zero();  ///< unit pseudonormal of the nearest face, edge or vertex
  int triangle = -1;           ///< index of a nearest triangle; -1: none within the limit
  bool on_free_edge = false;   ///< the nearest place is on the surface's open boundary

  /// +1 on the side that the normals point into, -1 behind.
  double side(const Vec3& query) const {
    return (query - point_world).dot(normal) < 0 ? -1.0 : 1.0;
  }
};

/// A triangle as its first corner and two edges, world: what a distance needs, side by side.
struct TriangleGeometry {
  Vec3 a, ab, ac;
};

/// Triangles first, ..., last - 1, neighbours, and a box around them, world.
struct TriangleRun {
  std::uint32_t first, last;
  Box box;
};

/// The wall as triangles, with exact distance queries: the one definition of the geometry.
///
/// Pseudonormals: face normal, sum of the two faces' normals on an edge, angle-weighted sum at a
/// vertex (Baerentzen and Aanaes, Signed distance computation using the angle weighted
/// pseudonormal, 2005), which makes the sign right for closed surfaces.
/// They are made on first need, once for all threads: a wall that is asked for distances and places
/// alone never makes them.
/// Threads: queries are const and may run side by side.
class Wall {
 public:
  using Triangle = std::array<int, 3>;

  /// In  `vertices`: world; `triangles`: counter-clockwise seen from the marching side.
  /// Triangles with two equal vertex indices are dropped; the others are kept in another order,
  /// neighbours together. Cost O(n log n). Throws InputError when
  /// no triangle is left or a coordinate is not finite.
  Wall(Vec3List vertices, std::vector<Triangle> triangles);
  ~Wall();
  Wall(Wall&&) noexcept;
  Wall& operator=(Wall&&) noexcept;

  /// Nearest place to `query_world`, exact to double rounding: 1e-12 of the distance or 1e-15 of
  /// the largest coordinate, whichever is more, needles of any width included.
  /// Looks no farther than `limit_world`: a near upper bound makes it cheaper. A query that is not
  /// finite is near to nothing: triangle -1, distance infinite.
  /// Cost about log n; 1-2 microseconds for 10^5 triangles near the wall.
  WallPoint closest(const Vec3& query_world,
                    double limit_world = std::numeric_limits<double>::infinity()) const;

  /// The same without pseudonormal: `normal` is zero, `on_free_edge` false.
  WallPoint closest_place(const Vec3& query_world,
                          double limit_world = std::numeric_limits<double>::infinity()) const;

  /// As `closest`, for one of many queries that lie side by side: the search is bounded by the
  /// distance to `guess`, the triangle found for the last one (-1: none yet). The distance is the
  /// same bit by bit, whatever the guess; of equally near triangles it may find another.
  WallPoint closest_from(int guess, const Vec3& query_world) const;

  /// Distances of many points, in parallel; the same as `closest` one by one.
  std::vector<double> true_distance(const Vec3List& queries_world) const;

  /// Appends runs of triangles, all of them whose bounding box is within `reach_world` of the box
  /// among them; the order depends on the wall and the box alone.
  void near_box(const Box& box_world, double reach_world, std::vector<TriangleRun>& runs) const;
  /// Whether there is any such triangle.
  bool is_near_box(const Box& box_world, double reach_world) const;

  /// Nearest place on one triangle, with its pseudonormal.
  WallPoint closest_on(int triangle, const Vec3& query_world) const;

  /// Squared distance to one triangle, world units squared.
  double distance2(int triangle, const Vec3& query_world) const;

  const Vec3List& vertices() const;
  std::span<const Triangle> triangles() const;
  std::span<const TriangleGeometry> geometry() const;  ///< of `triangles`
  /// Angle-weighted unit pseudonormal of a vertex; zero for a vertex that no triangle uses.
  const Vec3& vertex_normal(int vertex) const;
  /// Unit normal of a triangle; zero if its area is zero.
  const Vec3& triangle_normal(int triangle) const;
  const Box& bounds() const;
  double area() const;        ///< cost O(n)
  std::size_t bytes() const;  ///< with the pseudonormals, made or not

 private:
  struct Data;
  std::unique_ptr<const Data> data_;
};

}  // namespace vdb_offset
