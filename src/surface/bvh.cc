// Wald, On fast construction of SAH-based bounding volume hierarchies, 2007.

#include "surface/bvh.h"

#include <algorithm>
#include <numeric>

namespace vdb_offset {

namespace {

constexpr int kBins = 16;
constexpr int kLeaf = 4;
// Below this depth splits fall back to the median, which bounds the depth by the number's bits.
constexpr int kMedianDepth = 64;

double half_area(const Box& box) {
  if (box.empty()) return 0;
  const Vec3 e = box.hi - box.lo;
  return e.x() * e.y() + e.y() * e.z() + e.z() * e.x();
}

}  // namespace

struct Bvh::Builder {
  const std::vector<Box>& boxes;
  std::vector<Vec3> centres;
  Bvh& bvh;

  void build(std::size_t first, std::size_t last, int depth);
  std::size_t split(std::size_t first, std::size_t last, int depth);
  int best_plane(std::size_t first, std::size_t last, const Box& centre_box, int axis) const;
};

int Bvh::Builder::best_plane(std::size_t first, std::size_t last, const Box& centre_box,
                             int axis) const {
  std::array<Box, kBins> bins;
  std::array<int, kBins> counts{};
  const double lo = centre_box.lo[axis];
  const double factor = kBins * (1 - 1e-9) / (centre_box.hi[axis] - lo);
  for (std::size_t p = first; p < last; ++p) {
    const auto item = static_cast<std::size_t>(bvh.order_[p]);
    const auto bin = static_cast<std::size_t>((centres[item][axis] - lo) * factor);
    bins[bin].add(boxes[item]);
    ++counts[bin];
  }
  std::array<double, kBins> right{};
  Box box;
  int count = 0;
  for (std::size_t b = kBins - 1; b > 0; --b) {
    box.add(bins[b]);
    count += counts[b];
    right[b] = half_area(box) * count;
  }
  box = Box();
  count = 0;
  int best = 1;
  double best_cost = 1e300;
  for (std::size_t b = 1; b < kBins; ++b) {
    box.add(bins[b - 1]);
    count += counts[b - 1];
    const double cost = half_area(box) * count + right[b];
    if (cost < best_cost) {
      best_cost = cost;
      best = static_cast<int>(b);
    }
  }
  return best;
}

std::size_t Bvh::Builder::split(std::size_t first, std::size_t last, int depth) {
  Box centre_box;
  for (std::size_t p = first; p < last; ++p) {
    centre_box.add(centres[static_cast<std::size_t>(bvh.order_[p])]);
  }
  Eigen::Index widest = 0;
  const Vec3 extent = centre_box.hi - centre_box.lo;
  extent.maxCoeff(&widest);
  const int axis = static_cast<int>(widest);
  const auto begin = bvh.order_.begin();
  const std::size_t middle = first + (last - first) / 2;
  if (depth < kMedianDepth && extent[axis] > 0) {
    const int plane = best_plane(first, last, centre_box, axis);
    const double factor = kBins * (1 - 1e-9) / extent[axis];
    const auto it = std::partition(
        begin + static_cast<std::ptrdiff_t>(first), begin + static_cast<std::ptrdiff_t>(last),
        [&](int item) {
          const double c = centres[static_cast<std::size_t>(item)][axis] - centre_box.lo[axis];
          return static_cast<int>(c * factor) < plane;
        });
    const auto at = static_cast<std::size_t>(it - begin);
    if (at > first && at < last) return at;
  }
  std::nth_element(begin + static_cast<std::ptrdiff_t>(first),
                   begin + static_cast<std::ptrdiff_t>(middle),
                   begin + static_cast<std::ptrdiff_t>(last), [&](int a, int b) {
                     const double ca = centres[static_cast<std::size_t>(a)][axis];
                     const double cb = centres[static_cast<std::size_t>(b)][axis];
                     return ca < cb || (ca == cb && a < b);
                   });
  return middle;
}

void Bvh::Builder::build(std::size_t first, std::size_t last, int depth) {
  const std::size_t at = bvh.nodes_.size();
  bvh.nodes_.emplace_back();
  Box box;
  for (std::size_t p = first; p < last; ++p) {
    box.add(boxes[static_cast<std::size_t>(bvh.order_[p])]);
  }
  bvh.nodes_[at].lo = box.lo;
  bvh.nodes_[at].hi = box.hi;
  if (last - first <= kLeaf) {
    bvh.nodes_[at].link = static_cast<std::uint32_t>(first);
    bvh.nodes_[at].count = static_cast<std::uint32_t>(last - first);
    return;
  }
  const std::size_t middle = split(first, last, depth);
  build(first, middle, depth + 1);
  bvh.nodes_[at].link = static_cast<std::uint32_t>(bvh.nodes_.size());
  build(middle, last, depth + 1);
}

Bvh::Bvh(const std::vector<Box>& boxes) : order_(boxes.size()) {
  std::iota(order_.begin(), order_.end(), 0);
  Builder builder{boxes, {}, *this};
  builder.centres.reserve(boxes.size());
  for (const Box& box : boxes) builder.centres.push_back(0.5 * (box.lo + box.hi));
  nodes_.reserve(boxes.size());
  builder.build(0, boxes.size(), 0);
}

}  // namespace vdb_offset
