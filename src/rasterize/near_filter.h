#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "core/large_vector.h"
#include "rasterize/tiles.h"
#include "rasterize/triangle_shape.h"

namespace vdb_offset {

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

  /// For voxels within `reach_voxels` of the wall.
  NearFilter(const Wall& wall, double voxel_world, double reach_voxels);

  struct Scratch {
    std::vector<TriangleRun> runs;
    std::vector<int> unusual;  ///< triangles that need double precision
    std::vector<RowEntry> entries;
    std::size_t entry_count = 0;
    std::vector<Candidate> candidates;
    std::size_t candidate_count = 0;
    alignas(64) std::array<float, kTileVoxels> nearest;  ///< bound from above
    alignas(64) std::array<float, kTileVoxels> across;   ///< an older one, with y fastest
  };

  /// Finds, in `scratch`, all triangles that can be nearest to a voxel of the tile within reach;
  /// their order depends on the wall and the tile alone.
  void run(const TileCube& tile, Scratch& scratch) const;

 private:
  ShapeTask task_of(std::size_t triangle) const;

  const Wall& wall_;
  double voxel_world_;
  double reach_voxels_;
  LargeVector<TriangleShape<float>> shapes_;
};

}  // namespace vdb_offset
