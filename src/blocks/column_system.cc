// The columns' own blocks are solved exactly, as thin cells couple levels far more strongly than
// neighbours; block elimination of a tridiagonal matrix (Golub, Van Loan, Matrix Computations).

#include "blocks/column_system.h"

#include <Eigen/LU>
#include <algorithm>
#include <map>

namespace vdb_offset {
namespace {

using Mat3 = Eigen::Matrix3d;

/// Arrays of a column's own blocks: the upper triangle on the diagonal, then the nine one level up.
constexpr std::size_t kSelfArrays = 15;
constexpr std::array<std::size_t, 9> kUpper{0, 1, 2, 1, 3, 4, 2, 4, 5};

std::size_t at(int index) { return static_cast<std::size_t>(index); }

/// y[k] += B[k] x[k], and t[k] += B[k]' s[k].
struct Product {
  std::array<const double*, 9> block;
  std::array<const double*, 3> x;
  std::array<double*, 3> y;
  std::array<const double*, 3> s;
  std::array<double*, 3> t;
};

__attribute__((target_clones("avx512f", "avx2", "default"))) void multiply_both(
    const Product& p, std::size_t count) {
  for (std::size_t r = 0; r < 3; ++r) {
    const double* b0 = p.block[3 * r];
    const double* b1 = p.block[3 * r + 1];
    const double* b2 = p.block[3 * r + 2];
    double* y = p.y[r];
    const double* s = p.s[r];
#pragma GCC ivdep
    for (std::size_t k = 0; k < count; ++k) {
      y[k] += b0[k] * p.x[0][k] + b1[k] * p.x[1][k] + b2[k] * p.x[2][k];
    }
    for (std::size_t c = 0; c < 3; ++c) {
      double* t = p.t[c];
      const double* b = p.block[3 * r + c];
#pragma GCC ivdep
      for (std::size_t k = 0; k < count; ++k) t[k] += b[k] * s[k];
    }
  }
}

__attribute__((target_clones("avx512f", "avx2", "default"))) void multiply_symmetric(
    const Product& p, std::size_t count) {
  for (std::size_t r = 0; r < 3; ++r) {
    const double* b0 = p.block[3 * r];
    const double* b1 = p.block[3 * r + 1];
    const double* b2 = p.block[3 * r + 2];
    double* y = p.y[r];
#pragma GCC ivdep
    for (std::size_t k = 0; k < count; ++k) {
      y[k] += b0[k] * p.x[0][k] + b1[k] * p.x[1][k] + b2[k] * p.x[2][k];
    }
  }
}

std::array<const double*, 3> columns_of(const ColumnVector& v, std::size_t column, int shift) {
  return {v.at(column, 0) + shift, v.at(column, 1) + shift, v.at(column, 2) + shift};
}
std::array<double*, 3> columns_of(ColumnVector& v, std::size_t column, int shift) {
  return {v.at(column, 0) + shift, v.at(column, 1) + shift, v.at(column, 2) + shift};
}

}  // namespace

ColumnSystem::ColumnSystem(const Window& window, std::size_t levels)
    : free_(window.free), levels_(levels), stride_((levels + 2 + 7) / 8 * 8) {
  std::map<std::pair<int, int>, bool> found;  // to whether they share an edge
  for (const ColumnFace& face : window.faces) {
    for (std::size_t a = 0; a < face.count; ++a) {
      for (std::size_t b = a + 1; b < face.count; ++b) {
        const auto [low, high] = std::minmax(face.column[a], face.column[b]);
        if (at(high) >= free_) continue;
        const bool edge = b == a + 1 || (a == 0 && b + 1 == face.count);
        found[{low, high}] = found[{low, high}] || edge;
      }
    }
  }
  first_.assign(free_ + 1, 0);
  std::size_t start = 0;
  for (std::size_t c = 0; c < free_; ++c, start += kSelfArrays * stride_) self_.push_back(start);
  for (const auto& [ends, edge] : found) {
    pairs_.push_back({ends.first, ends.second, edge, start});
    start += (edge ? 27U : 9U) * stride_;
    ++first_[at(ends.first) + 1];
  }
  for (std::size_t c = 0; c < free_; ++c) first_[c + 1] += first_[c];
  store_.assign(start + 1, 0.0);
  inverse_.resize(free_ * levels_);
}

void ColumnSystem::clear() { std::fill(store_.begin(), store_.end(), 0.0); }

const ColumnSystem::Pair* ColumnSystem::find(int low, int high) const {
  for (std::size_t p = first_[at(low)]; p < first_[at(low) + 1]; ++p) {
    if (pairs_[p].high == high) return &pairs_[p];
  }
  return nullptr;
}

BlockRun ColumnSystem::blocks(int row, int column, std::size_t level, int shift) {
  BlockRun run;
  if (at(row) >= free_ || at(column) >= free_) return run;
  if (row == column) {
    const std::size_t start = self_[at(row)];
    for (std::size_t e = 0; e < 9; ++e) {
      run.entry[e] = array(start, shift == 0 ? kUpper[e] : 6 + e) + level;
    }
    return run;
  }
  const bool turned = row > column;
  const Pair& pair = *find(std::min(row, column), std::max(row, column));
  // Opposite corners have one set of arrays, the others three: a level down, the same, one up.
  const int stored_shift = turned ? -shift : shift;
  const std::size_t part = pair.share_edge ? at(stored_shift + 1) : 0;
  double* const base = array(pair.start, part * 9) + level;
  const auto stride = static_cast<std::ptrdiff_t>(stride_);
  for (std::ptrdiff_t r = 0; r < 3; ++r) {
    for (std::ptrdiff_t c = 0; c < 3; ++c) {
      run.entry[static_cast<std::size_t>(3 * r + c)] =
          turned ? base + (3 * c + r) * stride + shift : base + (3 * r + c) * stride;
    }
  }
  return run;
}

void ColumnSystem::add_diagonal(std::size_t column, std::size_t level, const Mat3& block) {
  for (std::size_t r = 0; r < 3; ++r) {
    for (std::size_t c = r; c < 3; ++c) {
      array(self_[column], kUpper[3 * r + c])[level] +=
          block(static_cast<Eigen::Index>(r), static_cast<Eigen::Index>(c));
    }
  }
}

void ColumnSystem::multiply(const ColumnVector& x, ColumnVector& y) const {
  std::fill(y.values().begin(), y.values().end(), 0.0);
  for (std::size_t i = 0; i < free_; ++i) {
    Product p{};
    for (std::size_t e = 0; e < 9; ++e) p.block[e] = array(self_[i], kUpper[e]);
    p.x = columns_of(x, i, 0);
    p.y = columns_of(y, i, 0);
    multiply_symmetric(p, levels_);
    for (std::size_t e = 0; e < 9; ++e) p.block[e] = array(self_[i], 6 + e);
    p.x = columns_of(x, i, 1);
    p.s = columns_of(x, i, 0);
    p.t = columns_of(y, i, 1);
    multiply_both(p, levels_ - 1);
    for (std::size_t n = first_[i]; n < first_[i + 1]; ++n) {
      const Pair& pair = pairs_[n];
      for (int shift = pair.share_edge ? -1 : 0; shift <= (pair.share_edge ? 1 : 0); ++shift) {
        const std::size_t part = pair.share_edge ? at(shift + 1) : 0;
        for (std::size_t e = 0; e < 9; ++e) p.block[e] = array(pair.start, part * 9 + e);
        p.x = columns_of(x, at(pair.high), shift);
        p.s = columns_of(x, i, 0);
        p.t = columns_of(y, at(pair.high), shift);
        multiply_both(p, levels_);
      }
    }
    for (std::size_t a = 0; a < 3; ++a) {
      y.at(i, a)[0] = 0;
      y.at(i, a)[-1] = 0;
      y.at(i, a)[levels_] = 0;
    }
  }
}

void ColumnSystem::factor_columns() {
  for (std::size_t i = 0; i < free_; ++i) {
    Mat3 carried = Mat3::Zero();
    for (std::size_t k = 1; k < levels_; ++k) {
      Mat3 pivot;
      Mat3 up;
      for (std::size_t e = 0; e < 9; ++e) {
        const auto r = static_cast<Eigen::Index>(e / 3);
        const auto c = static_cast<Eigen::Index>(e % 3);
        pivot(r, c) = array(self_[i], kUpper[e])[k];
        up(r, c) = array(self_[i], 6 + e)[k];
      }
      const Mat3 inverse = (pivot - carried).inverse();
      inverse_[i * levels_ + k] = inverse;
      carried = up.transpose() * inverse * up;
    }
  }
}

void ColumnSystem::solve_columns(const ColumnVector& r, ColumnVector& z) const {
  for (std::size_t i = 0; i < free_; ++i) {
    const auto up = [&](std::size_t k) {
      Mat3 block;
      for (std::size_t e = 0; e < 9; ++e) {
        block(static_cast<Eigen::Index>(e / 3), static_cast<Eigen::Index>(e % 3)) =
            array(self_[i], 6 + e)[k];
      }
      return block;
    };
    Vec3 carried = Vec3::Zero();
    for (std::size_t k = 1; k < levels_; ++k) {
      const Vec3 solved = inverse_[i * levels_ + k] * (r.get(i, k) - carried);
      z.set(i, k, solved);
      if (k + 1 < levels_) carried = up(k).transpose() * solved;
    }
    for (std::size_t k = levels_ - 1; k-- > 1;) {
      const Vec3 above = z.get(i, k + 1);
      z.set(i, k, z.get(i, k) - inverse_[i * levels_ + k] * (up(k) * above));
    }
  }
}

}  // namespace vdb_offset
