// Section 4.2 of Wang, Guibault, Camarero: nodes near the front get their exact distance.

#include "rasterize/seed_tile.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include "vdb_offset/rasterize/rasterize.h"
#include "vdb_offset/surface/winding.h"

namespace vdb_offset {

namespace {

Vec3 voxel_position(const TileCube& tile, int n, double h) {
  const int z = n % kTile;
  const int y = n / kTile % kTile;
  const int x = n / (kTile * kTile);
  return h * Vec3(kTile * tile.x + x, kTile * tile.y + y, kTile * tile.z + z);
}

static_assert(kTile == kWindingCube);  // a tile's sides are told at once

constexpr std::uint64_t kFirstZ = 0x0101010101010101;  // z = 0 of every y

/// Voxels of a slab whose neighbour in y or z is in the mask.
std::uint64_t beside(std::uint64_t m) {
  return (m << 8U) | (m >> 8U) | ((m << 1U) & ~kFirstZ) | ((m >> 1U) & ~(kFirstZ << 7U));
}

}  // namespace

TileSeeder::TileSeeder(const Wall& wall, const TileQuery& query)
    : wall_(wall), query_(query), filter_(wall, query.voxel_world, query.seed_reach_voxels) {}

/// The nearest triangle of each voxel within reach, and `distance2`; that is not found where there
/// is but one candidate and features are asked for, which give it anyway.
void TileSeeder::nearest_triangles(const TileCube& tile, Scratch& scratch) const {
  filter_.run(tile, scratch.near);
  scratch.nearest.fill(-1);
  scratch.rivals.fill(0);  // counted where one alone makes a difference
  const std::span candidates(scratch.near.candidates.data(), scratch.near.candidate_count);
  if (asks_features()) {
    for (const NearFilter::Candidate& c : candidates) {
      std::uint16_t& rivals = scratch.rivals[static_cast<std::size_t>(c.voxel)];
      if (rivals < UINT16_MAX) ++rivals;
    }
  }
  std::array<NearFilter::Candidate, kRow> asked;
  const auto judge = [&] {
    std::size_t k = 0;
    for (const double d2 : scratch.exact.find(wall_)) {
      const auto [voxel, t] = asked[k++];
      const auto n = static_cast<std::size_t>(voxel);
      const int best = scratch.nearest[n];
      const double best2 = scratch.distance2[n];
      // Of equally near triangles the first, so that the order of the search does not matter.
      if (best >= 0 && (d2 > best2 || (d2 == best2 && t > best))) continue;
      scratch.nearest[n] = t;
      scratch.distance2[n] = d2;
    }
  };
  for (const NearFilter::Candidate& c : candidates) {
    const auto n = static_cast<std::size_t>(c.voxel);
    if (asks_features() && scratch.rivals[n] == 1) {
      scratch.nearest[n] = c.triangle;
      continue;
    }
    asked[scratch.exact.count()] = c;
    scratch.exact.add(wall_, c.triangle, voxel_position(tile, c.voxel, query_.voxel_world));
    if (scratch.exact.count() == kRow) judge();
  }
  judge();
}

/// A voxel and the triangle nearest to it.
TileSeeder::Found TileSeeder::look(const TileCube& tile, int n, const Scratch& scratch) const {
  const auto voxel = static_cast<std::size_t>(n);
  if (asks_features()) {
    const Vec3 p = voxel_position(tile, n, query_.voxel_world);
    const WallPoint nearest = wall_.closest_on(scratch.nearest[voxel], p);
    return {nearest.distance_world, nearest.side(p) < 0, nearest.on_free_edge};
  }
  const bool is_behind = (scratch.inside[voxel / 64] >> (voxel % 64) & 1U) != 0;
  return {std::sqrt(scratch.distance2[voxel]), is_behind, false};
}

TileSeeder::Seeds TileSeeder::place_seeds(const TileSite& site, Scratch& scratch,
                                          float* phi) const {
  Seeds seeds;
  seeds.ask_voxels = query_.sides && site.ask_voxels;
  const double reach = query_.seed_reach_voxels * query_.voxel_world;
  if (!site.near_wall) return seeds;
  nearest_triangles(site.cube, scratch);
  for (int n = 0; n < kTileVoxels; ++n) {
    if (scratch.nearest[static_cast<std::size_t>(n)] < 0) continue;
    const Found found = look(site.cube, n, scratch);
    if (found.distance_world > reach) continue;
    phi[n] = static_cast<float>(found.behind ? -found.distance_world : found.distance_world);
    const auto slab = static_cast<std::size_t>(n / 64);
    const std::uint64_t bit = std::uint64_t{1} << static_cast<unsigned>(n % 64);
    seeds.seed[slab] |= bit;
    if (found.behind) seeds.behind[slab] |= bit;
    seeds.ask_voxels = seeds.ask_voxels || found.free_edge;
    ++seeds.count;
  }
  return seeds;
}

/// Non-seeds take the side of their neighbours: seeds form a layer that no path can cross. Where
/// both sides arrive at once the front wins.
TileSeeder::Mask TileSeeder::spread_sides(const Seeds& seeds) {
  Mask known = seeds.seed;
  Mask behind = seeds.behind;
  Mask front;
  for (std::size_t x = 0; x < kTile; ++x) front[x] = known[x] & ~behind[x];
  bool done = false;
  while (!done) {
    done = true;
    const auto reached = [](const Mask& m, std::size_t x) {
      return beside(m[x]) | (x > 0 ? m[x - 1] : 0) | (x + 1 < kTile ? m[x + 1] : 0);
    };
    Mask next_front = front;
    Mask next_behind = behind;
    for (std::size_t x = 0; x < kTile; ++x) {
      const std::uint64_t fresh_front = reached(front, x) & ~known[x];
      next_front[x] |= fresh_front;
      next_behind[x] |= reached(behind, x) & ~known[x] & ~fresh_front;
    }
    front = next_front;
    behind = next_behind;
    for (std::size_t x = 0; x < kTile; ++x) {
      known[x] = front[x] | behind[x];
      done = done && known[x] == ~std::uint64_t{0};
    }
  }
  return behind;
}

/// Past a free edge the wall's side goes on as the plane of the nearest place, and between bodies
/// that do not agree it is that of the nearer one: each voxel asks for itself.
TileSeeder::Mask TileSeeder::sides_one_by_one(const TileSite& site, const Seeds& seeds) const {
  Mask behind = seeds.behind;
  int last = -1;
  for (int n = 0; n < kTileVoxels; ++n) {
    const auto slab = static_cast<std::size_t>(n / 64);
    const std::uint64_t bit = std::uint64_t{1} << static_cast<unsigned>(n % 64);
    if ((seeds.seed[slab] & bit) != 0 || (query_.flat && n % kTile != 0)) continue;
    const Vec3 p = voxel_position(site.cube, n, query_.voxel_world);
    const WallPoint nearest = wall_.closest_from(last, p);
    last = nearest.triangle;
    if (nearest.side(p) < 0) behind[slab] |= bit;
  }
  return behind;
}

int TileSeeder::seed(const TileSite& site, Scratch& scratch, Leaf& leaf) const {
  float* phi = leaf.buffer().data();
  const bool has_winding = query_.sides && query_.winding != nullptr;
  scratch.inside.fill(0);
  if (has_winding) {
    scratch.inside = query_.winding->inside_of_cube(
        {kTile * site.cube.x, kTile * site.cube.y, kTile * site.cube.z}, query_.voxel_world);
  }
  const Seeds seeds = place_seeds(site, scratch, phi);
  Mask behind{};
  if (!query_.sides) {
    behind.fill(0);
  } else if (has_winding) {
    behind = scratch.inside;  // it may change anywhere
  } else if (seeds.ask_voxels) {
    behind = sides_one_by_one(site, seeds);
  } else if (seeds.count > 0) {
    behind = spread_sides(seeds);
  } else {
    behind.fill(site.behind ? ~std::uint64_t{0} : 0);
  }
  openvdb::util::NodeMask<3> active;
  for (int n = 0; n < kTileVoxels; ++n) {
    const auto slab = static_cast<std::size_t>(n / 64);
    const auto bit = static_cast<unsigned>(n % 64);
    if ((seeds.seed[slab] >> bit & 1U) != 0) continue;
    phi[n] = (behind[slab] >> bit & 1U) != 0 ? -Band::kUnreached : Band::kUnreached;
  }
  for (std::size_t x = 0; x < kTile; ++x) {
    active.getWord<std::uint64_t>(static_cast<openvdb::Index>(x)) =
        query_.both_sides ? ~std::uint64_t{0} : seeds.seed[x] | ~behind[x];
  }
  leaf.setValueMask(active);
  return site.cut ? cut(site, leaf) : seeds.count;
}

/// Takes away what lies beyond a boundary; returns how many seeds are left.
int TileSeeder::cut(const TileSite& site, Leaf& leaf) const {
  const double least = -kOnBoundaryVoxels * query_.voxel_world;
  int seeds = 0;
  for (auto voxel = leaf.beginValueOn(); voxel; ++voxel) {
    const auto n = static_cast<int>(voxel.pos());
    const Vec3 p = voxel_position(site.cube, n, query_.voxel_world);
    const bool off_slice = query_.flat && p.z() != 0;
    const bool beyond = query_.boundaries != nullptr && query_.boundaries->side(p) < least;
    if (off_slice || beyond) {
      leaf.setValueOff(voxel.pos());
    } else if (std::abs(*voxel) < Band::kUnreached) {
      ++seeds;
    }
  }
  return seeds;
}

}  // namespace vdb_offset
