// Morton, A computer oriented geodetic data base and a new technique in file sequencing, 1966.

#include "surface/space_order.h"

#include <cassert>

#include "core/parallel.h"

namespace vdb_offset {

namespace {

constexpr double kCells = 1024;  // along each axis

/// Two zero bits between any two bits of a 10-bit number.
std::uint64_t spread(std::uint64_t x) {
  x = (x | x << 16U) & 0x030000FFU;
  x = (x | x << 8U) & 0x0300F00FU;
  x = (x | x << 4U) & 0x030C30C3U;
  return (x | x << 2U) & 0x09249249U;
}

}  // namespace

std::vector<std::uint32_t> order_in_space(const Vec3List& points) {
  assert(points.size() <= UINT32_MAX);
  Box box;
  for (const Vec3& p : points) {
    if (p.allFinite()) box.add(p);
  }
  const double edge = box.empty() ? 0.0 : (box.hi - box.lo).maxCoeff();
  const double scale = edge > 0 ? kCells * (1 - 1e-9) / edge : 0.0;
  // Cell and index in one word: sorting words is all there is to do.
  std::vector<std::uint64_t> keys(points.size());
  parallel::for_ranges(points.size(), 16384, [&](std::size_t begin, std::size_t end) {
    for (std::size_t n = begin; n < end; ++n) {
      std::uint64_t cell = 0;
      for (Eigen::Index axis = 0; axis < 3; ++axis) {
        const double along = (points[n][axis] - box.lo[axis]) * scale;
        const bool inside = along >= 0 && along < kCells;  // not so for what is not finite
        cell = cell << 1U | spread(inside ? static_cast<std::uint64_t>(along) : 0);
      }
      keys[n] = cell << 32U | n;
    }
  });
  parallel::sort(keys.begin(), keys.end(), [](std::uint64_t a, std::uint64_t b) { return a < b; });
  std::vector<std::uint32_t> order(keys.size());
  for (std::size_t n = 0; n < keys.size(); ++n) order[n] = static_cast<std::uint32_t>(keys[n]);
  return order;
}

}  // namespace vdb_offset
