#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <span>

#include "core/box_tree.h"
#include "core/large_vector.h"
#include "vdb_offset/core/vec.h"
#include "vdb_offset/surface/wall.h"

namespace vdb_offset {

/// Boxes to find the nearest of what they enclose in, triangles above all.
class Bvh : public BoxTree {
 public:
  using BoxTree::BoxTree;

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

 private:
  static constexpr double kRounding = 1 + 4e-15;
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

  Tilted tilted_around(std::span<const TriangleGeometry> triangles, const Part& part) const;

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

  LargeVector<Tilted> tilted_;  // of each node, infinite for large ones
};

}  // namespace vdb_offset
