#pragma once

#include <array>
#include <span>

#include "core/large_vector.h"
#include "vdb_offset/core/vec.h"
#include "vdb_offset/surface/wall.h"

namespace vdb_offset {

/// The triangles of a wall, by their corners and by their geometry.
struct WallMesh {
  const Vec3List& vertices;
  std::span<const Wall::Triangle> triangles;
  std::span<const TriangleGeometry> geometry;
};

/// Unit normals of a wall's faces, edges and vertices (zero where there is no area), and what of it
/// lies on the open boundary.
struct Pseudonormals {
  LargeVector<Vec3> triangle;
  LargeVector<Vec3> vertex;  ///< sums weighted by angle
  LargeVector<char> vertex_free;
  /// Beyond edges ab, bc and ca: a triangle, kFree, or below that ~(n + 1) for entry n of `shared`.
  LargeVector<std::array<int, 3>> beyond;
  Vec3List shared;  ///< normals of edges of three triangles and more

  static constexpr int kFree = -1;
  /// Whether edge e of triangle t is used by that alone.
  bool edge_free(std::size_t t, std::size_t e) const { return beyond[t][e] == kFree; }
  Vec3 edge_normal(std::size_t t, std::size_t e) const;
};

/// Cost O(n log m) for n triangles, m around a vertex. The same for any thread count.
Pseudonormals pseudonormals(const WallMesh& mesh);

}  // namespace vdb_offset
