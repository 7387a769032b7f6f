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
  LargeVector<Vec3> vertex;                    ///< sums weighted by angle
  LargeVector<std::array<Vec3, 3>> edge;       ///< of edges ab, bc, ca
  LargeVector<std::array<bool, 3>> edge_free;  ///< used by one triangle
  LargeVector<char> vertex_free;
};

/// Cost O(n log m) for n triangles, m around a vertex. The same for any thread count.
Pseudonormals pseudonormals(const WallMesh& mesh);

}  // namespace vdb_offset
