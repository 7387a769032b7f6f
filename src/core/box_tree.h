#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "vdb_offset/core/vec.h"

namespace vdb_offset {

/// Boxes, halved again and again at their middles, to find those that meet another.
class BoxTree {
 public:
  /// Keeps the boxes; cost n log n.
  explicit BoxTree(std::vector<Box> boxes);

  /// `visit(index)` for all boxes that meet `box`, touching ones too, in an order that depends on
  /// the boxes alone.
  template <typename Visit>
  void meeting(const Box& box, const Visit& visit) const {
    if (!order_.empty()) descend({0, static_cast<std::uint32_t>(order_.size())}, 1, box, visit);
  }

 private:
  struct Range {
    std::uint32_t first, last;
  };
  static constexpr std::uint32_t kLeaf = 4;

  static bool meet(const Box& a, const Box& b) {
    return (a.lo.array() <= b.hi.array()).all() && (b.lo.array() <= a.hi.array()).all();
  }
  static std::uint32_t middle(Range range) { return range.first + (range.last - range.first) / 2; }
  void build(Range range, std::size_t node);

  template <typename Visit>
  void descend(Range range, std::size_t node, const Box& box, const Visit& visit) const {
    if (!meet(around_[node], box)) return;
    if (range.last - range.first <= kLeaf) {
      for (std::uint32_t n = range.first; n < range.last; ++n) {
        if (meet(boxes_[order_[n]], box)) visit(static_cast<std::size_t>(order_[n]));
      }
      return;
    }
    descend({range.first, middle(range)}, 2 * node, box, visit);
    descend({middle(range), range.last}, 2 * node + 1, box, visit);
  }

  std::vector<Box> boxes_;
  std::vector<std::uint32_t> order_;
  std::vector<Box> around_;  // of each node; the halves of n are 2 n and 2 n + 1
};

}  // namespace vdb_offset
