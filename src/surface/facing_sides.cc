#include "surface/facing_sides.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <numeric>
#include <utility>

#include "surface/triangle.h"

namespace vdb_offset {

namespace {

/// Of a quad along either diagonal, so that warped ones have no side that is nearer.
constexpr std::array<std::array<std::size_t, 3>, 4> kHalves{
    {{0, 1, 2}, {0, 2, 3}, {0, 1, 3}, {1, 2, 3}}};

}  // namespace

FacingSides::FacingSides(std::vector<Cell> cells, const Vec3List& points_world, Oriented oriented)
    : points_world_(points_world),
      cells_(std::move(cells)),
      oriented_(oriented),
      first_(points_world.size() + 1, 0) {
  const auto for_corners = [&](const auto& visit) {
    for (std::size_t n = 0; n < cells_.size(); ++n) {
      for (const int corner : cells_[n]) visit(static_cast<std::size_t>(corner), n);
    }
  };
  for_corners([&](std::size_t point, std::size_t) { ++first_[point + 1]; });
  std::partial_sum(first_.begin(), first_.end(), first_.begin());
  std::vector<std::size_t> next(first_.begin(), first_.end() - 1);
  at_.resize(first_.back());
  for_corners([&](std::size_t point, std::size_t cell) { at_[next[point]++] = cell; });
}

std::span<const std::size_t> FacingSides::cells_at(int point) const {
  const auto p = static_cast<std::size_t>(point);
  return {at_.data() + first_[p], first_[p + 1] - first_[p]};
}

/// Of the cells at a point.
FacingSides::Place FacingSides::nearest_at(int point, const Vec3& to_world) const {
  Place nearest{position(point), Vec3::Zero()};
  for (const std::size_t n : cells_at(point)) {
    const Cell& cell = cells_[n];
    const std::size_t halves = cell[2] == cell[3] ? 1 : kHalves.size();
    for (std::size_t h = 0; h < halves; ++h) {
      const std::array<std::size_t, 3>& corners = kHalves[h];
      const Vec3& a = position(cell[corners[0]]);
      const TriangleGeometry half{a, position(cell[corners[1]]) - a,
                                  position(cell[corners[2]]) - a};
      const Vec3 found = closest_on_triangle(half, to_world).point_world;
      if ((found - to_world).squaredNorm() >= (nearest.point_world - to_world).squaredNorm())
        continue;
      nearest = {found, half.ab.cross(half.ac)};
    }
  }
  return nearest;
}

bool FacingSides::lies_over(int point, int other) const {
  constexpr double kFarther = 1.5;  // half a cell from a rim; so twice as far behind the cell
  constexpr double kAlong = 0.75;   // as far as the cell's middle: beside each other it is half
  const double most = kFarther * (position(point) - position(other)).norm();
  return std::ranges::any_of(cells_at(point), [&](std::size_t n) {
    const Cell& cell = cells_[n];
    Vec3 middle = Vec3::Zero();
    for (const int corner : cell) middle += 0.25 * position(corner);
    const Vec3 out = middle - position(point);
    const Place nearest = nearest_at(other, middle);
    const Vec3 normal =
        (position(cell[2]) - position(cell[0])).cross(position(cell[3]) - position(cell[1]));
    return (nearest.point_world - middle).norm() <= most &&
           (nearest.point_world - position(other)).dot(out) >= kAlong * out.squaredNorm() &&
           (oriented_ == Oriented::No || normal.dot(nearest.normal) < 0);
  });
}

bool FacingSides::face_each_other(int a, int b) const { return lies_over(a, b) || lies_over(b, a); }

}  // namespace vdb_offset
