// Garanzha, Kaporin, Kudryavtseva, Protais, Ray, Sokolov, Foldover-free maps in 50 lines of code,
// 2021. Loops run over the cells of a stack, arrays side by side, so that the compiler makes
// vectors of them.
//
// With T = tr(A'A) = sum G_ij e_i.e_j (G = W^-1 W^-T) and p_i = sum_j G_ij e_j, q_i = dD/de_i:
//
//     df/de_i        = 2 f_T p_i + f_D q_i
//     d2f/de_i de_j ~= 2 f_T G_ij + 2 f_TD (p_i q_j' + q_i p_j') + f_DD q_i q_j'
//
// which leaves out f_D d2D/de_i de_j, of either sign.

#include "blocks/triad_energy.h"

#include <algorithm>
#include <cmath>

#include "blocks/triad_response.h"
#include "core/clones.h"

namespace vdb_offset {
namespace {

/// y += a * b
VDB_OFFSET_CLONES void add_product(double* y, const double* a, const double* b, std::size_t count) {
#pragma GCC ivdep
  for (std::size_t k = 0; k < count; ++k) y[k] += a[k] * b[k];
}

VDB_OFFSET_CLONES void subtract(double* y, const double* a, const double* b, std::size_t count) {
#pragma GCC ivdep
  for (std::size_t k = 0; k < count; ++k) y[k] = a[k] - b[k];
}

/// Arrays with a sign each, to be added up.
struct SignedArrays {
  std::array<const double*, 9> array{};
  std::array<double, 9> sign{};
  std::size_t count = 0;

  void add(const double* a, double s) {
    array[count] = a;
    sign[count++] = s;
  }
};

VDB_OFFSET_CLONES void accumulate(double* y, const SignedArrays& x, std::size_t count) {
  std::size_t n = 0;
  for (; n + 3 <= x.count; n += 3) {
    const double* a = x.array[n];
    const double* b = x.array[n + 1];
    const double* c = x.array[n + 2];
    const double sa = x.sign[n];
    const double sb = x.sign[n + 1];
    const double sc = x.sign[n + 2];
#pragma GCC ivdep
    for (std::size_t k = 0; k < count; ++k) y[k] += sa * a[k] + sb * b[k] + sc * c[k];
  }
  for (; n < x.count; ++n) {
    const double* a = x.array[n];
    const double sa = x.sign[n];
#pragma GCC ivdep
    for (std::size_t k = 0; k < count; ++k) y[k] += sa * a[k];
  }
}

/// c = a x b, times a scale.
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
    out[k] =
        e.mixed[k] * (e.pi[k] * e.qj[k] + e.qi[k] * e.pj[k]) + e.by_det2[k] * e.qi[k] * e.qj[k];
  }
}

std::size_t at(int index) { return static_cast<std::size_t>(index); }

}  // namespace

TriadEnergy::TriadEnergy(std::size_t levels, double epsilon)
    : cells_(levels - 1), count_(cells_), epsilon_(epsilon), store_(kArrays * cells_, 0.0) {}

void TriadEnergy::set_ideal(const Triad& triad) {
  const double sine = std::sqrt(1 - triad.cosine * triad.cosine);
  const double* heights = triad.heights_world->data() + first_;
  const double* first_length = triad.edges[0].length_world->data() + triad.edges[0].up + first_;
  const double* second_length = triad.edges[1].length_world->data() + triad.edges[1].up + first_;
  double* scale = array(kScale);
  double* g11 = array(kMetric);
  double* g12 = array(kMetric + 1);
  double* g22 = array(kMetric + 2);
  double* g33 = array(kMetric + 3);
  for (std::size_t k = 0; k < count_; ++k) {
    const double height = 1 / (heights[k + 1] - heights[k]);
    const double first = 1 / (first_length[k] * sine);
    const double second = 1 / (second_length[k] * sine);
    scale[k] = first * second * height * sine;
    g11[k] = first * first;
    g12[k] = -triad.cosine * first * second;
    g22[k] = second * second;
    g33[k] = height * height;
  }
}

/// Edges, their stretch, D and T.
void TriadEnergy::measure(const Triad& triad, const ColumnVector& x) {
  first_ = triad.first;
  count_ = cells_ - first_;
  set_ideal(triad);
  for (std::size_t i = 0; i < 3; ++i) {
    const Triad::Point& from = triad.points[triad.edges[i].from];
    const Triad::Point& to = triad.points[triad.edges[i].to];
    for (std::size_t a = 0; a < 3; ++a) {
      subtract(array(kEdges + 3 * i + a), x.at(at(to.column), a) + at(to.up) + first_,
               x.at(at(from.column), a) + at(from.up) + first_, count_);
    }
  }
  for (std::size_t i = 0; i < 3; ++i) {
    const std::size_t j = kEdges + 3 * ((i + 1) % 3);
    const std::size_t l = kEdges + 3 * ((i + 2) % 3);
    cross({array(j), array(j + 1), array(j + 2), array(l), array(l + 1), array(l + 2)},
          array(kScale),
          {array(kCross + 3 * i), array(kCross + 3 * i + 1), array(kCross + 3 * i + 2)}, count_);
  }
  const double* g11 = array(kMetric);
  const double* g12 = array(kMetric + 1);
  const double* g22 = array(kMetric + 2);
  const double* g33 = array(kMetric + 3);
  double* trace = array(kTrace);
  double* det = array(kDet);
  std::fill(trace, trace + count_, 0.0);
  std::fill(det, det + count_, 0.0);
  for (std::size_t a = 0; a < 3; ++a) {
    const double* e1 = array(kEdges + a);
    const double* e2 = array(kEdges + 3 + a);
    const double* e3 = array(kEdges + 6 + a);
    const double* q3 = array(kCross + 6 + a);
    double* p1 = array(kStretch + a);
    double* p2 = array(kStretch + 3 + a);
    double* p3 = array(kStretch + 6 + a);
#pragma GCC ivdep
    for (std::size_t k = 0; k < count_; ++k) {
      p1[k] = g11[k] * e1[k] + g12[k] * e2[k];
      p2[k] = g12[k] * e1[k] + g22[k] * e2[k];
      p3[k] = g33[k] * e3[k];
      trace[k] += p1[k] * e1[k] + p2[k] * e2[k] + p3[k] * e3[k];
      det[k] += q3[k] * e3[k];
    }
  }
}

/// f and its derivatives by T and D.
TriadEnergy::Sum TriadEnergy::evaluate(double weight, bool derivatives) {
  TriadResponse response;
  response.shape = weight * (1 - kVolumeWeight) / 3;
  response.volume = weight * kVolumeWeight / 2;
  response.epsilon = epsilon_;
  response.trace = array(kTrace);
  response.det = array(kDet);
  response.energy = array(kEnergy);
  response.by_trace = array(kByTrace);
  response.by_det = array(kByDet);
  response.mixed = array(kMixed);
  response.by_det2 = array(kByDet2);
  if (derivatives) {
    respond_and_derive(response, count_);
  } else {
    respond(response, count_);
  }
  Sum sum{0, response.det[0]};
  for (std::size_t k = 0; k < count_; ++k) {
    sum.energy += response.energy[k];
    sum.least = std::min(sum.least, response.det[k]);
  }
  return sum;
}

void TriadEnergy::second_derivatives() {
  static constexpr std::array<std::array<std::size_t, 2>, 6> kPairs{
      {{0, 0}, {1, 1}, {2, 2}, {0, 1}, {0, 2}, {1, 2}}};
  std::size_t block = kBlocks;
  for (const auto& [i, j] : kPairs) {
    for (std::size_t r = 0; r < 3; ++r) {
      for (std::size_t c = i == j ? r : 0; c < 3; ++c, ++block) {
        outer({array(kStretch + 3 * i + r), array(kCross + 3 * i + r), array(kStretch + 3 * j + c),
               array(kCross + 3 * j + c), array(kMixed), array(kByDet2)},
              array(block), count_);
        if (r != c || (i != j && j == 2)) continue;
        add_product(array(block), array(kByTrace), array(kMetric + (j < 2 ? i + j : 3)), count_);
      }
    }
  }
}

/// Entry of H_ij, row by row.
const double* TriadEnergy::block_entry(std::size_t i, std::size_t j, std::size_t entry) {
  if (i == j) return array(kBlocks + 6 * i + kUpper[entry]);
  const std::size_t part = i + j - 1;  // 12, 13, 23
  const std::size_t turned = 3 * (entry % 3) + entry / 3;
  return array(kBlocks + 18 + 9 * part + (i < j ? entry : turned));
}

void TriadEnergy::scatter_gradient(const Triad& triad, ColumnVector& gradient) {
  const double* by_trace = array(kByTrace);
  const double* by_det = array(kByDet);
  for (std::size_t a = 0; a < 3; ++a) {
    for (std::size_t i = 0; i < 3; ++i) {
      double* edge = array(kEdges + 3 * i + a);  // no longer needed
      const double* p = array(kStretch + 3 * i + a);
      const double* q = array(kCross + 3 * i + a);
#pragma GCC ivdep
      for (std::size_t k = 0; k < count_; ++k) edge[k] = by_trace[k] * p[k] + by_det[k] * q[k];
    }
    for (std::size_t n = 0; n < 4; ++n) {
      SignedArrays parts;
      for (std::size_t i = 0; i < 3; ++i) {
        if (triad.sign(i, n) != 0) parts.add(array(kEdges + 3 * i + a), triad.sign(i, n));
      }
      const Triad::Point& point = triad.points[n];
      accumulate(gradient.at(at(point.column), a) + at(point.up) + first_, parts, count_);
    }
  }
}

void TriadEnergy::scatter_hessian(const Triad& triad, ColumnSystem& hessian) {
  for (std::size_t first = 0; first < 4; ++first) {
    for (std::size_t second = first; second < 4; ++second) {
      // Within a column blocks are kept from the lower level to the upper.
      const bool turn = triad.points[first].column == triad.points[second].column &&
                        triad.points[first].up > triad.points[second].up;
      const std::size_t m = turn ? second : first;
      const std::size_t n = turn ? first : second;
      const Triad::Point& row = triad.points[m];
      const Triad::Point& column = triad.points[n];
      const BlockRun run =
          hessian.blocks(row.column, column.column, at(row.up) + first_, column.up - row.up);
      if (!run) continue;
      for (std::size_t e = 0; e < 9; ++e) {
        if (m == n && e / 3 > e % 3) continue;
        SignedArrays parts;
        for (std::size_t i = 0; i < 3; ++i) {
          for (std::size_t j = 0; j < 3; ++j) {
            const double sign = triad.sign(i, m) * triad.sign(j, n);
            if (sign != 0) parts.add(block_entry(i, j, e), sign);
          }
        }
        accumulate(run.entry[e], parts, count_);
      }
    }
  }
}

TriadEnergy::Sum TriadEnergy::value(const Triad& triad, const ColumnVector& x) {
  measure(triad, x);
  return evaluate(triad.weight, false);
}

TriadEnergy::Sum TriadEnergy::expand(const Triad& triad, const ColumnVector& x,
                                     const Derivatives& out) {
  measure(triad, x);
  const Sum sum = evaluate(triad.weight, true);
  second_derivatives();
  scatter_gradient(triad, out.gradient);
  scatter_hessian(triad, out.hessian);
  return sum;
}

}  // namespace vdb_offset
