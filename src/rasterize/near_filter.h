#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "core/large_vector.h"
#include "rasterize/tiles.h"

namespace vdb_offset {

/// A triangle (a, b, c) in voxels, prepared. `Real` is float where the
/// triangle is of ordinary size and shape, else double.
template <typename Real>
struct TriangleShape {
  using Vec = std::array<Real, 3>;
  std::array<Vec, 3> edge;      ///< ab, ac, bc
  std::array<Real, 3> inverse;  ///< 1 / |edge|^2; 0 for an edge of no length
  std::array<Vec, 3> inward;    ///< unit, in the plane, across each edge towards the inside
  Vec normal;
  Vec3 a;        ///< in the lattice's voxels
  Real size;     ///< longest edge
  Real blur;     ///< error of a distance, over its scale of length
  Real thin;     ///< height that is neglected, voxels
  Real outside;  ///< negative: no point is inside, the triangle is its edges
};

/// Distance bounds of the voxels of one leaf tile, and which triangles can be nearest to them.
///
/// Bounds are in voxels squared and hold in spite of rounding; so the exact distances, which cost
/// ten times as much, are asked for one or two triangles a voxel.
class NearFilter {
 public:
  /// A triangle that can be the nearest to a voxel.
  struct Candidate {
    std::int32_t voxel;
    std::int32_t triangle;
  };
  /// A triangle in a row along z: bounds from below, of use where not above `Scratch::nearest`.
  struct RowEntry {
    alignas(32) std::array<float, kTile> lower;
    std::int32_t row;
    std::int32_t triangle;
  };

  NearFilter(const Wall& wall, double voxel_world);

  struct Scratch {
    std::vector<int> triangles;
    std::vector<RowEntry> entries;
    std::size_t entry_count = 0;
    std::vector<Candidate> candidates;
    std::size_t candidate_count = 0;
    alignas(64) std::array<float, kTileVoxels> nearest;  ///< bound from above
  };

  /// Finds, in `scratch`, all triangles that can be nearest to a voxel of the tile within
  /// `reach_voxels`; their order depends on the wall and the tile alone.
  void run(const TileCube& tile, double reach_voxels, Scratch& scratch) const;

 private:
  const Wall& wall_;
  double voxel_world_;
  LargeVector<TriangleShape<float>> shapes_;  // size 0: not for single precision
};

}  // namespace vdb_offset
