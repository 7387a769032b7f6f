#include "sweep/lane_kernel.h"

#if defined(__AVX512F__) && defined(__AVX512DQ__)
#include <immintrin.h>

namespace vdb_offset {

namespace {

struct Avx512Lanes {
  static constexpr std::size_t kWidth = 16;
  using V = __m512;
  using I = __m512i;
  using M = __mmask16;

  static V all(float x) { return _mm512_set1_ps(x); }
  static V load(const float* p) { return _mm512_load_ps(p); }
  static V load_any(const float* p) { return _mm512_loadu_ps(p); }
  static void store(float* p, V v) { _mm512_store_ps(p, v); }
  static void store_any(float* p, V v) { _mm512_storeu_ps(p, v); }
  static V add(V a, V b) { return _mm512_add_ps(a, b); }
  static V sub(V a, V b) { return _mm512_sub_ps(a, b); }
  static V mul(V a, V b) { return _mm512_mul_ps(a, b); }
  static V sqrt(V a) { return _mm512_sqrt_ps(a); }
  static V min(V a, V b) { return _mm512_min_ps(a, b); }
  static V max(V a, V b) { return _mm512_max_ps(a, b); }
  static V magnitude(V a) { return _mm512_andnot_ps(all(-0.0F), a); }
  static V min_magnitude(V a, V b) { return _mm512_range_ps(a, b, 0b1010); }
  static M less(V a, V b) { return _mm512_cmp_ps_mask(a, b, _CMP_LT_OQ); }
  static V select(M m, V yes, V no) { return _mm512_mask_blend_ps(m, no, yes); }
  static V negative_where(M m, V magnitude) {
    return _mm512_mask_or_ps(magnitude, m, magnitude, all(-0.0F));
  }
  static M mask(std::uint64_t bits) { return static_cast<M>(bits); }
  static std::uint64_t bits(M m) { return m; }
  static std::uint64_t signs(V v) { return _mm512_movepi32_mask(_mm512_castps_si512(v)); }
  static I one_hot(M valid, M x, M y, M z) {
    I set = _mm512_maskz_set1_epi32(valid, 1);
    set = _mm512_mask_slli_epi32(set, x, set, 1);
    set = _mm512_mask_slli_epi32(set, y, set, 2);
    return _mm512_mask_slli_epi32(set, z, set, 4);
  }
  static I where(M m, I i) { return _mm512_maskz_mov_epi32(m, i); }
  static I either(I a, I b) { return _mm512_or_si512(a, b); }
  static I unturned(I i, unsigned axis) {
    const I set = _mm512_and_si512(i, _mm512_set1_epi32(static_cast<int>(kTurned[axis])));
    return _mm512_srli_epi32(set, 1U << axis);
  }
  static std::uint32_t lane(const I& i, std::size_t n) {
    return reinterpret_cast<const std::uint32_t*>(&i)[n];
  }
  // Rows n and n + 8 share a register: two transposes of 8 x 8 at once.
  static void transpose(const float* const* tiles, std::ptrdiff_t row, V* out) {
    for (int n = 0; n < 8; ++n) {
      const V low = _mm512_castps256_ps512(_mm256_loadu_ps(tiles[n] + row));
      out[n] = _mm512_insertf32x8(low, _mm256_loadu_ps(tiles[n + 8] + row), 1);
    }
    flip(out);
  }
  static void untranspose(const V* in, float* const* tiles, std::ptrdiff_t row) {
    V v[8];
    for (int n = 0; n < 8; ++n) v[n] = in[n];
    flip(v);
    for (int n = 0; n < 8; ++n) {
      _mm256_storeu_ps(tiles[n] + row, _mm512_castps512_ps256(v[n]));
      _mm256_storeu_ps(tiles[n + 8] + row, _mm512_extractf32x8_ps(v[n], 1));
    }
  }

 private:
  static void flip(V* v) {
    V u[8];
    for (int n = 0; n < 8; n += 2) {
      u[n] = _mm512_unpacklo_ps(v[n], v[n + 1]);
      u[n + 1] = _mm512_unpackhi_ps(v[n], v[n + 1]);
    }
    V w[8];
    for (int n = 0; n < 8; n += 4) {
      w[n] = _mm512_shuffle_ps(u[n], u[n + 2], 0x44);
      w[n + 1] = _mm512_shuffle_ps(u[n], u[n + 2], 0xee);
      w[n + 2] = _mm512_shuffle_ps(u[n + 1], u[n + 3], 0x44);
      w[n + 3] = _mm512_shuffle_ps(u[n + 1], u[n + 3], 0xee);
    }
    const I even = _mm512_setr_epi32(0, 1, 2, 3, 16, 17, 18, 19, 8, 9, 10, 11, 24, 25, 26, 27);
    const I odd = _mm512_setr_epi32(4, 5, 6, 7, 20, 21, 22, 23, 12, 13, 14, 15, 28, 29, 30, 31);
    for (int n = 0; n < 4; ++n) {
      v[n] = _mm512_permutex2var_ps(w[n], even, w[n + 4]);
      v[n + 4] = _mm512_permutex2var_ps(w[n], odd, w[n + 4]);
    }
  }
};

}  // namespace

const Kernels* isa::avx512() { return &kKernels<Avx512Lanes>; }

}  // namespace vdb_offset

#else
const vdb_offset::Kernels* vdb_offset::isa::avx512() { return nullptr; }
#endif
