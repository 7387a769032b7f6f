// A tree's far field about the centre of a cube, as in L. Greengard, V. Rokhlin, A fast algorithm
// for particle simulations, 1987, to first order and with a bound on what is left out.
//
// The field of a dipole a at y is a . grad(1/|y|). About a point at the distance D it is a series
// in r / D, whose term k is at most (k + 1) |a| r^k / D^(k+2): the gradient of a solid harmonic is
// greatest on its axis. What follows the linear term is at most
//
//   |a| / D^2 sum_{k>=2} (k + 1) (r/D)^k = |a| / D^2 (3 - 2 r/D) (r/D)^2 / (1 - r/D)^2.
//
// A triangle is dipoles all over: its area stands for |a|, D is the distance to it, and since it
// lies in a plane, the integral of |y|^-4 over it is at most pi / D^2.

#include "surface/winding_cube.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "surface/solid_angle.h"
#include "surface/triangle.h"

namespace vdb_offset {
namespace {

constexpr double kAway = 6;  // radii of a cube from which its near things are far
constexpr double kHalf = 2 * std::numbers::pi;
/// The errors of dipoles, here and in Winding::number: less from the half is told by that alone.
constexpr double kDipoles = 2 * kWindingError * 4 * std::numbers::pi;

double left_out(double strength, double distance, double radius) {
  const double ratio = radius / distance;
  const double rest = ratio / (1 - ratio);
  return strength * (3 - 2 * ratio) * rest * rest;
}

}  // namespace

Winding::CubeMask WindingCube::run() {
  lists_[0].push_back({0, true});
  judge({0, 0, 0, kWindingCube}, 0, {});
  return inside_;
}

WindingCube::Ball WindingCube::ball(const Part& part) const {
  const double half = 0.5 * (part.edge - 1);
  return {spacing_ * (first_ + Vec3(part.x + half, part.y + half, part.z + half)),
          std::numbers::sqrt3 * half * spacing_};
}

void WindingCube::sort(const Ball& ball, const List& from, List& near, Far& far) {
  near.clear();
  for (const Near& one : from) {
    if (one.is_group) {
      sort_group(ball, one.index, near, far);
    } else {
      sort_triangle(ball, one.index, near, far);
    }
  }
}

/// Groups that are larger than the cube, or far from it but too wide for a dipole, are opened.
void WindingCube::sort_group(const Ball& ball, std::uint32_t group, List& near, Far& far) {
  stack_.assign(1, group);
  while (!stack_.empty()) {
    const std::uint32_t at = stack_.back();
    stack_.pop_back();
    const Winding::Node& node = winding_.nodes_[at];
    const Vec3 to = node.centre - ball.centre;
    const double distance = to.norm();
    const bool is_away = distance - node.radius > kAway * ball.radius;
    if (is_away && distance - ball.radius > Winding::kFarGroup * node.radius) {
      const double inverse = 1 / distance;
      const double inverse3 = inverse * inverse * inverse;
      const double along = node.area.dot(to) * inverse3;
      far.value += along;
      far.gradient += 3 * along * inverse * inverse * to - inverse3 * node.area;
      far.slack += left_out(node.area.norm() * inverse * inverse, distance, ball.radius);
    } else if (!is_away && node.radius <= ball.radius) {
      near.push_back({at, true});
    } else if (node.right != 0) {
      stack_.push_back(at + 1);
      stack_.push_back(node.right);
    } else {
      for (std::uint32_t t = node.first; t < node.last; ++t) sort_triangle(ball, t, near, far);
    }
  }
}

void WindingCube::sort_triangle(const Ball& ball, std::uint32_t triangle, List& near,
                                Far& far) const {
  const TriangleGeometry& t = winding_.triangles_[triangle];
  const double distance = (closest_on_triangle(t, ball.centre).point_world - ball.centre).norm();
  if (distance <= kAway * ball.radius) {
    near.push_back({triangle, false});
    return;
  }
  far.value += solid_angle(t, ball.centre);
  far.gradient += solid_angle_gradient(t, ball.centre);
  const double area = 0.5 * t.ab.cross(t.ac).norm();
  far.slack +=
      left_out(std::min(area / (distance * distance), std::numbers::pi), distance, ball.radius);
}

/// `far`: about the part's centre already.
void WindingCube::judge(const Part& part, std::size_t level, Far far) {
  const Ball around = ball(part);
  List& near = lists_[level + 1];
  sort(around, lists_[level], near, far);
  if (near.empty()) {
    const double most = far.gradient.norm() * around.radius + far.slack + kDipoles;
    const double size = std::abs(far.value);
    if (std::abs(size - kHalf) > most) {
      if (size > kHalf) set_inside(part);
      return;
    }
  }
  const int half = part.edge / 2;
  if (half == 1) return judge_points(part, around, near, far);
  for (int n = 0; n < 8; ++n) {
    const Part child{part.x + half * (n / 4), part.y + half * (n / 2 % 2), part.z + half * (n % 2),
                     half};
    Far moved = far;
    moved.value += far.gradient.dot(ball(child).centre - around.centre);
    judge(child, level + 1, moved);
  }
}

void WindingCube::judge_points(const Part& part, const Ball& around, const List& near,
                               const Far& far) {
  for (int n = 0; n < 8; ++n) {
    const Part point{part.x + n / 4, part.y + n / 2 % 2, part.z + n % 2, 1};
    const Vec3 p = ball(point).centre;
    double sum = far.value + far.gradient.dot(p - around.centre);
    for (const Near& one : near) {
      sum += one.is_group ? winding_.solid_angle_of(one.index, p)
                          : solid_angle(winding_.triangles_[one.index], p);
    }
    const bool is_told = std::abs(std::abs(sum) - kHalf) > far.slack + kDipoles;
    if (is_told ? std::abs(sum) > kHalf : winding_.is_inside(p)) set_inside(point);
  }
}

void WindingCube::set_inside(const Part& part) {
  for (int x = part.x; x < part.x + part.edge; ++x) {
    for (int y = part.y; y < part.y + part.edge; ++y) {
      const std::uint64_t row = ((std::uint64_t{1} << static_cast<unsigned>(part.edge)) - 1)
                                << static_cast<unsigned>(8 * y + part.z);
      inside_[static_cast<std::size_t>(x)] |= row;
    }
  }
}

Winding::CubeMask Winding::inside_of_cube(const std::array<int, 3>& first,
                                          double spacing_world) const {
  return WindingCube(*this, first, spacing_world).run();
}

}  // namespace vdb_offset
