#pragma once

#include <array>
#include <cstddef>
#include <functional>
#include <vector>

#include "blocks/colouring.h"
#include "blocks/window.h"
#include "vdb_offset/core/vec.h"

namespace vdb_offset {

/// Where the entries of a symmetric 3 x 3 block, row by row, stand among its upper triangle's six.
inline constexpr std::array<std::size_t, 9> kUpper{0, 1, 2, 1, 3, 4, 2, 4, 5};

/// A vector for each level of each column: for each column and axis the levels side by side, with
/// a zero before level 0 and behind the last.
class ColumnVector {
 public:
  ColumnVector() = default;
  ColumnVector(std::size_t columns, std::size_t levels)
      : levels_(levels),
        stride_((levels + 2 + 7) / 8 * 8),
        values_(columns * 3 * stride_ + 1, 0.0) {}

  std::size_t levels() const { return levels_; }
  double* at(std::size_t column, std::size_t axis) {
    return values_.data() + (column * 3 + axis) * stride_ + 1;
  }
  const double* at(std::size_t column, std::size_t axis) const {
    return values_.data() + (column * 3 + axis) * stride_ + 1;
  }
  Vec3 get(std::size_t column, std::size_t level) const {
    return {at(column, 0)[level], at(column, 1)[level], at(column, 2)[level]};
  }
  void set(std::size_t column, std::size_t level, const Vec3& value) {
    for (std::size_t a = 0; a < 3; ++a) at(column, a)[level] = value[static_cast<Eigen::Index>(a)];
  }
  std::vector<double>& values() { return values_; }
  const std::vector<double>& values() const { return values_; }

 private:
  std::size_t levels_ = 0;
  std::size_t stride_ = 0;
  std::vector<double> values_;
};

/// Where the nine entries (row by row) of a run of 3 x 3 blocks lie, one behind the other by level.
struct BlockRun {
  std::array<double*, 9> entry{};
  explicit operator bool() const { return entry[0] != nullptr; }
};

/// The symmetric matrix of a window: 3 x 3 blocks between each free column, its neighbours and
/// itself, at the same level and one up and down. Level 0 does not move.
class ColumnSystem {
 public:
  /// Edges of faces couple at the same level and one up and down, opposite corners at the same one
  /// alone; corner 0 of the faces that are `in_tetrahedra(face)` with corner 2 one level up as
  /// well.
  ColumnSystem(const Window& window, std::size_t levels,
               const std::function<bool(std::size_t)>& in_tetrahedra);

  void clear();
  /// Blocks that couple `row` at level `level` + n with `column` at the level `shift` (-1, 0, 1)
  /// above, n = 0, 1, ...; none if one of them does not move. Between columns each pair is stored
  /// once: write either (row, column) or (column, row), not both. Of a column with itself write
  /// shift 0 (six entries of the upper triangle) and 1.
  BlockRun blocks(int row, int column, std::size_t level, int shift);

  /// What couples the same place of a column with itself: symmetric, all nine entries read.
  void add_diagonal(std::size_t column, std::size_t level, const Eigen::Matrix3d& block);

  /// Takes the lowest `levels` of a column out of its factors: they do not move.
  void hold(std::size_t column, std::size_t levels);

  void multiply(const ColumnVector& x, ColumnVector& y) const;

  /// Exact factors of each column by itself, all others held.
  void factor_columns();
  /// z = (columns alone)^-1 r.
  void solve_columns(const ColumnVector& r, ColumnVector& z) const;

 private:
  struct Pair {
    int low = 0;
    int high = 0;
    int least = 0;  ///< level of `high` above that of `low`
    int most = 0;
    std::size_t start = 0;  ///< nine arrays for each of them
  };
  struct Factor {
    Eigen::Matrix3d inverse;  ///< of the pivot
    Eigen::Matrix3d above;    ///< its product with the block one level up
  };
  void factor_column(std::size_t column);
  void solve_column(const ColumnVector& r, ColumnVector& z, std::size_t column) const;
  void multiply_self(const ColumnVector& x, ColumnVector& y, std::size_t column) const;
  void multiply_pair(const ColumnVector& x, ColumnVector& y, const Pair& pair) const;

  double* array(std::size_t start, std::size_t index) {
    return store_.data() + start + index * stride_ + 1;
  }
  const double* array(std::size_t start, std::size_t index) const {
    return store_.data() + start + index * stride_ + 1;
  }
  const Pair* find(int low, int high) const;

  std::size_t free_ = 0;
  std::size_t levels_ = 0;
  std::size_t stride_ = 0;
  std::vector<Pair> pairs_;         // by low, then high
  std::vector<std::size_t> first_;  // of each low, and the end
  ColouredRuns runs_;               // of pairs
  std::vector<std::size_t> self_;   // start of each column's own blocks: 6 + 9 arrays
  std::vector<double> store_;
  std::vector<Factor> factors_;  // column by column
};

}  // namespace vdb_offset
