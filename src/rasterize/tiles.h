#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "vdb_offset/core/progress.h"
#include "vdb_offset/core/vec.h"
#include "vdb_offset/surface/surface.h"

namespace vdb_offset {

/// A cube of `edge`^3 leaf tiles (edge a power of two); its corner in tiles.
struct TileCube {
  std::int32_t x, y, z;
  std::int32_t edge;
};

/// A leaf tile of the band and what its centre knows of the wall.
struct TileSite {
  TileCube cube;     ///< edge 1
  WallPoint centre;  ///< nearest place to the tile's centre
};

/// Which tiles a band takes.
struct TileQuery {
  double voxel_world = 0;
  double reach_world = 0;  ///< a voxel centre within this belongs to the band
  bool both_sides = false;
};

/// Voxels along a leaf tile's edge.
inline constexpr int kTile = 8;

/// Centre of a cube's voxel centres, and half of their diagonal, world units.
Vec3 centre_world(const TileCube& cube, double voxel_world);
double half_diagonal_world(const TileCube& cube, double voxel_world);

/// Number of tiles in the band: whole cubes inside the band at once, exact up to some ten thousand
/// cubes on its rim, within 3 % beyond (a fixed sample stands for all). Nothing if the lattice
/// would leave 32-bit indices. Cost: below 10^6 distances, however fine the voxel.
std::optional<double> count_tiles(const Wall& wall, const TileQuery& query);

/// The band's tiles, in an order that depends on the surface alone.
std::vector<TileSite> find_tiles(const Wall& wall, const TileQuery& query,
                                 const Progress& progress);

}  // namespace vdb_offset
