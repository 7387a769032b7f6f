#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <span>

#include "core/large_vector.h"
#include "vdb_offset/core/vec.h"
#include "vdb_offset/surface/wall.h"

namespace vdb_offset {

/// How far a nearest place of a triangle, as computed, may lie beside the exact one in the plane's
/// normal or outside the triangle, in parts of the largest coordinate.
inline constexpr double kCoordinateRounding = 2e-14;

/// A bounding-volume hierarchy over boxes: binned surface-area heuristic, depth-first nodes.
class Bvh {
 public:
  /// `order` becomes the primitives' indices in leaf order: `visit` below gets positions in it.
  Bvh(const LargeVector<Box>& boxes, LargeVector<int>& order);

  /// Encloses the triangles, given in leaf order, of all but the large nodes in boxes along the
  /// wall too: off a smooth wall a box along the axes reaches far towards the query.
  void add_tilted(std::span<const TriangleGeometry> triangles);

  std::size_t bytes() const {
    return nodes_.capacity() * sizeof(Node) + tilted_.capacity() * sizeof(Tilted);
  }

  /// Nearest-first descent. `visit(first, last, best2)` looks at the primitives at positions
  /// [first, last) and lowers `best2`, the squared distance beyond which nothing matters.
  /// Boxes allow for rounding: no primitive is missed whose own squared distance, as computed,
  /// is the least, so that the least does not depend on where the search begins.
  template <typename Visit>
  void nearest(const Vec3& query, double& best2, const Visit& visit) const {
    std::array<Entry, kMaxDepth> stack;
    int top = 0;
    stack[0] = {0, distance2(nodes_[0], query)};
    while (top >= 0) {
      const Entry entry = stack[static_cast<std::size_t>(top--)];
      if (entry.distance2 > kRounding * best2) continue;
      std::uint32_t at = entry.node;
      while (nodes_[at].count == 0) {
        Entry near{at + 1, bound2(at + 1, query, best2)};
        Entry far{nodes_[at].link, bound2(nodes_[at].link, query, best2)};
        if (far.distance2 < near.distance2) std::swap(near, far);
        if (far.distance2 <= kRounding * best2) stack[static_cast<std::size_t>(++top)] = far;
        at = near.node;
        if (near.distance2 > kRounding * best2) break;
      }
      if (nodes_[at].count > 0) visit(nodes_[at].link, nodes_[at].link + nodes_[at].count, best2);
    }
  }

  /// `visit(first, last, box)` for every leaf whose box is within `reach` of `box`, until it gives
  /// true.
  template <typename Visit>
  bool near_box(const Box& box, double reach, const Visit& visit) const {
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

 private:
  static constexpr std::size_t kMaxDepth = 128;
  static constexpr double kRounding = 1 + 4e-15;
  struct Node {
    Vec3 lo, hi;
    std::uint32_t link = 0;   // leaf: first position; inner: right child (left is the next node)
    std::uint32_t count = 0;  // leaf: number of primitives; inner: 0
  };
  /// A box along axes of its own: unit, orthogonal, the last one the wall's normal.
  struct Tilted {
    Vec3 centre = Vec3::Zero();
    std::array<Vec3, 3> axes{Vec3::Zero(), Vec3::Zero(), Vec3::Zero()};
    Vec3 half = Vec3::Constant(std::numeric_limits<double>::infinity());
  };
  struct Part;
  struct Entry {
    std::uint32_t node;
    double distance2;
  };

  void build(void* items, std::size_t first, std::size_t last, int depth);
  Tilted tilted_around(std::span<const TriangleGeometry> triangles, const Part& part) const;
  void find_boxes(const LargeVector<Box>& boxes, const LargeVector<int>& order);

  static double distance2(const Node& node, const Vec3& p) {
    return (node.lo - p).cwiseMax(p - node.hi).cwiseMax(0.0).squaredNorm();
  }
  static double distance2(const Tilted& box, const Vec3& p) {
    constexpr double kBlur = 1e-14;  // of |q|^2: roundings
    const Vec3 q = p - box.centre;
    const Vec3 along(std::abs(box.axes[0].dot(q)), std::abs(box.axes[1].dot(q)),
                     std::abs(box.axes[2].dot(q)));
    return (along - box.half).cwiseMax(0.0).squaredNorm() - kBlur * q.squaredNorm();
  }
  /// Not above the squared distance to a node's primitives; near it only where that matters.
  double bound2(std::uint32_t at, const Vec3& p, double best2) const {
    const double d2 = distance2(nodes_[at], p);
    if (d2 > kRounding * best2 || at >= tilted_.size()) return d2;
    return std::max(d2, distance2(tilted_[at], p));
  }
  static double box_distance2(const Node& node, const Box& box) {
    return (node.lo - box.hi).cwiseMax(box.lo - node.hi).cwiseMax(0.0).squaredNorm();
  }

  double pad_ = 0;  // rounding of a nearest place, world
  LargeVector<Node> nodes_;
  LargeVector<Tilted> tilted_;  // of each node, infinite for large ones
};

}  // namespace vdb_offset
