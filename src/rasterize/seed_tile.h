#pragma once

#include <openvdb/openvdb.h>

#include <array>
#include <cstdint>

#include "rasterize/exact_distances.h"
#include "rasterize/near_filter.h"
#include "rasterize/tiles.h"

namespace vdb_offset {

/// Seeds leaf tiles with exact distances, and finds the side of their other voxels.
class TileSeeder {
 public:
  using Leaf = openvdb::FloatTree::LeafNodeType;
  /// One bit a voxel, in the leaf's order.
  using Mask = std::array<std::uint64_t, kTile>;

  /// Scratch for one thread.
  struct Scratch {
    NearFilter::Scratch near;
    ExactDistances exact;
    std::array<int, kTileVoxels> nearest;
    std::array<double, kTileVoxels> distance2;
    std::array<std::uint16_t, kTileVoxels> rivals;
    Mask inside;  ///< by a winding number
  };

  TileSeeder(const Wall& wall, const TileQuery& query);

  /// Fills a leaf that stands at the site's tile: seeds hold the signed distance, other voxels
  /// +-Band::kUnreached by their side (all positive without sides); active as the band asks.
  /// Returns the number of seeds.
  int seed(const TileSite& site, Scratch& scratch, Leaf& leaf) const;

 private:
  struct Seeds {
    Mask seed{}, behind{};
    int count = 0;
    bool ask_voxels = false;
  };

  /// What a voxel's nearest triangle says of it.
  struct Found {
    double distance_world;
    bool behind, free_edge;
  };

  /// Sides come from what the nearest place lies on: its distance alone is not enough.
  bool asks_features() const { return query_.sides && query_.winding == nullptr; }
  void nearest_triangles(const TileCube& tile, Scratch& scratch) const;
  Found look(const TileCube& tile, int n, const Scratch& scratch) const;
  Seeds place_seeds(const TileSite& site, Scratch& scratch, float* phi) const;
  Mask sides_one_by_one(const TileSite& site, const Seeds& seeds) const;
  static Mask spread_sides(const Seeds& seeds);
  int cut(const TileSite& site, Leaf& leaf) const;

  const Wall& wall_;
  TileQuery query_;
  NearFilter filter_;
};

}  // namespace vdb_offset
