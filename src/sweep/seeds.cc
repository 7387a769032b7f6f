#include "sweep/seeds.h"

#include <bit>
#include <cmath>

namespace vdb_offset {

namespace {

constexpr std::array<int, 3> kStride{64, 8, 1};

int along(int voxel, unsigned axis) { return voxel / kStride[axis] % 8; }

/// One tile and its neighbours.
class Around {
 public:
  Around(const TileSchedule& schedule, const TileMarks* marks, std::size_t tile)
      : schedule_(schedule), marks_(marks), tile_(tile) {}

  int tile() const { return static_cast<int>(tile_); }
  /// Voxels of slab x of the tile that are fixed and have an open voxel beside them.
  std::uint64_t rim(std::size_t x) const {
    constexpr std::uint64_t kZ0 = 0x0101010101010101;
    const TileBits& own = marks_[tile_].open;
    const std::uint64_t mid = own[x];
    std::uint64_t beside = mid << 8U | mid >> 8U | (mid << 1U & ~kZ0) | (mid >> 1U & ~(kZ0 << 7U));
    beside |= x > 0 ? own[x - 1] : slab(0, 7);
    beside |= x < 7 ? own[x + 1] : slab(1, 0);
    beside |= slab(2, x) >> 56U | slab(3, x) << 56U;
    beside |= (slab(4, x) >> 7U & kZ0) | (slab(5, x) & kZ0) << 7U;
    return beside & ~mid;
  }

  /// Where the voxel beside `voxel` across `face` is: its tile, -1 for none, and number.
  struct Place {
    int tile;
    int voxel;
  };
  Place beside(int voxel, std::size_t face) const {
    const auto axis = static_cast<unsigned>(face / 2);
    const int step = face % 2 == 0 ? -1 : 1;
    const int to = along(voxel, axis) + step;
    if (to >= 0 && to < 8) return {static_cast<int>(tile_), voxel + step * kStride[axis]};
    return {schedule_.tile(tile_).neighbour[face], voxel - 7 * step * kStride[axis]};
  }
  float size(const Place& at) const {
    if (at.tile < 0) return kFarAway;
    return std::abs(schedule_.tile(static_cast<std::size_t>(at.tile)).phi[at.voxel]);
  }
  bool open(const Place& at) const {
    if (at.tile < 0) return false;
    const TileBits& bits = marks_[static_cast<std::size_t>(at.tile)].open;
    return (bits[static_cast<std::size_t>(at.voxel / 64)] >> (at.voxel % 64) & 1U) != 0;
  }

 private:
  std::uint64_t slab(std::size_t face, std::size_t x) const {
    const int n = schedule_.tile(tile_).neighbour[face];
    return n < 0 ? 0 : marks_[static_cast<std::size_t>(n)].open[x];
  }

  const TileSchedule& schedule_;
  const TileMarks* marks_;
  std::size_t tile_;
};

/// Octants that travel out through a face.
OctantSet towards(std::size_t face) {
  constexpr std::array<OctantSet, 3> kBack{0xaa, 0xcc, 0xf0};
  return face % 2 == 0 ? kBack[face / 2] : ~kBack[face / 2] & 0xffU;
}

/// Octants that climb from a seed, along each axis: both ways from the least of three.
OctantSet octants_away(const Around& around, int voxel) {
  const float own = around.size({around.tile(), voxel});
  OctantSet away = 0xff;
  for (std::size_t face = 0; face < kFaces; face += 2) {
    const float low = around.size(around.beside(voxel, face));
    const float high = around.size(around.beside(voxel, face + 1));
    if (own < low && own < high) continue;
    away &= low > high ? towards(face) : towards(face + 1);
  }
  return away;
}

}  // namespace

void wake_from_seeds(TileSchedule& schedule, const TileMarks* marks, std::size_t tile) {
  const Around around(schedule, marks, tile);
  for (std::size_t x = 0; x < 8; ++x) {
    for (std::uint64_t rim = around.rim(x); rim != 0; rim &= rim - 1) {
      const int voxel = static_cast<int>(64 * x) + std::countr_zero(rim);
      if (std::abs(schedule.tile(tile).phi[voxel]) >= kFarAway) continue;  // inactive
      const OctantSet away = octants_away(around, voxel);
      for (std::size_t face = 0; face < kFaces; ++face) {
        const auto to = around.beside(voxel, face);
        if (!around.open(to)) continue;
        schedule.wake(static_cast<std::size_t>(to.tile), away & towards(face));
      }
    }
  }
}

}  // namespace vdb_offset
