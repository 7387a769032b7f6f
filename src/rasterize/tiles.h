#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "rasterize/side_parts.h"
#include "vdb_offset/core/progress.h"
#include "vdb_offset/core/vec.h"
#include "vdb_offset/surface/surface.h"

namespace vdb_offset {

/// A cube of `edge`^3 leaf tiles (edge a power of two); its corner in tiles.
struct TileCube {
  std::int32_t x, y, z;
  std::int32_t edge;
};

/// A leaf tile of the band and what its centre, or that of a cube around it, knows of the wall.
struct TileSite {
  TileCube cube;     ///< edge 1
  bool near_wall;    ///< may hold seeds
  bool ask_voxels;   ///< the voxels' sides are not their neighbours' or the centre's
  bool behind;       ///< the centre lies behind the wall
  bool cut = false;  ///< may reach beyond a boundary, or off the slice
};

/// Which tiles a band takes.
struct TileQuery {
  double voxel_world = 0;
  double reach_world = 0;        ///< a voxel centre within this belongs to the band
  double seed_reach_voxels = 0;  ///< and within this is a seed
  bool both_sides = false;
  bool closed = false;    ///< the wall has no free edge: far from it a whole cube has one side
  bool one_body = false;  ///< closed, in one piece: the space beyond its box is on one side
  bool sides = true;      ///< voxels are told apart by their side; if not, both sides are taken
  const Winding* winding = nullptr;  ///< tells sides instead of the wall's normals; null: none
  const SideParts* parts = nullptr;  ///< bodies that do not agree where the front is
  bool flat = false;                 ///< the slice of voxels in z = 0 alone
  const Boundaries* boundaries = nullptr;  ///< no voxel beyond them; null: none
  std::size_t sample = 100'000;            ///< cubes of one size that a count looks at
};

/// Voxels less than this beyond a boundary, in voxels, lie on it.
inline constexpr double kOnBoundaryVoxels = 1e-6;

/// Voxels along a leaf tile's edge, and in the tile.
inline constexpr int kTile = 8;
inline constexpr int kTileVoxels = kTile * kTile * kTile;

/// Centre of a cube's voxel centres, and half of their diagonal, world units.
Vec3 centre_world(const TileCube& cube, double voxel_world);
double half_diagonal_world(const TileCube& cube, double voxel_world);

/// Number of tiles in the band: whole cubes inside the band at once, exact up to some ten thousand
/// cubes on its rim, within 3 % beyond (a fixed sample stands for all). Nothing if the lattice
/// would leave 32-bit indices. Cost: below 10^6 distances, however fine the voxel. Throws
/// Cancelled. `sites`, if given, gets the tiles, or nothing if it was too many of them to look at
/// each.
std::optional<double> count_tiles(const Wall& wall, const TileQuery& query,
                                  const Progress& progress, std::vector<TileSite>* sites = nullptr);

/// The band's tiles, in an order that depends on the surface alone.
std::vector<TileSite> find_tiles(const Wall& wall, const TileQuery& query,
                                 const Progress& progress);

}  // namespace vdb_offset
