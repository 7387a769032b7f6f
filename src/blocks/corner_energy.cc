// Garanzha, Kaporin, Kudryavtseva, Protais, Ray, Sokolov, Foldover-free maps in 50 lines of code,
// 2021. Loops run over the levels of a column, arrays side by side, so that the compiler makes
// vectors of them.
//
// With T = tr(A'A) = sum G_ij e_i.e_j (G = W^-1 W^-T) and p_i = sum_j G_ij e_j, q_i = dD/de_i:
//
//     df/de_i        = 2 f_T p_i + f_D q_i
//     d2f/de_i de_j ~= 2 f_T G_ij + 2 f_TD (p_i q_j' + q_i p_j') + f_DD q_i q_j'
//
// which leaves out f_D d2D/de_i de_j, of either sign.

#include "blocks/corner_energy.h"

#include <algorithm>
#include <cmath>

namespace vdb_offset {
namespace {

#define VDB_OFFSET_CLONES __attribute__((target_clones("avx512f", "avx2", "default")))

/// y += sign * x
VDB_OFFSET_CLONES void accumulate(double* y, const double* x, double sign, std::size_t count) {
#pragma GCC ivdep
  for (std::size_t k = 0; k < count; ++k) y[k] += sign * x[k];
}

VDB_OFFSET_CLONES void accumulate3(double* y, const std::array<const double*, 3>& x, double sign,
                                   std::size_t count) {
  const double* a = x[0];
  const double* b = x[1];
  const double* c = x[2];
#pragma GCC ivdep
  for (std::size_t k = 0; k < count; ++k) y[k] += sign * (a[k] + b[k] + c[k]);
}

/// y += a * b
VDB_OFFSET_CLONES void add_product(double* y, const double* a, const double* b, std::size_t count) {
#pragma GCC ivdep
  for (std::size_t k = 0; k < count; ++k) y[k] += a[k] * b[k];
}

VDB_OFFSET_CLONES void subtract(double* y, const double* a, const double* b, std::size_t count) {
#pragma GCC ivdep
  for (std::size_t k = 0; k < count; ++k) y[k] = a[k] - b[k];
}

/// c = a x b, times a scale by level.
VDB_OFFSET_CLONES void cross(const std::array<const double*, 6>& ab, const double* scale,
                             const std::array<double*, 3>& c, std::size_t count) {
  for (std::size_t r = 0; r < 3; ++r) {
    const double* a1 = ab[(r + 1) % 3];
    const double* a2 = ab[(r + 2) % 3];
    const double* b1 = ab[3 + (r + 1) % 3];
    const double* b2 = ab[3 + (r + 2) % 3];
    double* out = c[r];
#pragma GCC ivdep
    for (std::size_t k = 0; k < count; ++k) out[k] = scale[k] * (a1[k] * b2[k] - a2[k] * b1[k]);
  }
}

struct Entry {
  const double *pi, *qi, *pj, *qj, *mixed, *by_det2;
};

VDB_OFFSET_CLONES void outer(const Entry& e, double* out, std::size_t count) {
#pragma GCC ivdep
  for (std::size_t k = 0; k < count; ++k) {
    out[k] = e.mixed[k] * (e.pi[k] * e.qj[k] + e.qi[k] * e.pj[k]) + e.by_det2[k] * e.qi[k] * e.qj[k];
  }
}

}  // namespace

CornerEnergy::CornerEnergy(std::size_t levels) : levels_(levels), store_(kArrays * levels, 0.0) {}

/// Edges, their stretch, D and T of the corners at levels `base`, `base` + 1, ... of the cells
/// 0, 1, ...; base 0: the corners below, 1: those above.
void CornerEnergy::measure(const Corner& corner, const ColumnVector& x,
                           const std::vector<double>& heights, std::size_t base) {
  const std::size_t count = levels_ - 1;
  const CornerIdeal& w = corner.ideal;
  const double sine = std::sqrt(1 - w.cosine * w.cosine);
  const auto c = static_cast<std::size_t>(corner.column);
  double* scale = array(kValue);
  double* g11 = array(kMetric);
  double* g12 = array(kMetric + 1);
  double* g22 = array(kMetric + 2);
  double* g33 = array(kMetric + 3);
  for (std::size_t k = 0; k < count; ++k) {
    const double height = 1 / (heights[k + 1] - heights[k]);
    const double first = 1 / (w.first_world[k + base] * sine);
    const double second = 1 / (w.second_world[k + base] * sine);
    scale[k] = first * second * height * sine;
    g11[k] = first * first;
    g12[k] = -w.cosine * first * second;
    g22[k] = second * second;
    g33[k] = height * height;
  }
  for (std::size_t a = 0; a < 3; ++a) {
    const double* own = x.at(c, a);
    const double* next = x.at(static_cast<std::size_t>(corner.next), a);
    const double* previous = x.at(static_cast<std::size_t>(corner.previous), a);
    subtract(array(kEdges + a), next + base, own + base, count);
    subtract(array(kEdges + 3 + a), previous + base, own + base, count);
    subtract(array(kEdges + 6 + a), own + 1, own, count);
  }
  const auto edges = [&](std::size_t i, std::size_t j) {
    return std::array<const double*, 6>{array(kEdges + 3 * i), array(kEdges + 3 * i + 1),
                                        array(kEdges + 3 * i + 2), array(kEdges + 3 * j),
                                        array(kEdges + 3 * j + 1), array(kEdges + 3 * j + 2)};
  };
  for (std::size_t i = 0; i < 3; ++i) {
    cross(edges((i + 1) % 3, (i + 2) % 3), scale,
          {array(kCross + 3 * i), array(kCross + 3 * i + 1), array(kCross + 3 * i + 2)}, count);
  }
  double* trace = array(kTrace);
  double* det = array(kDet);
  std::fill(trace, trace + count, 0.0);
  std::fill(det, det + count, 0.0);
  for (std::size_t a = 0; a < 3; ++a) {
    const double* e1 = array(kEdges + a);
    const double* e2 = array(kEdges + 3 + a);
    const double* e3 = array(kEdges + 6 + a);
    const double* q3 = array(kCross + 6 + a);
    double* p1 = array(kStretch + a);
    double* p2 = array(kStretch + 3 + a);
    double* p3 = array(kStretch + 6 + a);
#pragma GCC ivdep
    for (std::size_t k = 0; k < count; ++k) {
      p1[k] = g11[k] * e1[k] + g12[k] * e2[k];
      p2[k] = g12[k] * e1[k] + g22[k] * e2[k];
      p3[k] = g33[k] * e3[k];
      trace[k] += p1[k] * e1[k] + p2[k] * e2[k] + p3[k] * e3[k];
      det[k] += q3[k] * e3[k];
    }
  }
}

/// f and its derivatives by T and D.
CornerEnergy::Sum CornerEnergy::evaluate(std::size_t count, bool derivatives) {
  constexpr double kShape = (1 - kVolumeWeight) / 3;
  constexpr double kVolume = kVolumeWeight / 2;
  const double* trace = array(kTrace);
  const double* det = array(kDet);
  Sum sum;
  sum.least = det[0];
  for (std::size_t k = 0; k < count; ++k) {
    const double t = trace[k];
    const double d = det[k];
    const double root = std::sqrt(epsilon * epsilon + d * d);
    // Without cancellation where D < 0.
    const double chi = d > 0 ? 0.5 * (d + root) : 0.5 * epsilon * epsilon / (root - d);
    const double cube = std::cbrt(chi);
    const double g = 1 / (cube * cube);
    const double v = d * d + 1;
    sum.energy += kShape * t * g + kVolume * v / chi;
    sum.least = std::min(sum.least, d);
    if (!derivatives) continue;
    const double slope = chi / root;  // dchi/dD
    const double s = slope / chi;
    array(kByTrace)[k] = 2 * kShape * g;
    array(kByDet)[k] = -2.0 / 3 * kShape * t * g * s + kVolume * (2 * d - v * s) / chi;
    array(kMixed)[k] = -4.0 / 3 * kShape * g * s;
    array(kByDet2)[k] =
        10.0 / 9 * kShape * t * g * s * s + kVolume * 2 * (1 - 2 * d * s + v * s * s) / chi;
  }
  return sum;
}

void CornerEnergy::second_derivatives() {
  const std::size_t count = levels_ - 1;
  static constexpr std::array<std::array<std::size_t, 2>, 6> kPairs{
      {{0, 0}, {1, 1}, {2, 2}, {0, 1}, {0, 2}, {1, 2}}};
  std::size_t block = kBlocks;
  for (const auto& [i, j] : kPairs) {
    for (std::size_t r = 0; r < 3; ++r) {
      for (std::size_t c = i == j ? r : 0; c < 3; ++c, ++block) {
        outer({array(kStretch + 3 * i + r), array(kCross + 3 * i + r), array(kStretch + 3 * j + c),
               array(kCross + 3 * j + c), array(kMixed), array(kByDet2)},
              array(block), count);
        if (r != c || (i != j && j == 2)) continue;
        add_product(array(block), array(kByTrace), array(kMetric + (j < 2 ? i + j : 3)), count);
      }
    }
  }
}

void CornerEnergy::scatter_gradient(const Corner& corner, std::size_t base,
                                    ColumnVector& gradient) {
  const std::size_t count = levels_ - 1;
  const double* by_trace = array(kByTrace);
  const double* by_det = array(kByDet);
  for (std::size_t a = 0; a < 3; ++a) {
    for (std::size_t i = 0; i < 3; ++i) {
      double* edge = array(kEdges + 3 * i + a);  // no longer needed
      const double* p = array(kStretch + 3 * i + a);
      const double* q = array(kCross + 3 * i + a);
#pragma GCC ivdep
      for (std::size_t k = 0; k < count; ++k) edge[k] = by_trace[k] * p[k] + by_det[k] * q[k];
    }
    const double* g1 = array(kEdges + a);
    const double* g2 = array(kEdges + 3 + a);
    const double* g3 = array(kEdges + 6 + a);
    accumulate(gradient.at(static_cast<std::size_t>(corner.next), a) + base, g1, 1, count);
    accumulate(gradient.at(static_cast<std::size_t>(corner.previous), a) + base, g2, 1, count);
    double* own = gradient.at(static_cast<std::size_t>(corner.column), a);
    accumulate(own + base, g1, -1, count);
    accumulate(own + base, g2, -1, count);
    accumulate(own + 1, g3, 1, count);
    accumulate(own, g3, -1, count);
  }
}

/// The corner's own point b moves all three edges; the next, the previous, and the point above or
/// below it in its column (v) one each.
void CornerEnergy::scatter_hessian(const Corner& corner, std::size_t base, ColumnSystem& hessian) {
  const std::size_t count = levels_ - 1;
  static constexpr std::array<std::size_t, 9> kUpper{0, 1, 2, 1, 3, 4, 2, 4, 5};
  // Entry (r, c) of H_ij.
  const auto h = [&](std::size_t i, std::size_t j, std::size_t e) -> const double* {
    if (i == j) return array(kBlocks + 6 * i + kUpper[e]);
    const std::size_t part = i + j - 1;  // 12, 13, 23
    const std::size_t turned = 3 * (e % 3) + e / 3;
    return array(kBlocks + 18 + 9 * part + (i < j ? e : turned));
  };
  const int own = corner.column;
  const std::array<int, 2> ends{corner.next, corner.previous};
  const double up = base == 0 ? 1 : -1;  // e3 = up * (v - b)
  const int step = base == 0 ? 1 : -1;   // from b's level to v's
  const std::size_t far = 1 - base;      // v's level
  for (std::size_t i = 0; i < 2; ++i) {
    const BlockRun self = hessian.blocks(ends[i], ends[i], base, 0);
    const BlockRun to_own = hessian.blocks(own, ends[i], base, 0);
    const BlockRun to_far = hessian.blocks(own, ends[i], far, -step);
    for (std::size_t e = 0; e < 9; ++e) {
      if (self && e / 3 <= e % 3) accumulate(self.entry[e], h(i, i, e), 1, count);
      if (!to_own) continue;
      // d2/db dx_i = -(H_1i + H_2i + up H_3i)
      accumulate(to_own.entry[e], h(0, i, e), -1, count);
      accumulate(to_own.entry[e], h(1, i, e), -1, count);
      accumulate(to_own.entry[e], h(2, i, e), -up, count);
      accumulate(to_far.entry[e], h(2, i, e), up, count);
    }
  }
  if (const BlockRun across = hessian.blocks(ends[0], ends[1], base, 0)) {
    for (std::size_t e = 0; e < 9; ++e) accumulate(across.entry[e], h(0, 1, e), 1, count);
  }
  const BlockRun below = hessian.blocks(own, own, 0, 0);
  if (!below) return;
  const BlockRun above = hessian.blocks(own, own, 1, 0);
  const BlockRun upward = hessian.blocks(own, own, 0, 1);
  const BlockRun& at_base = base == 0 ? below : above;
  const BlockRun& at_far = base == 0 ? above : below;
  for (std::size_t e = 0; e < 9; ++e) {
    const std::size_t turned = 3 * (e % 3) + e / 3;
    if (e / 3 <= e % 3) {
      accumulate3(at_base.entry[e], {h(0, 0, e), h(1, 1, e), h(2, 2, e)}, 1, count);
      accumulate3(at_base.entry[e], {h(0, 1, e), h(0, 2, e), h(1, 2, e)}, 1, count);
      accumulate3(at_base.entry[e], {h(0, 1, turned), h(0, 2, turned), h(1, 2, turned)}, 1, count);
      if (base == 1) {
        // up = -1: the terms with one third edge have the other sign.
        accumulate3(at_base.entry[e], {h(0, 2, e), h(1, 2, e), h(0, 2, turned)}, -2, count);
        accumulate(at_base.entry[e], h(1, 2, turned), -2, count);
      }
      accumulate(at_far.entry[e], h(2, 2, e), 1, count);
    }
    // d2/db dv = -up (H_13 + H_23) - H_33; stored from the lower level to the upper.
    const std::size_t entry = base == 0 ? e : turned;
    accumulate(upward.entry[entry], h(0, 2, e), -up, count);
    accumulate(upward.entry[entry], h(1, 2, e), -up, count);
    accumulate(upward.entry[entry], h(2, 2, e), -1, count);
  }
}

CornerEnergy::Sum CornerEnergy::value(const Corner& corner, const ColumnVector& x,
                                      const std::vector<double>& heights) {
  Sum total;
  for (std::size_t base = 0; base < 2; ++base) {
    measure(corner, x, heights, base);
    const Sum part = evaluate(levels_ - 1, false);
    total.least = base == 0 ? part.least : std::min(total.least, part.least);
    total.energy += part.energy;
  }
  return total;
}

CornerEnergy::Sum CornerEnergy::expand(const Corner& corner, const ColumnVector& x,
                                       const std::vector<double>& heights, ColumnVector& gradient,
                                       ColumnSystem& hessian) {
  Sum total;
  for (std::size_t base = 0; base < 2; ++base) {
    measure(corner, x, heights, base);
    const Sum part = evaluate(levels_ - 1, true);
    total.least = base == 0 ? part.least : std::min(total.least, part.least);
    total.energy += part.energy;
    second_derivatives();
    scatter_gradient(corner, base, gradient);
    scatter_hessian(corner, base, hessian);
  }
  return total;
}

}  // namespace vdb_offset
