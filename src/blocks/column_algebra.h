#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

#include "blocks/column_system.h"
#include "core/parallel.h"

namespace vdb_offset {

/// Scalar product, in pieces whose sums are added in their order.
inline double dot(const ColumnVector& a, const ColumnVector& b) {
  constexpr std::size_t kPiece = 4096;
  const std::vector<double>& x = a.values();
  const std::vector<double>& y = b.values();
  std::vector<double> sums((x.size() + kPiece - 1) / kPiece, 0.0);
  parallel::for_ranges(sums.size(), 8, [&](std::size_t begin, std::size_t end) {
    for (std::size_t p = begin; p < end; ++p) {
      const std::size_t stop = std::min(x.size(), (p + 1) * kPiece);
      for (std::size_t n = p * kPiece; n < stop; ++n) sums[p] += x[n] * y[n];
    }
  });
  double sum = 0;
  for (const double part : sums) sum += part;
  return sum;
}

/// body(index of a value) for all values of a vector, in parallel.
template <typename Body>
void for_values(ColumnVector& y, const Body& body) {
  parallel::for_ranges(y.values().size(), 65536, [&](std::size_t begin, std::size_t end) {
    for (std::size_t n = begin; n < end; ++n) body(n);
  });
}
/// y += factor x
inline void add_scaled(ColumnVector& y, double factor, const ColumnVector& x) {
  for_values(y, [&](std::size_t n) { y.values()[n] += factor * x.values()[n]; });
}

}  // namespace vdb_offset
