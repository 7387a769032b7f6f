// The columns' own blocks are solved exactly, as thin cells couple levels far more strongly than
// neighbours; block elimination of a tridiagonal matrix (Golub, Van Loan, Matrix Computations).

#include "blocks/column_system.h"

#include <Eigen/LU>
#include <algorithm>
#include <map>
#include <tuple>
#include <utility>

#include "core/clones.h"
#include "core/parallel.h"

namespace vdb_offset {

using Mat3 = Eigen::Matrix3d;

namespace {

/// Arrays of a column's own blocks: the upper triangle on the diagonal, then the nine one level up.
constexpr std::size_t kSelfArrays = 15;
constexpr std::size_t kGrain = 32;  // columns
constexpr std::size_t kRun = 128;   // pairs

std::size_t at(int index) { return static_cast<std::size_t>(index); }

/// y[k] += B[k] x[k], and t[k] += B[k]' s[k].
struct Product {
  std::array<const double*, 9> block;
  std::array<const double*, 3> x;
  std::array<double*, 3> y;
  std::array<const double*, 3> s;
  std::array<double*, 3> t;
};

/// Where y and t are of different columns: each block is read once.
VDB_OFFSET_CLONES void multiply_both(const Product& p, std::size_t count) {
  const auto [b0, b1, b2, b3, b4, b5, b6, b7, b8] = p.block;
  const auto [x0, x1, x2] = p.x;
  const auto [s0, s1, s2] = p.s;
  const auto [y0, y1, y2] = p.y;
  const auto [t0, t1, t2] = p.t;
#pragma GCC ivdep
  for (std::size_t k = 0; k < count; ++k) {
    y0[k] += b0[k] * x0[k] + b1[k] * x1[k] + b2[k] * x2[k];
    y1[k] += b3[k] * x0[k] + b4[k] * x1[k] + b5[k] * x2[k];
    y2[k] += b6[k] * x0[k] + b7[k] * x1[k] + b8[k] * x2[k];
    t0[k] += b0[k] * s0[k] + b3[k] * s1[k] + b6[k] * s2[k];
    t1[k] += b1[k] * s0[k] + b4[k] * s1[k] + b7[k] * s2[k];
    t2[k] += b2[k] * s0[k] + b5[k] * s1[k] + b8[k] * s2[k];
  }
}

/// t[k] += B[k]' s[k]
VDB_OFFSET_CLONES void multiply_transposed(const Product& p, std::size_t count) {
  for (std::size_t c = 0; c < 3; ++c) {
    const double* b0 = p.block[c];
    const double* b1 = p.block[3 + c];
    const double* b2 = p.block[6 + c];
    double* t = p.t[c];
#pragma GCC ivdep
    for (std::size_t k = 0; k < count; ++k) {
      t[k] += b0[k] * p.s[0][k] + b1[k] * p.s[1][k] + b2[k] * p.s[2][k];
    }
  }
}

/// y[k] += B[k] x[k]
VDB_OFFSET_CLONES void multiply_plain(const Product& p, std::size_t count) {
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

ColumnSystem::ColumnSystem(const Window& window, std::size_t levels,
                           const std::function<bool(std::size_t)>& in_tetrahedra)
    : free_(window.free), levels_(levels), stride_((levels + 2 + 7) / 8 * 8) {
  std::map<std::pair<int, int>, std::pair<int, int>> found;  // to the least and most levels above
  const auto couple = [&](int from, int to, int least, int most) {
    if (at(from) >= free_ || at(to) >= free_) return;
    auto& levels_above = found[std::minmax({from, to})];
    if (from > to) std::tie(least, most) = std::pair(-most, -least);
    levels_above.first = std::min(levels_above.first, least);
    levels_above.second = std::max(levels_above.second, most);
  };
  for (std::size_t f = 0; f < window.faces.size(); ++f) {
    const ColumnFace& face = window.faces[f];
    for (std::size_t c = 0; c < face.count; ++c) couple(face.column[c], face.next(c), -1, 1);
    if (face.count < 4) continue;
    couple(face.column[0], face.column[2], 0, in_tetrahedra(f) ? 1 : 0);
    couple(face.column[1], face.column[3], 0, 0);
  }
  first_.assign(free_ + 1, 0);
  std::size_t start = 0;
  for (std::size_t c = 0; c < free_; ++c, start += kSelfArrays * stride_) self_.push_back(start);
  for (const auto& [ends, above] : found) {
    pairs_.push_back({ends.first, ends.second, above.first, above.second, start});
    start += 9 * at(above.second - above.first + 1) * stride_;
    ++first_[at(ends.first) + 1];
  }
  for (std::size_t c = 0; c < free_; ++c) first_[c + 1] += first_[c];
  runs_ = ColouredRuns(pairs_.size(), kRun, free_, [&](std::size_t p, const auto& visit) {
    visit(at(pairs_[p].low));
    visit(at(pairs_[p].high));
  });
  store_.assign(start + 1, 0.0);
  factors_.resize(free_ * levels_);
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
  double* const base = array(pair.start, 9 * at((turned ? -shift : shift) - pair.least)) + level;
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

void ColumnSystem::hold(std::size_t column, std::size_t levels) {
  for (std::size_t a = 0; a < kSelfArrays; ++a) std::fill_n(array(self_[column], a), levels, 0.0);
  for (const std::size_t diagonal : {kUpper[0], kUpper[4], kUpper[8]}) {
    std::fill_n(array(self_[column], diagonal), levels, 1.0);
  }
}

void ColumnSystem::multiply_self(const ColumnVector& x, ColumnVector& y, std::size_t i) const {
  Product p{};
  for (std::size_t a = 0; a < 3; ++a) std::fill_n(y.at(i, a) - 1, levels_ + 2, 0.0);
  for (std::size_t e = 0; e < 9; ++e) p.block[e] = array(self_[i], kUpper[e]);
  p.x = columns_of(x, i, 0);
  p.y = columns_of(y, i, 0);
  multiply_plain(p, levels_);
  for (std::size_t e = 0; e < 9; ++e) p.block[e] = array(self_[i], 6 + e);
  p.x = columns_of(x, i, 1);
  p.s = columns_of(x, i, 0);
  p.t = columns_of(y, i, 1);
  multiply_plain(p, levels_ - 1);
  multiply_transposed(p, levels_ - 1);
}

void ColumnSystem::multiply_pair(const ColumnVector& x, ColumnVector& y, const Pair& pair) const {
  Product p{};
  for (int shift = pair.least; shift <= pair.most; ++shift) {
    const std::size_t part = 9 * at(shift - pair.least);
    for (std::size_t e = 0; e < 9; ++e) p.block[e] = array(pair.start, part + e);
    p.x = columns_of(x, at(pair.high), shift);
    p.y = columns_of(y, at(pair.low), 0);
    p.s = columns_of(x, at(pair.low), 0);
    p.t = columns_of(y, at(pair.high), shift);
    multiply_both(p, levels_);
  }
}

void ColumnSystem::multiply(const ColumnVector& x, ColumnVector& y) const {
  parallel::for_ranges(free_, kGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) multiply_self(x, y, i);
  });
  runs_.for_each([&](std::size_t begin, std::size_t end) {
    for (std::size_t p = begin; p < end; ++p) multiply_pair(x, y, pairs_[p]);
  });
  for (std::size_t i = 0; i < free_; ++i) {
    for (std::size_t a = 0; a < 3; ++a) {
      double* const values = y.at(i, a);
      values[-1] = values[0] = values[levels_] = 0;
    }
  }
}

void ColumnSystem::factor_column(std::size_t i) {
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
    Factor& factor = factors_[i * levels_ + k];
    factor.inverse = (pivot - carried).inverse();
    factor.above = factor.inverse * up;
    carried = up.transpose() * factor.above;
  }
}

void ColumnSystem::factor_columns() {
  parallel::for_ranges(free_, kGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) factor_column(i);
  });
}

void ColumnSystem::solve_column(const ColumnVector& r, ColumnVector& z, std::size_t i) const {
  const Factor* const factor = factors_.data() + i * levels_;
  Vec3 carried = Vec3::Zero();
  for (std::size_t k = 1; k < levels_; ++k) {
    const Vec3 left = r.get(i, k) - carried;
    z.set(i, k, factor[k].inverse * left);
    carried = factor[k].above.transpose() * left;
  }
  Vec3 above = Vec3::Zero();
  for (std::size_t k = levels_; k-- > 1;) {
    above = z.get(i, k) - factor[k].above * above;
    z.set(i, k, above);
  }
}

void ColumnSystem::solve_columns(const ColumnVector& r, ColumnVector& z) const {
  parallel::for_ranges(free_, kGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) solve_column(r, z, i);
  });
}

}  // namespace vdb_offset
