// Section 4.2 of Wang, Guibault, Camarero: nodes near the front get their exact distance.

#include "rasterize/seed_tile.h"

#include <algorithm>
#include <cmath>

#include "vdb_offset/rasterize/rasterize.h"

namespace vdb_offset {

namespace {

constexpr int kVoxels = TileValues::kVoxels;

std::size_t offset(int x, int y, int z) {
  return static_cast<std::size_t>((x * kTile + y) * kTile + z);
}

Vec3 voxel_world_position(const TileCube& cube, std::size_t n, double h) {
  const auto index = static_cast<int>(n);
  const int z = index % kTile;
  const int y = index / kTile % kTile;
  const int x = index / (kTile * kTile);
  return h * Vec3(kTile * cube.x + x, kTile * cube.y + y, kTile * cube.z + z);
}

/// Voxels of the tile within reach of a triangle's bounding box: first and last along each axis.
struct VoxelRange {
  std::array<int, 3> first, last;
};

VoxelRange range_of(const Wall& wall, int triangle, const TileCube& cube, double h) {
  Box box;
  for (const int v : wall.triangles()[static_cast<std::size_t>(triangle)]) {
    box.add(wall.vertices()[static_cast<std::size_t>(v)]);
  }
  const std::array<int, 3> origin{kTile * cube.x, kTile * cube.y, kTile * cube.z};
  VoxelRange range{};
  for (std::size_t a = 0; a < 3; ++a) {
    const auto axis = static_cast<Eigen::Index>(a);
    const double lo = std::ceil(box.lo[axis] / h - kSeedReachVoxels - 1e-9) - origin[a];
    const double hi = std::floor(box.hi[axis] / h + kSeedReachVoxels + 1e-9) - origin[a];
    range.first[a] = static_cast<int>(std::clamp(lo, 0.0, static_cast<double>(kTile)));
    range.last[a] = static_cast<int>(std::clamp(hi, -1.0, kTile - 1.0));
  }
  return range;
}

void nearest_triangles(const Wall& wall, const TileSite& site, double h, SeedScratch& scratch) {
  const double reach = kSeedReachVoxels * h;
  scratch.distance2.fill(reach * reach);
  scratch.nearest.fill(-1);
  scratch.triangles.clear();
  Box box;
  box.add(voxel_world_position(site.cube, 0, h));
  box.add(voxel_world_position(site.cube, kVoxels - 1, h));
  wall.near_box(box, reach, scratch.triangles);
  for (const int t : scratch.triangles) {
    const VoxelRange r = range_of(wall, t, site.cube, h);
    const Vec3& corner =
        wall.vertices()[static_cast<std::size_t>(wall.triangles()[static_cast<std::size_t>(t)][0])];
    const Vec3& normal = wall.triangle_normal(t);
    for (int x = r.first[0]; x <= r.last[0]; ++x) {
      for (int y = r.first[1]; y <= r.last[1]; ++y) {
        for (int z = r.first[2]; z <= r.last[2]; ++z) {
          const std::size_t n = offset(x, y, z);
          const Vec3 p = voxel_world_position(site.cube, n, h);
          const double above = normal.dot(p - corner);
          if (above * above > scratch.distance2[n] * (1 + 1e-9)) continue;
          const double d2 = wall.distance2(t, p);
          if (d2 > scratch.distance2[n] ||
              (d2 == scratch.distance2[n] && scratch.nearest[n] >= 0)) {
            continue;
          }
          scratch.distance2[n] = d2;
          scratch.nearest[n] = t;
        }
      }
    }
  }
}

/// Non-seeds take the side of their neighbours: seeds form a layer that no path can cross.
void spread_sides(TileValues& values) {
  std::array<std::size_t, kVoxels> queue;
  std::array<bool, kVoxels> known = values.seed;
  std::size_t head = 0;
  std::size_t tail = 0;
  for (std::size_t n = 0; n < kVoxels; ++n) {
    if (known[n]) queue[tail++] = n;
  }
  while (head < tail) {
    const std::size_t n = queue[head++];
    const std::array<int, 3> at{static_cast<int>(n) / (kTile * kTile),
                                static_cast<int>(n) / kTile % kTile, static_cast<int>(n) % kTile};
    constexpr std::array<int, 3> kStride{kTile * kTile, kTile, 1};
    for (std::size_t a = 0; a < 3; ++a) {
      for (const int step : {-1, 1}) {
        if (at[a] + step < 0 || at[a] + step >= kTile) continue;
        const auto m = static_cast<std::size_t>(static_cast<int>(n) + step * kStride[a]);
        if (known[m]) continue;
        known[m] = true;
        values.phi[m] = std::copysign(Band::kUnreached, values.phi[n]);
        queue[tail++] = m;
      }
    }
  }
}

}  // namespace

void seed_tile(const Wall& wall, const TileSite& site, double voxel_world, SeedScratch& scratch,
               TileValues& values) {
  const double h = voxel_world;
  values.seeds = 0;
  values.seed.fill(false);
  const Vec3 centre = centre_world(site.cube, h);
  const double half = half_diagonal_world(site.cube, h);
  bool free_edge = site.centre.on_free_edge;
  if (site.centre.distance_world <= half + kSeedReachVoxels * h) {
    nearest_triangles(wall, site, h, scratch);
    for (std::size_t n = 0; n < kVoxels; ++n) {
      if (scratch.nearest[n] < 0) continue;
      const Vec3 p = voxel_world_position(site.cube, n, h);
      const WallPoint nearest = wall.closest_on(scratch.nearest[n], p);
      values.phi[n] = static_cast<float>(nearest.side(p) * nearest.distance_world);
      values.seed[n] = true;
      ++values.seeds;
      free_edge = free_edge || nearest.on_free_edge;
    }
    if (values.seeds > 0 && !free_edge) {
      spread_sides(values);
      return;
    }
  }
  // Far from the wall one side serves the whole tile; not past a free edge, where the wall's side
  // goes on as the plane of the nearest place and each voxel asks for itself.
  const double side = site.centre.side(centre);
  for (std::size_t n = 0; n < kVoxels; ++n) {
    if (values.seed[n]) continue;
    const Vec3 p = voxel_world_position(site.cube, n, h);
    values.phi[n] =
        static_cast<float>((free_edge ? wall.closest(p).side(p) : side) * Band::kUnreached);
  }
}

}  // namespace vdb_offset
