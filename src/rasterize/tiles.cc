// Octree descent over cubes of leaf tiles: the distance of a cube's centre to the wall says that it
// is outside the band, inside, behind the wall, or must be split.

#include "rasterize/tiles.h"

#include <algorithm>
#include <cmath>

#include "core/parallel.h"
#include "vdb_offset/rasterize/rasterize.h"

namespace vdb_offset {

namespace {

enum class Place { Outside, Inside, Mixed };

struct Judged {
  Place place;
  WallPoint centre;
};

Judged judge_cube(const Wall& wall, const TileQuery& query, const TileCube& cube) {
  const Vec3 centre = centre_world(cube, query.voxel_world);
  const double half = half_diagonal_world(cube, query.voxel_world);
  const WallPoint nearest = wall.closest(centre, query.reach_world + half);
  if (nearest.triangle < 0) return {Place::Outside, nearest};
  const bool near_wall = nearest.distance_world <= half + kSeedReachVoxels * query.voxel_world;
  if (!query.both_sides && !near_wall && !nearest.on_free_edge && nearest.side(centre) < 0) {
    return {Place::Outside, nearest};
  }
  const bool inside = nearest.distance_world + half <= query.reach_world;
  // Without a sign on the whole cube, only its tiles can tell which of them lie behind.
  const bool one_side = query.both_sides || (!near_wall && !nearest.on_free_edge);
  return {inside && one_side ? Place::Inside : Place::Mixed, nearest};
}

/// The cubes of one power-of-two edge that cover the wall's reach; empty if the lattice is too
/// fine.
std::vector<TileCube> roots(const Wall& wall, const TileQuery& query) {
  const double tile_world = kTile * query.voxel_world;
  const Vec3 lo = (wall.bounds().lo.array() - query.reach_world) / tile_world;
  const Vec3 hi = (wall.bounds().hi.array() + query.reach_world) / tile_world;
  constexpr double kIndexLimit = 1 << 27;  // tiles; voxel indices stay below 2^30
  if (!(lo.cwiseAbs().maxCoeff() < kIndexLimit) || !(hi.cwiseAbs().maxCoeff() < kIndexLimit)) {
    return {};
  }
  std::int32_t edge = 1;
  while (edge < (hi - lo).maxCoeff() / 4) edge *= 2;
  std::vector<TileCube> cubes;
  const auto first = [&](int a) { return static_cast<std::int32_t>(std::floor(lo[a] / edge)); };
  const auto last = [&](int a) {
    return static_cast<std::int32_t>(std::floor((hi[a] + 1) / edge));
  };
  for (std::int32_t x = first(0); x <= last(0); ++x) {
    for (std::int32_t y = first(1); y <= last(1); ++y) {
      for (std::int32_t z = first(2); z <= last(2); ++z) {
        cubes.push_back({x * edge, y * edge, z * edge, edge});
      }
    }
  }
  return cubes;
}

std::vector<Judged> judge_all(const Wall& wall, const TileQuery& query,
                              const std::vector<TileCube>& cubes) {
  std::vector<Judged> judged(cubes.size());
  parallel::for_ranges(cubes.size(), 64, [&](std::size_t begin, std::size_t end) {
    for (std::size_t c = begin; c < end; ++c) judged[c] = judge_cube(wall, query, cubes[c]);
  });
  return judged;
}

void split(const TileCube& cube, std::vector<TileCube>& parts) {
  const std::int32_t half = cube.edge / 2;
  for (int part = 0; part < 8; ++part) {
    parts.push_back({cube.x + (part & 4 ? half : 0), cube.y + (part & 2 ? half : 0),
                     cube.z + (part & 1 ? half : 0), half});
  }
}

/// Keeps an even sample of about kSample cubes; returns how many each of them stands for.
double thin_out(std::vector<TileCube>& cubes) {
  constexpr std::size_t kSample = 100'000;
  if (cubes.size() <= kSample) return 1;
  // A stride without a factor of 2 does not prefer one octant of the cubes' parents.
  const std::size_t stride = cubes.size() / kSample | 1U;
  if (stride == 1) return 1;
  const auto before = static_cast<double>(cubes.size());
  std::size_t kept = 0;
  for (std::size_t c = 0; c < cubes.size(); c += stride) cubes[kept++] = cubes[c];
  cubes.resize(kept);
  return before / static_cast<double>(kept);
}

}  // namespace

Vec3 centre_world(const TileCube& cube, double voxel_world) {
  const double half = 0.5 * (kTile * cube.edge - 1);
  return voxel_world * (kTile * Vec3(cube.x, cube.y, cube.z).array() + half).matrix();
}

double half_diagonal_world(const TileCube& cube, double voxel_world) {
  return 0.5 * std::sqrt(3.0) * (kTile * static_cast<double>(cube.edge) - 1) * voxel_world;
}

std::optional<double> count_tiles(const Wall& wall, const TileQuery& query) {
  std::vector<TileCube> cubes = roots(wall, query);
  if (cubes.empty()) return std::nullopt;
  double count = 0;
  double weight = 1;
  while (!cubes.empty()) {
    const std::vector<Judged> judged = judge_all(wall, query, cubes);
    std::vector<TileCube> next;
    for (std::size_t c = 0; c < cubes.size(); ++c) {
      if (judged[c].place == Place::Outside) continue;
      if (judged[c].place == Place::Inside || cubes[c].edge == 1) {
        count += weight * std::pow(cubes[c].edge, 3);
      } else {
        split(cubes[c], next);
      }
    }
    weight *= thin_out(next);
    cubes.swap(next);
  }
  return weight > 1 ? 1.03 * count : count;
}

std::vector<TileSite> find_tiles(const Wall& wall, const TileQuery& query,
                                 const Progress& progress) {
  std::vector<TileSite> tiles;
  std::vector<TileCube> cubes = roots(wall, query);
  while (!cubes.empty()) {
    progress.check();
    const std::vector<Judged> judged = judge_all(wall, query, cubes);
    std::vector<TileCube> next;
    for (std::size_t c = 0; c < cubes.size(); ++c) {
      if (judged[c].place == Place::Outside) continue;
      if (cubes[c].edge == 1) {
        tiles.push_back({cubes[c], judged[c].centre});
      } else {
        split(cubes[c], next);
      }
    }
    cubes.swap(next);
  }
  return tiles;
}

}  // namespace vdb_offset
