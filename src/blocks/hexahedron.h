#pragma once

// Measures of a hexahedron, of one cell or of several side by side: Real is double or Pack. Both
// are made from the same lines in the same order, so that they agree bit for bit.
//
// A cell stands between two levels. Corner n of a level lies at i = n & 1, j = n >> 1; the edges of
// a level are x[j] along i and y[i] along j, and column n rises from corner n. With the level's
// corner areas a[n] = x[n >> 1] x y[n & 1] the corner Jacobians are a[n] . column[n], so that each
// area serves the cell above and the cell below.

#include <array>
#include <cmath>
#include <cstring>

#ifdef __SSE2__
#include <emmintrin.h>
#endif

#include "core/clones.h"

// Vectors pass between functions that become one: no calling convention is at stake.
#pragma GCC diagnostic ignored "-Wpsabi"

namespace vdb_offset::hexahedron {

inline constexpr std::size_t kPack = 4;
using Pack = double __attribute__((vector_size(kPack * sizeof(double))));

VDB_OFFSET_INLINE double root(double value) { return std::sqrt(value); }

VDB_OFFSET_INLINE Pack root(const Pack& values) {
#ifdef __SSE2__
  const __m128d low = _mm_sqrt_pd(__builtin_shufflevector(values, values, 0, 1));
  const __m128d high = _mm_sqrt_pd(__builtin_shufflevector(values, values, 2, 3));
  return __builtin_shufflevector(low, high, 0, 1, 2, 3);
#else
  Pack roots;
  for (std::size_t n = 0; n < kPack; ++n) roots[n] = std::sqrt(values[n]);
  return roots;
#endif
}

template <typename Real>
VDB_OFFSET_INLINE Real least(const Real& a, const Real& b) {
  return a < b ? a : b;
}
template <typename Real>
VDB_OFFSET_INLINE Real greatest(const Real& a, const Real& b) {
  return a > b ? a : b;
}
template <typename Real>
VDB_OFFSET_INLINE Real size_of(const Real& a) {
  return greatest(a, Real(-a));
}
/// 1 / sqrt(value), 0 for 0.
template <typename Real>
VDB_OFFSET_INLINE Real inverse_root(const Real& value) {
  const Real inverse = 1.0 / root(value);
  return value > Real{} ? inverse : Real{};
}

template <typename Real>
struct Triple {
  Real x, y, z;
};

template <typename Real>
VDB_OFFSET_INLINE Triple<Real> operator+(const Triple<Real>& a, const Triple<Real>& b) {
  return {a.x + b.x, a.y + b.y, a.z + b.z};
}
template <typename Real>
VDB_OFFSET_INLINE Triple<Real> operator-(const Triple<Real>& a, const Triple<Real>& b) {
  return {a.x - b.x, a.y - b.y, a.z - b.z};
}
template <typename Real>
VDB_OFFSET_INLINE Real dot(const Triple<Real>& a, const Triple<Real>& b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}
template <typename Real>
VDB_OFFSET_INLINE Triple<Real> cross(const Triple<Real>& a, const Triple<Real>& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
template <typename Real>
VDB_OFFSET_INLINE Real det(const Triple<Real>& a, const Triple<Real>& b, const Triple<Real>& c) {
  return dot(cross(a, b), c);
}

template <typename Real>
struct CellEdge {
  Triple<Real> along;
  Real length2;
  Real inverse;  ///< 1 / length; infinite for a collapsed edge
};

template <typename Real>
VDB_OFFSET_INLINE CellEdge<Real> edge(const Triple<Real>& from, const Triple<Real>& to) {
  const Triple<Real> along = to - from;
  const Real length2 = dot(along, along);
  return {along, length2, 1.0 / root(length2)};
}

/// What a level's face between four columns gives to the cells on both sides.
template <typename Real>
struct LevelFace {
  std::array<Triple<Real>, 4> area;  ///< of corner n
  std::array<Real, 4> inverse;       ///< 1 / (|x| |y|) at corner n
  Triple<Real> sum_x, sum_y;
  Real shortest2, longest2;
};

template <typename Real>
VDB_OFFSET_INLINE LevelFace<Real> level_face(const std::array<CellEdge<Real>, 2>& x,
                                             const std::array<CellEdge<Real>, 2>& y) {
  LevelFace<Real> face;
  for (std::size_t n = 0; n < 4; ++n) {
    face.area[n] = cross(x[n >> 1U].along, y[n & 1U].along);
    face.inverse[n] = x[n >> 1U].inverse * y[n & 1U].inverse;
  }
  face.sum_x = x[0].along + x[1].along;
  face.sum_y = y[0].along + y[1].along;
  face.shortest2 = least(least(x[0].length2, x[1].length2), least(y[0].length2, y[1].length2));
  face.longest2 =
      greatest(greatest(x[0].length2, x[1].length2), greatest(y[0].length2, y[1].length2));
  return face;
}

template <typename Real>
struct Measures {
  Real scaled_jacobian;
  Real min_jacobian;
  Real least_part;  ///< of the corner Jacobians and of six times the six tetrahedra
  Real volume;
  Real skewness;
  Real aspect2;  ///< of the aspect ratio the square
  Real orthogonality;
  Real growth2;  ///< of the growth the square; 0 for a cell on no other
  Real sound;    ///< above 0 for a cell with all its edges, of finite size
};

template <typename Real>
struct Cell {
  LevelFace<Real> below, above;
  std::array<CellEdge<Real>, 4> column;
  std::array<Triple<Real>, 8> corner;  ///< n on the level below, 4 + n on the level above
};

/// Corner Jacobians, edges, and the wall-side face.
template <typename Real>
VDB_OFFSET_INLINE void measure_corners(const Cell<Real>& c, Measures<Real>& m) {
  Real shortest2 = least(c.below.shortest2, c.above.shortest2);
  Real longest2 = greatest(c.below.longest2, c.above.longest2);
  const Triple<Real> normal =
      (c.below.area[0] + c.below.area[1]) + (c.below.area[2] + c.below.area[3]);
  for (std::size_t n = 0; n < 4; ++n) {
    const CellEdge<Real>& up = c.column[n];
    const Real low = dot(c.below.area[n], up.along);
    const Real high = dot(c.above.area[n], up.along);
    const Real scaled =
        least(low * c.below.inverse[n] * up.inverse, high * c.above.inverse[n] * up.inverse);
    const Real rise = dot(normal, up.along) * up.inverse;
    m.min_jacobian = n == 0 ? least(low, high) : least(m.min_jacobian, least(low, high));
    m.scaled_jacobian = n == 0 ? scaled : least(m.scaled_jacobian, scaled);
    m.orthogonality = n == 0 ? rise : least(m.orthogonality, rise);
    shortest2 = least(shortest2, up.length2);
    longest2 = greatest(longest2, up.length2);
  }
  m.orthogonality = m.orthogonality * inverse_root(dot(normal, normal));
  m.aspect2 = longest2 / shortest2;
  m.sound = shortest2;
}

/// Principal axes: Jacobian of the centre, and skewness.
template <typename Real>
VDB_OFFSET_INLINE void measure_axes(const Cell<Real>& c, Measures<Real>& m) {
  const Triple<Real> x = c.below.sum_x + c.above.sum_x;
  const Triple<Real> y = c.below.sum_y + c.above.sum_y;
  const Triple<Real> z =
      (c.column[0].along + c.column[1].along) + (c.column[2].along + c.column[3].along);
  const Real x2 = dot(x, x);
  const Real y2 = dot(y, y);
  const Real z2 = dot(z, z);
  const Real ix = inverse_root(x2);
  const Real iy = inverse_root(y2);
  const Real iz = inverse_root(z2);
  m.scaled_jacobian = least(m.scaled_jacobian, Real(det(x, y, z) * ix * iy * iz));
  const Real xy = size_of(Real(dot(x, y) * ix * iy));
  const Real yz = size_of(Real(dot(y, z) * iy * iz));
  const Real zx = size_of(Real(dot(z, x) * iz * ix));
  const Real skewness = greatest(xy, greatest(yz, zx));
  const Real one = Real{} + 1.0;
  m.skewness = least(x2, least(y2, z2)) > Real{} ? least(skewness, one) : one;
}

/// The ring of corners around the diagonal 0-7; each neighbouring pair makes a tetrahedron with it.
inline constexpr std::array<std::size_t, 7> kRing{1, 3, 2, 6, 4, 5, 1};

template <typename Real>
VDB_OFFSET_INLINE void measure_tetrahedra(const Cell<Real>& c, Measures<Real>& m) {
  const Triple<Real> diagonal = c.corner[7] - c.corner[0];
  m.least_part = m.min_jacobian;
  Triple<Real> a = c.corner[kRing[0]] - c.corner[0];
  for (std::size_t t = 0; t < 6; ++t) {
    const Triple<Real> b = c.corner[kRing[t + 1]] - c.corner[0];
    const Real six_fold = det(a, b, diagonal);
    m.least_part = least(m.least_part, six_fold);
    a = b;
  }
}

/// Of the trilinear map, collapsed edges or not (Grandy, Efficient computation of volume of
/// hexahedral cells, 1997).
template <typename Real>
VDB_OFFSET_INLINE Real volume_of(const std::array<Triple<Real>, 8>& q) {
  const Triple<Real> from1 = q[7] - q[1];
  const Triple<Real> from2 = q[7] - q[2];
  const Triple<Real> from4 = q[7] - q[4];
  const Triple<Real> to3 = q[3] - q[0];
  const Triple<Real> to5 = q[5] - q[0];
  const Triple<Real> to6 = q[6] - q[0];
  const Real twelve_fold =
      det(from1 + to6, from2, to3) + det(to6, from2 + to5, from4) + det(from1, to5, from4 + to3);
  return twelve_fold * (1.0 / 12.0);
}

template <typename Real>
VDB_OFFSET_INLINE Measures<Real> measure(const Cell<Real>& cell) {
  Measures<Real> m{};
  measure_corners(cell, m);
  measure_axes(cell, m);
  measure_tetrahedra(cell, m);
  m.volume = volume_of(cell.corner);
  m.sound =
      m.sound + 0.0 * (m.volume + m.scaled_jacobian);  // not a number, if these are not finite
  return m;
}

/// One cell, corner n + 4 k; growth is left at 0.
template <typename Real>
VDB_OFFSET_INLINE Measures<Real> measure(const std::array<Triple<Real>, 8>& q) {
  Cell<Real> cell;
  cell.corner = q;
  cell.below =
      level_face<Real>({edge(q[0], q[1]), edge(q[2], q[3])}, {edge(q[0], q[2]), edge(q[1], q[3])});
  cell.above =
      level_face<Real>({edge(q[4], q[5]), edge(q[6], q[7])}, {edge(q[4], q[6]), edge(q[5], q[7])});
  for (std::size_t n = 0; n < 4; ++n) cell.column[n] = edge(q[n], q[n + 4]);
  return measure(cell);
}

/// Measures of a single cell, collapsed edges and numbers that are not finite included. Corner n
/// lies at i = n & 1, j = n >> 1 & 1, k = n >> 2.
Measures<double> measure_cell(const std::array<Triple<double>, 8>& corners_world);

}  // namespace vdb_offset::hexahedron
