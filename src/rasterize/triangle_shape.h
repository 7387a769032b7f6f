#pragma once

#include <array>

#include "vdb_offset/core/vec.h"
#include "vdb_offset/surface/wall.h"

namespace vdb_offset {

/// A triangle (a, b, c) in voxels, prepared for distance bounds. `Real` is float where the triangle
/// is of ordinary size and shape, else double.
template <typename Real>
struct TriangleShape {
  using Vec = std::array<Real, 3>;
  Vec3 a;                       ///< in the lattice's voxels
  Vec lo, hi;                   ///< bounding box about a, larger by the error
  Real size;                    ///< longest edge; 0: not for this precision
  float slack;                  ///< error of a squared distance
  std::array<Vec, 3> edge;      ///< ab, ac, bc
  std::array<Real, 3> inverse;  ///< 1 / |edge|^2; 0 for an edge of no length
  /// |ac|^2, ab . ac and |ab|^2 over (2 area)^2, which makes barycentric coordinates of dot
  /// products with ab and ac; 0 for a triangle that is no more than its edges.
  std::array<Real, 3> gram;
  Vec normal;  ///< unit
};

/// A triangle of the wall, and how it is looked at.
struct ShapeTask {
  TriangleGeometry world;
  double voxel_world;
  double reach_voxels;  ///< of the distances that are asked for
};

/// For single precision; of size 0 if the triangle is not of ordinary size and shape.
TriangleShape<float> small_shape(const ShapeTask& task);
/// For any triangle.
TriangleShape<double> any_shape(const ShapeTask& task);

}  // namespace vdb_offset
