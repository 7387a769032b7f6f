#include "sweep/lane_kernel.h"

#if defined(__AVX2__)
#include <immintrin.h>

namespace vdb_offset {

namespace {

struct Avx2Lanes {
  static constexpr std::size_t kWidth = 8;
  using V = __m256;
  using I = __m256i;
  using M = __m256;

  static V all(float x) { return _mm256_set1_ps(x); }
  static V load(const float* p) { return _mm256_load_ps(p); }
  static V load_any(const float* p) { return _mm256_loadu_ps(p); }
  static void store(float* p, V v) { _mm256_store_ps(p, v); }
  static void store_any(float* p, V v) { _mm256_storeu_ps(p, v); }
  static V add(V a, V b) { return _mm256_add_ps(a, b); }
  static V sub(V a, V b) { return _mm256_sub_ps(a, b); }
  static V mul(V a, V b) { return _mm256_mul_ps(a, b); }
  static V sqrt(V a) { return _mm256_sqrt_ps(a); }
  static V min(V a, V b) { return _mm256_min_ps(a, b); }
  static V max(V a, V b) { return _mm256_max_ps(a, b); }
  static V magnitude(V a) { return _mm256_andnot_ps(all(-0.0F), a); }
  static V min_magnitude(V a, V b) { return min(magnitude(a), magnitude(b)); }
  static M less(V a, V b) { return _mm256_cmp_ps(a, b, _CMP_LT_OQ); }
  static V select(M m, V yes, V no) { return _mm256_blendv_ps(no, yes, m); }
  static V negative_where(M m, V magnitude) {
    return _mm256_or_ps(magnitude, _mm256_and_ps(m, all(-0.0F)));
  }
  static M mask(std::uint64_t bits) {
    const I each = _mm256_setr_epi32(1, 2, 4, 8, 16, 32, 64, 128);
    const I own = _mm256_and_si256(_mm256_set1_epi32(static_cast<int>(bits)), each);
    return _mm256_castsi256_ps(_mm256_cmpeq_epi32(own, each));
  }
  static std::uint64_t bits(M m) { return static_cast<unsigned>(_mm256_movemask_ps(m)); }
  static std::uint64_t signs(V v) { return static_cast<unsigned>(_mm256_movemask_ps(v)); }
  static I one_hot(M valid, M x, M y, M z) {
    I set = _mm256_srli_epi32(_mm256_castps_si256(valid), 31);
    set = pick(x, _mm256_slli_epi32(set, 1), set);
    set = pick(y, _mm256_slli_epi32(set, 2), set);
    return pick(z, _mm256_slli_epi32(set, 4), set);
  }
  static I where(M m, I i) { return _mm256_and_si256(_mm256_castps_si256(m), i); }
  static I either(I a, I b) { return _mm256_or_si256(a, b); }
  static I unturned(I i, unsigned axis) {
    const I set = _mm256_and_si256(i, _mm256_set1_epi32(static_cast<int>(kTurned[axis])));
    return _mm256_srli_epi32(set, 1 << axis);
  }
  static std::uint32_t lane(const I& i, std::size_t n) {
    return reinterpret_cast<const std::uint32_t*>(&i)[n];
  }
  static void transpose(const float* const* tiles, std::ptrdiff_t row, V* out) {
    for (int n = 0; n < 8; ++n) out[n] = load_any(tiles[n] + row);
    flip(out);
  }
  static void untranspose(const V* in, float* const* tiles, std::ptrdiff_t row) {
    V v[8];
    for (int n = 0; n < 8; ++n) v[n] = in[n];
    flip(v);
    for (int n = 0; n < 8; ++n) store_any(tiles[n] + row, v[n]);
  }

 private:
  static I pick(M m, I yes, I no) {
    return _mm256_castps_si256(select(m, _mm256_castsi256_ps(yes), _mm256_castsi256_ps(no)));
  }
  static void flip(V* v) {
    V u[8];
    for (int n = 0; n < 8; n += 2) {
      u[n] = _mm256_unpacklo_ps(v[n], v[n + 1]);
      u[n + 1] = _mm256_unpackhi_ps(v[n], v[n + 1]);
    }
    V w[8];
    for (int n = 0; n < 8; n += 4) {
      w[n] = _mm256_shuffle_ps(u[n], u[n + 2], 0x44);
      w[n + 1] = _mm256_shuffle_ps(u[n], u[n + 2], 0xee);
      w[n + 2] = _mm256_shuffle_ps(u[n + 1], u[n + 3], 0x44);
      w[n + 3] = _mm256_shuffle_ps(u[n + 1], u[n + 3], 0xee);
    }
    for (int n = 0; n < 4; ++n) {
      v[n] = _mm256_permute2f128_ps(w[n], w[n + 4], 0x20);
      v[n + 4] = _mm256_permute2f128_ps(w[n], w[n + 4], 0x31);
    }
  }
};

}  // namespace

const Kernels* isa::avx2() { return &kKernels<Avx2Lanes>; }

}  // namespace vdb_offset

#else
const vdb_offset::Kernels* vdb_offset::isa::avx2() { return nullptr; }
#endif
