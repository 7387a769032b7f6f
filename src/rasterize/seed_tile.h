#pragma once

#include <array>
#include <vector>

#include "rasterize/tiles.h"

namespace vdb_offset {

/// Values of one leaf tile, in OpenVDB's order (z fastest).
struct TileValues {
  static constexpr int kVoxels = kTile * kTile * kTile;
  std::array<float, kVoxels> phi;  ///< seed: signed distance; else +-Band::kUnreached by side
  std::array<bool, kVoxels> seed;
  int seeds = 0;
};

/// Scratch for one thread.
struct SeedScratch {
  std::vector<int> triangles;
  std::array<double, TileValues::kVoxels> distance2;
  std::array<int, TileValues::kVoxels> nearest;
};

/// Exact seeds of a tile and the side of its other voxels.
void seed_tile(const Wall& wall, const TileSite& site, double voxel_world, SeedScratch& scratch,
               TileValues& values);

}  // namespace vdb_offset
