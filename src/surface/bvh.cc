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
  /// Primitives [first, last) of the order, the box around them and that around their centres.
  struct Range {
    std::size_t first, last;
    Box box, centres;
  };
  struct Bin {
    Box box, centres;
    std::size_t count = 0;

    void add(const Bin& other) {
      box.add(other.box);
      centres.add(other.centres);
      count += other.count;
    }
  };
  using Bins = std::array<Bin, kBins>;

  const std::vector<Box>& boxes;
  Bvh& bvh;

  Vec3 centre(std::size_t position) const {
    const Box& box = boxes[static_cast<std::size_t>(bvh.order_[position])];
    return 0.5 * (box.lo + box.hi);
  }
  Range measured(std::size_t first, std::size_t last) const;
  void build(const Range& range, int depth);
  std::array<Range, 2> split(const Range& range, int depth);
  std::array<Range, 2> split_at_median(const Range& range, int axis);
  static std::size_t best_plane(const Bins& bins);
};

Bvh::Builder::Range Bvh::Builder::measured(std::size_t first, std::size_t last) const {
  Range range{first, last, {}, {}};
  for (std::size_t p = first; p < last; ++p) {
    range.box.add(boxes[static_cast<std::size_t>(bvh.order_[p])]);
    range.centres.add(centre(p));
  }
  return range;
}

/// The first bin of the right part, by the surface areas of both.
std::size_t Bvh::Builder::best_plane(const Bins& bins) {
  std::array<double, kBins> right{};
  Box box;
  std::size_t count = 0;
  for (std::size_t b = kBins - 1; b > 0; --b) {
    box.add(bins[b].box);
    count += bins[b].count;
    right[b] = half_area(box) * static_cast<double>(count);
  }
  box = Box();
  count = 0;
  std::size_t best = 1;
  double best_cost = 1e300;
  for (std::size_t b = 1; b < kBins; ++b) {
    box.add(bins[b - 1].box);
    count += bins[b - 1].count;
    const double cost = half_area(box) * static_cast<double>(count) + right[b];
    if (cost < best_cost) {
      best_cost = cost;
      best = b;
    }
  }
  return best;
}

std::array<Bvh::Builder::Range, 2> Bvh::Builder::split_at_median(const Range& range, int axis) {
  const auto begin = bvh.order_.begin();
  const std::size_t middle = range.first + (range.last - range.first) / 2;
  const auto twice = [&](int item) {
    const Box& box = boxes[static_cast<std::size_t>(item)];
    return box.lo[axis] + box.hi[axis];
  };
  std::nth_element(begin + static_cast<std::ptrdiff_t>(range.first),
                   begin + static_cast<std::ptrdiff_t>(middle),
                   begin + static_cast<std::ptrdiff_t>(range.last), [&](int a, int b) {
                     return twice(a) < twice(b) || (twice(a) == twice(b) && a < b);
                   });
  return {measured(range.first, middle), measured(middle, range.last)};
}

std::array<Bvh::Builder::Range, 2> Bvh::Builder::split(const Range& range, int depth) {
  Eigen::Index widest = 0;
  const Vec3 extent = range.centres.hi - range.centres.lo;
  extent.maxCoeff(&widest);
  const int axis = static_cast<int>(widest);
  if (depth >= kMedianDepth || !(extent[axis] > 0)) return split_at_median(range, axis);
  const double factor = kBins * (1 - 1e-9) / extent[axis];
  const double lo = range.centres.lo[axis];
  const auto bin_of = [&](int item) {
    const Box& box = boxes[static_cast<std::size_t>(item)];
    return static_cast<std::size_t>((0.5 * (box.lo[axis] + box.hi[axis]) - lo) * factor);
  };
  Bins bins;
  for (std::size_t p = range.first; p < range.last; ++p) {
    Bin& bin = bins[bin_of(bvh.order_[p])];
    bin.box.add(boxes[static_cast<std::size_t>(bvh.order_[p])]);
    bin.centres.add(centre(p));
    ++bin.count;
  }
  const std::size_t plane = best_plane(bins);
  Bin left;
  Bin right;
  for (std::size_t b = 0; b < kBins; ++b) (b < plane ? left : right).add(bins[b]);
  if (left.count == 0 || right.count == 0) return split_at_median(range, axis);
  const auto begin = bvh.order_.begin();
  std::partition(begin + static_cast<std::ptrdiff_t>(range.first),
                 begin + static_cast<std::ptrdiff_t>(range.last),
                 [&](int item) { return bin_of(item) < plane; });
  const std::size_t middle = range.first + left.count;
  return {Range{range.first, middle, left.box, left.centres},
          Range{middle, range.last, right.box, right.centres}};
}

void Bvh::Builder::build(const Range& range, int depth) {
  const std::size_t at = bvh.nodes_.size();
  bvh.nodes_.push_back({range.box.lo, range.box.hi, static_cast<std::uint32_t>(range.first),
                        static_cast<std::uint32_t>(range.last - range.first)});
  if (range.last - range.first <= kLeaf) return;
  const std::array<Range, 2> parts = split(range, depth);
  build(parts[0], depth + 1);
  bvh.nodes_[at].link = static_cast<std::uint32_t>(bvh.nodes_.size());
  bvh.nodes_[at].count = 0;
  build(parts[1], depth + 1);
}

Bvh::Bvh(const std::vector<Box>& boxes) : order_(boxes.size()) {
  std::iota(order_.begin(), order_.end(), 0);
  Builder builder{boxes, *this};
  nodes_.reserve(boxes.size());
  builder.build(builder.measured(0, boxes.size()), 0);
}

}  // namespace vdb_offset
