#pragma once

#include <array>
#include <cstdint>
#include <cstring>

#include "core/clones.h"
#include "rasterize/tiles.h"

// Vectors pass between functions that become one: no calling convention is at stake.
#pragma GCC diagnostic ignored "-Wpsabi"

namespace vdb_offset {

inline constexpr std::size_t kRow = kTile;
inline constexpr double kTileCentre = 0.5 * (kTile - 1);

// The eight voxels of a row, in the compiler's vector types.
using Floats = float __attribute__((vector_size(kRow * sizeof(float))));
using Doubles = double __attribute__((vector_size(kRow * sizeof(double))));
using Truths = std::int32_t __attribute__((vector_size(kRow * sizeof(float))));

// Two rows side by side: what the widest registers hold.
using FloatPair = float __attribute__((vector_size(2 * kRow * sizeof(float))));
using DoublePair = double __attribute__((vector_size(2 * kRow * sizeof(double))));

template <typename Real>
struct Lanes;
template <>
struct Lanes<float> {
  using Pair = FloatPair;
};
template <>
struct Lanes<double> {
  using Pair = DoublePair;
};

/// Heights of the voxels about the tile's centre.
inline constexpr Floats kHeights{-3.5F, -2.5F, -1.5F, -0.5F, 0.5F, 1.5F, 2.5F, 3.5F};

/// Bit k is set where lane k holds.
VDB_OFFSET_INLINE unsigned bits(const Truths& truths) {
#ifdef __SSE2__
  using Four = float __attribute__((vector_size(16)));
  std::array<Four, 2> halves;
  std::memcpy(halves.data(), &truths, sizeof(truths));
  return static_cast<unsigned>(__builtin_ia32_movmskps(halves[0]) |
                               __builtin_ia32_movmskps(halves[1]) << 4);
#else
  unsigned out = 0;
  for (std::size_t k = 0; k < kRow; ++k) out |= truths[k] != 0 ? 1U << k : 0U;
  return out;
#endif
}

/// Whether any lane holds.
VDB_OFFSET_INLINE std::size_t any(const Truths& truths) {
#ifdef __SSE2__
  using Four = std::int32_t __attribute__((vector_size(16)));
  using FourFloats = float __attribute__((vector_size(16)));
  std::array<Four, 2> halves;
  std::memcpy(halves.data(), &truths, sizeof(truths));
  const Four either = halves[0] | halves[1];
  FourFloats signs;
  std::memcpy(&signs, &either, sizeof(signs));
  return __builtin_ia32_movmskps(signs) != 0 ? 1 : 0;
#else
  return bits(truths) != 0 ? 1 : 0;
#endif
}

VDB_OFFSET_INLINE Floats load(const float* p) {
  Floats row;
  std::memcpy(&row, p, sizeof(row));
  return row;
}

VDB_OFFSET_INLINE void store(float* p, const Floats& row) { std::memcpy(p, &row, sizeof(row)); }

VDB_OFFSET_INLINE FloatPair load_pair(const float* p) {
  FloatPair rows;
  std::memcpy(&rows, p, sizeof(rows));
  return rows;
}

VDB_OFFSET_INLINE void store_pair(float* p, const FloatPair& rows) {
  std::memcpy(p, &rows, sizeof(rows));
}

template <typename Row>
VDB_OFFSET_INLINE auto join(const Row& a, const Row& b) {
  return __builtin_shufflevector(a, b, 0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15);
}

VDB_OFFSET_INLINE Floats first_of(const FloatPair& rows) {
  return __builtin_shufflevector(rows, rows, 0, 1, 2, 3, 4, 5, 6, 7);
}

VDB_OFFSET_INLINE Floats second_of(const FloatPair& rows) {
  return __builtin_shufflevector(rows, rows, 8, 9, 10, 11, 12, 13, 14, 15);
}

/// Squared distance along one axis from each voxel to [lo, hi].
VDB_OFFSET_INLINE Floats gaps2(float lo, float hi) {
  const Floats below = lo - kHeights;
  const Floats above = kHeights - hi;
  Floats gap = below > above ? below : above;
  gap = gap > 0.0F ? gap : Floats{};
  return gap * gap;
}

}  // namespace vdb_offset
