#include "core/box_tree.h"

#include <algorithm>
#include <bit>
#include <numeric>
#include <utility>

namespace vdb_offset {

BoxTree::BoxTree(std::vector<Box> boxes) : boxes_(std::move(boxes)), order_(boxes_.size()) {
  std::iota(order_.begin(), order_.end(), 0U);
  around_.resize(4 * std::bit_ceil(std::max<std::size_t>(1, order_.size() / kLeaf)) + 1);
  if (!order_.empty()) build({0, static_cast<std::uint32_t>(order_.size())}, 1);
}

void BoxTree::build(Range range, std::size_t node) {
  Box middles;
  for (std::uint32_t n = range.first; n < range.last; ++n) {
    const Box& box = boxes_[order_[n]];
    around_[node].add(box);
    middles.add(box.lo + box.hi);
  }
  if (range.last - range.first <= kLeaf) return;
  Eigen::Index axis = 0;
  (middles.hi - middles.lo).maxCoeff(&axis);
  const auto key = [&](std::uint32_t n) {
    return std::pair(boxes_[n].lo[axis] + boxes_[n].hi[axis], n);
  };
  const auto at = [&](std::uint32_t n) { return order_.begin() + n; };
  std::nth_element(at(range.first), at(middle(range)), at(range.last),
                   [&](std::uint32_t a, std::uint32_t b) { return key(a) < key(b); });
  build({range.first, middle(range)}, 2 * node);
  build({middle(range), range.last}, 2 * node + 1);
}

}  // namespace vdb_offset
