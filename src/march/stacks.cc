#include "march/stacks.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>

#include "core/hulls.h"

namespace vdb_offset {
namespace {

constexpr double kUpright = 0.05;  // sine

std::size_t at(int index) { return static_cast<std::size_t>(index); }

/// The first level at a part of the full height.
int level_at(const LayerSpacing& spacing, double part) {
  const auto& heights = spacing.heights_world;
  const auto found = std::ranges::lower_bound(heights, part * spacing.height_world);
  return std::min(static_cast<int>(found - heights.begin()), spacing.layers);
}

}  // namespace

Vec3 Shaft::at(double height) const {
  std::size_t k = 1;
  while (k + 1 < kPoints && height_world[k] < height) ++k;
  const double step = height_world[k] - height_world[k - 1];
  const double part = step > 0 ? std::clamp((height - height_world[k - 1]) / step, 0.0, 1.0) : 1.0;
  return point_world[k - 1] + part * (point_world[k] - point_world[k - 1]);
}

Stacks::Stacks(const Surface& surface, const Layers& layers, double stretch)
    : surface_(surface),
      layers_(layers),
      stretch_(stretch),
      levels_{level_at(layers.spacing, 1.0 / 3), level_at(layers.spacing, 2.0 / 3)} {
  faces_.reserve(at(surface.faces()));
  for (std::size_t p = 0; p < surface.patches.size(); ++p) {
    for_cells(surface.patches[p], [&](std::array<int, 4> corners) {
      WallFace face{{-1, -1, -1, -1}};
      std::size_t count = 0;
      for (const int corner : corners) {
        const int node = surface.patch_nodes[p][at(corner)];
        const auto end = face.node.begin() + static_cast<std::ptrdiff_t>(count);
        if (std::find(face.node.begin(), end, node) == end) face.node[count++] = node;
      }
      if (count == 3) face.node[3] = face.node[2];
      if (count >= 3) faces_.push_back(face);
    });
  }
}

/// Heights by how far points are from the foot: columns are nearly straight.
Shaft Stacks::shaft(int node) const {
  const Vec3& foot = layers_.at(node, 0);
  const Vec3& end = layers_.at(node, layers_.levels() - 1);
  const double height = layers_.height_world[at(node)];
  const double length = (end - foot).norm();
  Shaft shaft;
  shaft.height_world[0] = 0;
  shaft.point_world[0] = foot;
  for (const std::size_t n : {0U, 1U}) {
    const Vec3& between = layers_.at(node, levels_[n]);
    const double part = length > 0 ? (between - foot).norm() / length : 0;
    shaft.height_world[n + 1] = std::min(part, std::min(stretch_, 1.0)) * height;
    shaft.point_world[n + 1] = between;
  }
  const Vec3& before = layers_.at(node, std::min(levels_[1], layers_.levels() - 2));
  const Vec3 way = end - before;
  const double beyond = way.norm() > 0 ? (stretch_ - 1) * length / way.norm() : 0;
  shaft.height_world[3] = stretch_ * height;
  shaft.point_world[3] = end + std::max(beyond, -1.0) * way;
  return shaft;
}

/// One number for all nodes at one place, of both sides too.
std::size_t Stacks::place(int node) const {
  const std::size_t stands = surface_.stands_at(at(node));
  return surface_.wall_nodes > 0 ? stands % at(surface_.wall_nodes) : stands;
}

double Stacks::top(const WallFace& face) const {
  double most = 0;
  for (const int node : face.node) most = std::max(most, layers_.height_world[at(node)]);
  return stretch_ * most;
}

double Stacks::width(const WallFace& face) const {
  const auto across = [&](std::size_t a, std::size_t b) {
    Vec3 way = surface_.nodes_world[at(face.node[b])] - surface_.nodes_world[at(face.node[a])];
    if (surface_.flat) way.z() = 0;
    return way.norm();
  };
  return 0.5 * std::max({across(0, 2), across(1, 3), across(0, 1), across(2, 3)});
}

Vec3 Stacks::direction(const WallFace& face) const {
  Vec3 sum = Vec3::Zero();
  for (const int node : face.node) {
    const Vec3 way = layers_.at(node, layers_.levels() - 1) - layers_.at(node, 0);
    if (way.squaredNorm() > 0) sum += way.normalized();
  }
  return sum.squaredNorm() > 0 ? Vec3(sum.normalized()) : Vec3(Vec3::Zero());
}

StackPoints Stacks::points(const WallFace& face, double height_world) const {
  StackPoints points;
  for (std::size_t c = 0; c < face.count(); ++c) {
    const Shaft column = shaft(face.node[c]);
    const double top = std::min(height_world, column.top());
    for (std::size_t k = 0; k + 1 < Shaft::kPoints; ++k) {
      if (k == 0 || column.height_world[k] < top) points.add(column.point_world[k]);
    }
    points.add(column.at(top));
  }
  return points;
}

StackPoints Stacks::feet(const WallFace& face) const {
  StackPoints points;
  for (std::size_t c = 0; c < face.count(); ++c) points.add(layers_.at(face.node[c], 0));
  return points;
}

Box Stacks::box(const WallFace& face, double from_part) const {
  Box box;
  for (std::size_t c = 0; c < face.count(); ++c) {
    const Shaft column = shaft(face.node[c]);
    const double from = from_part * column.top();
    box.add(column.at(from));
    for (std::size_t k = 1; k < Shaft::kPoints; ++k) {
      if (column.height_world[k] > from) box.add(column.point_world[k]);
    }
  }
  return box;
}

bool Stacks::are_joined(const WallFace& a, const WallFace& b) const {
  return std::ranges::any_of(a.node, [&](int one) {
    return std::ranges::any_of(b.node, [&](int other) { return place(one) == place(other); });
  });
}

bool Stacks::is_upright(const WallFace& face) const {
  const Vec3 way = direction(face);
  const std::size_t count = face.count();
  const auto end = [&](std::size_t c) {
    return layers_.at(face.node[c % count], layers_.levels() - 1);
  };
  for (std::size_t c = 0; c < count; ++c) {
    const Vec3 ahead = end(c + 1) - end(c);
    const Vec3 back = end(c + count - 1) - end(c);
    const double sine = ahead.cross(back).dot(way);
    if (!(sine > kUpright * ahead.norm() * back.norm())) return false;
  }
  return true;
}

bool Stacks::are_apart(const FacePair& pair, double height_world) const {
  return vdb_offset::are_apart(points(pair.first, height_world).span(),
                               points(pair.second, height_world).span());
}

}  // namespace vdb_offset
