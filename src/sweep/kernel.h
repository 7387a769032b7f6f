#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "sweep/octant.h"

namespace vdb_offset {

/// Instruction sets with a kernel of their own. The same operations in the same order in each:
/// their results are equal bit for bit.
enum class Isa { Scalar, Sse2, Avx2, Avx512 };

// While a band is swept its leaf buffers hold a code instead of signed distances: the magnitude,
// and the float's sign bit for "fixed" (seeds, and inactive voxels as -kFarAway). One
// comparison then tells a neighbour that may still fall, and min() leaves fixed ones alone.

/// Magnitude of what no sweep has reached, and of inactive voxels.
inline constexpr float kFarAway = 1e30F;

/// The 512 bits of a tile, in the order of its voxels.
using TileBits = std::array<std::uint64_t, 8>;

/// Up to sixteen tiles, no two of them neighbours, that one octant visits side by side.
struct TileBatch {
  static constexpr std::size_t kMost = 16;

  std::size_t count = 0;
  unsigned octant = 0;
  float h = 0;                       ///< voxel, world units
  float tolerance = 0;               ///< a fall by no more than this wakes nobody, world units
  std::array<float*, kMost> tile{};  ///< buffers of 8^3 codes, z fastest
  /// The first codes of the neighbours' layers that touch the tiles, null: none.
  std::array<std::array<const float*, kMost>, kFaces> beside{};

  std::array<float, kMost> fall{};       ///< out: largest fall of a voxel
  std::array<OctantSet, kMost> again{};  ///< out: octants in which the tile should be seen again
  std::array<std::array<OctantSet, kMost>, kFaces> wake{};  ///< out: those of its neighbours
};

struct Kernels {
  std::size_t width;  ///< tiles side by side
  /// One Gauss-Seidel sweep over each tile of the batch.
  void (*sweep)(TileBatch& batch);
  /// Signed distances to codes; `sign` and `open` get the bits of negative and of unreached voxels.
  void (*encode)(float* phi, const TileBits& active, TileBits& sign, TileBits& open);
  /// Back again; magnitudes above `limit` become `limit`, and leave `active`.
  void (*decode)(float* phi, TileBits& active, const TileBits& sign, float limit);
};

/// The kernels for an instruction set; null if this build or machine has none.
const Kernels* kernels(Isa isa);
/// The widest instruction set of this machine.
Isa best_isa();
/// Those of at most `kernels`' width that waste the fewest lanes on `tiles` tiles.
const Kernels& narrowest(const Kernels& kernels, std::size_t tiles);

namespace isa {  // null where the compiler does not target the processor
const Kernels* scalar();
const Kernels* sse2();
const Kernels* avx2();
const Kernels* avx512();
}  // namespace isa

}  // namespace vdb_offset
