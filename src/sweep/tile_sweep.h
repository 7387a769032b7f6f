#pragma once

#include <array>
#include <cstdint>

namespace vdb_offset {

/// One octant's direction of travel: +1 or -1 along x, y, z.
struct Octant {
  int x, y, z;
};

inline constexpr std::array<Octant, 8> kOctants{{{1, 1, 1},
                                                 {-1, 1, 1},
                                                 {-1, -1, 1},
                                                 {1, -1, 1},
                                                 {1, -1, -1},
                                                 {1, 1, -1},
                                                 {-1, 1, -1},
                                                 {-1, -1, -1}}};

/// A leaf tile of 8^3 magnitudes with a halo of one voxel on its six faces, z fastest.
struct HaloTile {
  static constexpr int kEdge = 10;
  static constexpr int kCells = kEdge * kEdge * kEdge;
  static constexpr std::array<int, 3> kStride{kEdge * kEdge, kEdge, 1};

  alignas(64) std::array<float, kCells> phi;
  alignas(64) std::array<float, kCells> floor;  ///< phi never falls below: itself for seeds and
                                                ///< inactive voxels, 0 for the others

  static constexpr int index(int x, int y, int z) {  // of voxel (x, y, z) in [0, 8)
    return ((x + 1) * kEdge + y + 1) * kEdge + z + 1;
  }
};

/// The Godunov update: the phi for which sum of ((phi - neighbour)^+)^2 over the axes is h^2.
/// In  a, b, c: least neighbour along each axis, in any order; unreached ones are huge.
float godunov(float a, float b, float c, float h);

/// One Gauss-Seidel sweep over the tile in the octant's order; returns the largest fall of a voxel.
float sweep_tile(HaloTile& tile, const Octant& octant, float h);

}  // namespace vdb_offset
