#include <cmath>
#include <cstring>

#include "sweep/lane_kernel.h"

namespace vdb_offset {

namespace {

/// One lane in plain C++: the path for every processor, and the yardstick of the others.
struct ScalarLanes {
  static constexpr std::size_t kWidth = 1;
  using V = float;
  using I = unsigned;
  using M = bool;

  static V all(float x) { return x; }
  static V load(const float* p) { return *p; }
  static V load_any(const float* p) { return *p; }
  static void store(float* p, V v) { *p = v; }
  static void store_any(float* p, V v) { *p = v; }
  static V add(V a, V b) { return a + b; }
  static V sub(V a, V b) { return a - b; }
  static V mul(V a, V b) { return a * b; }
  static V sqrt(V a) { return std::sqrt(a); }
  static V min(V a, V b) { return a < b ? a : b; }
  static V max(V a, V b) { return a > b ? a : b; }
  static V magnitude(V a) { return std::fabs(a); }
  static V min_magnitude(V a, V b) { return min(magnitude(a), magnitude(b)); }
  static M less(V a, V b) { return a < b; }
  static V select(M m, V yes, V no) { return m ? yes : no; }
  static V negative_where(M m, V magnitude) { return m ? -magnitude : magnitude; }
  static M mask(std::uint64_t bits) { return bits != 0; }
  static std::uint64_t bits(M m) { return m ? 1 : 0; }
  static std::uint64_t signs(V v) { return std::signbit(v) ? 1 : 0; }
  static I one_hot(M valid, M x, M y, M z) {
    return valid ? 1U << ((x ? 1U : 0U) | (y ? 2U : 0U) | (z ? 4U : 0U)) : 0U;
  }
  static I where(M m, I i) { return m ? i : 0U; }
  static I either(I a, I b) { return a | b; }
  static I unturned(I i, unsigned axis) { return (i & kTurned[axis]) >> (1U << axis); }
  static std::uint32_t lane(I i, std::size_t) { return i; }
  static void transpose(const float* const* tiles, std::ptrdiff_t row, V* out) {
    for (int k = 0; k < 8; ++k) out[k] = tiles[0][row + k];
  }
  static void untranspose(const V* in, float* const* tiles, std::ptrdiff_t row) {
    for (int k = 0; k < 8; ++k) tiles[0][row + k] = in[k];
  }
};

}  // namespace

const Kernels* isa::scalar() { return &kKernels<ScalarLanes>; }

}  // namespace vdb_offset
