#include "vdb_offset/surface/winding.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "surface/solid_angle.h"

namespace vdb_offset {
namespace {

constexpr std::uint32_t kLeaf = 8;
constexpr double kFourPi = 4 * std::numbers::pi;

Vec3 middle(const TriangleGeometry& t) { return t.a + (t.ab + t.ac) / 3; }
Vec3 area(const TriangleGeometry& t) { return 0.5 * t.ab.cross(t.ac); }

}  // namespace

Winding::Winding(const Wall& wall) : triangles_(wall.geometry().begin(), wall.geometry().end()) {
  nodes_.reserve(triangles_.size() / 2);
  build(triangles_, 0, static_cast<std::uint32_t>(triangles_.size()));
}

/// A wall's triangles stand in space order already: halves of a run are near each other.
std::uint32_t Winding::build(std::span<const TriangleGeometry> triangles, std::uint32_t first,
                             std::uint32_t last) {
  const auto index = static_cast<std::uint32_t>(nodes_.size());
  Node node;
  node.first = first;
  node.last = last;
  double whole = 0;
  Vec3 plain = Vec3::Zero();
  for (const TriangleGeometry& t : triangles.subspan(first, last - first)) {
    const double size = area(t).norm();
    node.area += area(t);
    node.centre += size * middle(t);
    plain += middle(t);
    whole += size;
  }
  node.centre = whole > 0 ? Vec3(node.centre / whole) : Vec3(plain / std::max(1U, last - first));
  for (const TriangleGeometry& t : triangles.subspan(first, last - first)) {
    for (const Vec3& corner : {t.a, Vec3(t.a + t.ab), Vec3(t.a + t.ac)}) {
      node.radius = std::max(node.radius, (corner - node.centre).norm());
    }
  }
  nodes_.push_back(node);
  if (last - first > kLeaf) {
    const std::uint32_t half = first + (last - first) / 2;
    build(triangles, first, half);
    nodes_[index].right = build(triangles, half, last);
  }
  return index;
}

double Winding::solid_angle_of(std::uint32_t group, const Vec3& query) const {
  std::array<std::uint32_t, 64> stack;  // halves: 2^32 triangles make 32 levels
  std::size_t top = 0;
  stack[top++] = group;
  double sum = 0;
  while (top > 0) {
    const std::uint32_t at = stack[--top];
    const Node& node = nodes_[at];
    const Vec3 to = node.centre - query;
    const double distance = to.norm();
    if (distance > kFarGroup * node.radius) {
      sum += node.area.dot(to) / (distance * distance * distance);
    } else if (node.right != 0) {
      stack[top++] = at + 1;
      stack[top++] = node.right;
    } else {
      for (std::uint32_t t = node.first; t < node.last; ++t) {
        sum += solid_angle(triangles_[t], query);
      }
    }
  }
  return sum;
}

double Winding::number(const Vec3& query) const { return solid_angle_of(0, query) / kFourPi; }

bool Winding::is_inside(const Vec3& query) const { return std::abs(number(query)) > 0.5; }

}  // namespace vdb_offset
