#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "core/large_vector.h"
#include "vdb_offset/core/vec.h"

namespace vdb_offset {

/// How far a nearest place of a triangle, as computed, may lie beside the exact one in the plane's
/// normal or outside the triangle, in parts of the largest coordinate.
inline constexpr double kCoordinateRounding = 2e-14;

/// A bounding-volume hierarchy over boxes: binned surface-area heuristic, depth-first nodes.
class BoxTree {
 public:
  /// `order` becomes the boxes' indices in leaf order: `visit` below gets positions in it.
  BoxTree(const LargeVector<Box>& boxes, LargeVector<int>& order);

  /// `visit(first, last, box)` for every leaf whose box is within `reach` of `box`, until it gives
  /// true.
  template <typename Visit>
  bool near_box(const Box& box, double reach, const Visit& visit) const {
    if (nodes_.empty()) return false;
    std::array<std::uint32_t, kMaxDepth> stack;
    int top = 0;
    stack[0] = 0;
    while (top >= 0) {
      const std::uint32_t at = stack[static_cast<std::size_t>(top--)];
      const Node& node = nodes_[at];
      if (box_distance2(node, box) > reach * reach) continue;
      if (node.count > 0) {
        if (visit(node.link, node.link + node.count, Box{node.lo, node.hi})) return true;
      } else {
        stack[static_cast<std::size_t>(++top)] = node.link;
        stack[static_cast<std::size_t>(++top)] = at + 1;
      }
    }
    return false;
  }

 protected:
  static constexpr std::size_t kMaxDepth = 128;
  static constexpr std::size_t kLeaf = 8;
  struct Node {
    Vec3 lo, hi;              // larger by the pad
    std::uint32_t link = 0;   // leaf: first position; inner: right child (left is the next node)
    std::uint32_t count = 0;  // leaf: number of primitives; inner: 0
  };

  double pad_ = 0;  // rounding of a nearest place, world
  LargeVector<Node> nodes_;

 private:
  void build(void* items, std::size_t first, std::size_t last, int depth);
  void find_boxes(const LargeVector<Box>& boxes, const LargeVector<int>& order);

  static double box_distance2(const Node& node, const Box& box) {
    return (node.lo - box.hi).cwiseMax(box.lo - node.hi).cwiseMax(0.0).squaredNorm();
  }
};

}  // namespace vdb_offset
