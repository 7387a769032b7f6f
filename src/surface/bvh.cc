#include "surface/bvh.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <bit>
#include <vector>

namespace vdb_offset {

// Of their areas, that the sum of normals has to be for them to be one surface.
constexpr double kAgree = 0.5;

/// Of a node: its triangles' positions, the sum of their normals times twice their areas, that of
/// twice their areas alone, and the sum of e e^T over their edges, which is of use where the
/// normals agree and left out where they do not.
struct Bvh::Part {
  std::uint32_t first = 0, last = 0;
  Vec3 area = Vec3::Zero();
  double all_area = 0;
  Eigen::Matrix3d edges = Eigen::Matrix3d::Zero();
  bool agree = false;

  std::uint32_t count() const { return last - first; }
  void add(std::span<const TriangleGeometry> triangles);
  std::array<Vec3, 3> axes() const;
};

void Bvh::Part::add(std::span<const TriangleGeometry> triangles) {
  for (const TriangleGeometry& t : triangles) {
    const Vec3 own = t.ab.cross(t.ac);
    area += own;
    all_area += own.norm();
  }
  agree = area.norm() > kAgree * all_area;
  if (!agree) return;
  for (const TriangleGeometry& t : triangles) {
    for (const Vec3& edge : {t.ab, t.ac, Vec3(t.ac - t.ab)}) edges += edge * edge.transpose();
  }
}

/// The normal, and along the wall the way that the edges are longest: a few steps of the power
/// method, since any direction will do.
std::array<Vec3, 3> Bvh::Part::axes() const {
  const Vec3 normal = area.stableNormalized();
  const auto within = [&](const Vec3& v) { return Vec3(v - normal.dot(v) * normal); };
  Eigen::Index least = 0;
  normal.cwiseAbs().minCoeff(&least);
  Vec3 longest = within(Vec3::Unit(least)).normalized();
  longest = (longest + 0.5 * normal.cross(longest)).eval();
  for (int n = 0; n < 4; ++n) {
    const Vec3 next = within(edges * longest);
    if (next.squaredNorm() > 0) longest = next.stableNormalized();
  }
  longest = within(longest).normalized();
  return {longest, normal.cross(longest), normal};
}

/// The least box of the part's axes, larger by the pad.
Bvh::Tilted Bvh::tilted_around(std::span<const TriangleGeometry> triangles,
                               const Part& part) const {
  Tilted result;
  result.axes = part.axes();
  const Vec3 origin = triangles[part.first].a;
  Box box;
  for (std::uint32_t p = part.first; p < part.last; ++p) {
    const TriangleGeometry& t = triangles[p];
    const Vec3 q = t.a - origin;
    for (const Vec3& corner : {q, Vec3(q + t.ab), Vec3(q + t.ac)}) {
      box.add(
          Vec3(result.axes[0].dot(corner), result.axes[1].dot(corner), result.axes[2].dot(corner)));
    }
  }
  const Vec3 middle = 0.5 * (box.lo + box.hi);
  result.centre = origin;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    result.centre += middle[static_cast<Eigen::Index>(axis)] * result.axes[axis];
  }
  result.half = 0.5 * (box.hi - box.lo);
  result.half.array() += pad_ + 1e-14 * result.half.maxCoeff();
  return result;
}

namespace {

/// Leaves, and every other generation above them up to where no axes fit the wall.
bool gets_tilted(std::uint32_t triangles, std::size_t of_leaf) {
  return triangles <= of_leaf || (triangles <= 4096 && std::bit_width(triangles) % 2 == 0);
}

}  // namespace

void Bvh::add_tilted(std::span<const TriangleGeometry> triangles) {
  // From the last node on, an inner one's children are the last two that have no parent yet.
  std::vector<Part> parts;
  tilted_.resize(nodes_.size());
  for (std::size_t at = nodes_.size(); at-- > 0;) {
    const Node& node = nodes_[at];
    Part part;
    if (node.count > 0) {
      part.first = node.link;
      part.last = node.link + node.count;
      part.add(triangles.subspan(node.link, node.count));
    } else {
      const Part left = parts.back();
      parts.pop_back();
      const Part right = parts.back();
      parts.pop_back();
      part = {left.first,
              right.last,
              left.area + right.area,
              left.all_area + right.all_area,
              left.edges + right.edges,
              left.agree && right.agree};
      part.agree = part.agree && part.area.norm() > kAgree * part.all_area;
    }
    parts.push_back(part);
    tilted_[at] =
        gets_tilted(part.count(), kLeaf) && part.agree ? tilted_around(triangles, part) : Tilted{};
  }
}

}  // namespace vdb_offset
