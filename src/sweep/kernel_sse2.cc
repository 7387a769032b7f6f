#include "sweep/lane_kernel.h"

#if defined(__SSE2__)
#include <immintrin.h>

namespace vdb_offset {

namespace {

struct Sse2Lanes {
  static constexpr std::size_t kWidth = 4;
  using V = __m128;
  using I = __m128i;
  using M = __m128;

  static V all(float x) { return _mm_set1_ps(x); }
  static V load(const float* p) { return _mm_load_ps(p); }
  static V load_any(const float* p) { return _mm_loadu_ps(p); }
  static void store(float* p, V v) { _mm_store_ps(p, v); }
  static void store_any(float* p, V v) { _mm_storeu_ps(p, v); }
  static V add(V a, V b) { return _mm_add_ps(a, b); }
  static V sub(V a, V b) { return _mm_sub_ps(a, b); }
  static V mul(V a, V b) { return _mm_mul_ps(a, b); }
  static V sqrt(V a) { return _mm_sqrt_ps(a); }
  static V min(V a, V b) { return _mm_min_ps(a, b); }
  static V max(V a, V b) { return _mm_max_ps(a, b); }
  static V magnitude(V a) { return _mm_andnot_ps(all(-0.0F), a); }
  static V min_magnitude(V a, V b) { return min(magnitude(a), magnitude(b)); }
  static M less(V a, V b) { return _mm_cmplt_ps(a, b); }
  static V select(M m, V yes, V no) { return _mm_or_ps(_mm_and_ps(m, yes), _mm_andnot_ps(m, no)); }
  static V negative_where(M m, V magnitude) {
    return _mm_or_ps(magnitude, _mm_and_ps(m, all(-0.0F)));
  }
  static M mask(std::uint64_t bits) {
    const I each = _mm_setr_epi32(1, 2, 4, 8);
    const I own = _mm_and_si128(_mm_set1_epi32(static_cast<int>(bits)), each);
    return _mm_castsi128_ps(_mm_cmpeq_epi32(own, each));
  }
  static std::uint64_t bits(M m) { return static_cast<unsigned>(_mm_movemask_ps(m)); }
  static std::uint64_t signs(V v) { return static_cast<unsigned>(_mm_movemask_ps(v)); }
  static I one_hot(M valid, M x, M y, M z) {
    I set = _mm_srli_epi32(_mm_castps_si128(valid), 31);
    set = pick(x, _mm_slli_epi32(set, 1), set);
    set = pick(y, _mm_slli_epi32(set, 2), set);
    return pick(z, _mm_slli_epi32(set, 4), set);
  }
  static I where(M m, I i) { return _mm_and_si128(_mm_castps_si128(m), i); }
  static I either(I a, I b) { return _mm_or_si128(a, b); }
  static I unturned(I i, unsigned axis) {
    const I set = _mm_and_si128(i, _mm_set1_epi32(static_cast<int>(kTurned[axis])));
    return _mm_srli_epi32(set, 1 << axis);
  }
  static std::uint32_t lane(const I& i, std::size_t n) {
    return reinterpret_cast<const std::uint32_t*>(&i)[n];
  }
  static void transpose(const float* const* tiles, std::ptrdiff_t row, V* out) {
    for (int half = 0; half < 8; half += 4) {
      V a = load_any(tiles[0] + row + half);
      V b = load_any(tiles[1] + row + half);
      V c = load_any(tiles[2] + row + half);
      V d = load_any(tiles[3] + row + half);
      _MM_TRANSPOSE4_PS(a, b, c, d);
      out[half] = a;
      out[half + 1] = b;
      out[half + 2] = c;
      out[half + 3] = d;
    }
  }
  static void untranspose(const V* in, float* const* tiles, std::ptrdiff_t row) {
    for (int half = 0; half < 8; half += 4) {
      V a = in[half];
      V b = in[half + 1];
      V c = in[half + 2];
      V d = in[half + 3];
      _MM_TRANSPOSE4_PS(a, b, c, d);
      store_any(tiles[0] + row + half, a);
      store_any(tiles[1] + row + half, b);
      store_any(tiles[2] + row + half, c);
      store_any(tiles[3] + row + half, d);
    }
  }

 private:
  static I pick(M m, I yes, I no) {
    return _mm_castps_si128(select(m, _mm_castsi128_ps(yes), _mm_castsi128_ps(no)));
  }
};

}  // namespace

const Kernels* isa::sse2() { return &kKernels<Sse2Lanes>; }

}  // namespace vdb_offset

#else
const vdb_offset::Kernels* vdb_offset::isa::sse2() { return nullptr; }
#endif
