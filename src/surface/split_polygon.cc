// Ears are clipped as in G. H. Meisters, Polygons have ears (1975). Cutting one off changes only
// its two neighbours: a triangle that holds any corner holds a concave one, and an ear's tip is
// none. So each corner is looked at first once, and then again only when a neighbour goes.

#include "surface/split_polygon.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cstddef>
#include <deque>

namespace vdb_offset {
namespace {

using Vec2 = Eigen::Vector2d;

const Vec3& at(const Vec3List& points, int index) {
  return points[static_cast<std::size_t>(index)];
}

/// Corners about the first of them, so that the farthest coordinate is 1: nothing overflows.
Vec3List to_unit(const Vec3List& points, std::span<const int> polygon) {
  Vec3List unit;
  double size = 0.0;
  for (const int index : polygon) {
    unit.push_back(at(points, index) - at(points, polygon[0]));
    size = std::max(size, unit.back().cwiseAbs().maxCoeff());
  }
  for (Vec3& p : unit) p /= size > 0 ? size : 1.0;
  return unit;
}

/// Twice the area, along the normal.
Vec3 vector_area(const Vec3List& corners) {
  Vec3 area = Vec3::Zero();
  for (std::size_t n = 1; n + 1 < corners.size(); ++n) area += corners[n].cross(corners[n + 1]);
  return area;
}

double cross(const Vec2& a, const Vec2& b) { return a.x() * b.y() - a.y() * b.x(); }

/// In the plane that they lie in most; nothing moves out of proportion.
std::vector<Vec2> flattened(const Vec3List& corners) {
  constexpr double kLittle = 0.1;
  const std::size_t count = corners.size();
  Vec3 sharpest = Vec3::Zero();
  for (std::size_t n = 0; n < count; ++n) {
    const Vec3& p = corners[(n + 1) % count];
    const Vec3 here = (p - corners[n]).cross(corners[(n + 2) % count] - p);
    if (here.squaredNorm() > sharpest.squaredNorm()) sharpest = here;
  }
  const Vec3 area = vector_area(corners);
  const Vec3 normal = area.norm() > kLittle * sharpest.norm() ? area : sharpest;
  std::vector<Vec2> flat(count, Vec2::Zero());
  if (!(normal.norm() > 0)) return flat;
  const Vec3 u = normal.unitOrthogonal();
  const Vec3 v = normal.normalized().cross(u);
  for (std::size_t n = 0; n < count; ++n) flat[n] = {corners[n].dot(u), corners[n].dot(v)};
  return flat;
}

class EarClipper {
 public:
  EarClipper(const Vec3List& corners, const Vec3& normal, std::span<const int> polygon);
  /// Corners of triangles; false if some remain that have no ear.
  bool clip(std::vector<std::array<std::size_t, 3>>& triangles);

 private:
  double turn(std::size_t n) const {
    return cross(flat_[n] - flat_[before_[n]], flat_[after_[n]] - flat_[n]);
  }
  bool is_ear(std::size_t n) const;
  void cut(std::size_t n);

  std::span<const int> polygon_;
  std::vector<Vec2> flat_;
  std::vector<std::size_t> before_;
  std::vector<std::size_t> after_;
  std::vector<std::size_t> concave_;  // corners that are or were
  std::vector<bool> gone_;
};

EarClipper::EarClipper(const Vec3List& corners, const Vec3& normal, std::span<const int> polygon)
    : polygon_(polygon), gone_(corners.size(), false) {
  const Vec3 u = normal.unitOrthogonal();
  const Vec3 v = normal.cross(u);
  const std::size_t count = corners.size();
  for (std::size_t n = 0; n < count; ++n) {
    flat_.emplace_back(corners[n].dot(u), corners[n].dot(v));
    before_.push_back((n + count - 1) % count);
    after_.push_back((n + 1) % count);
  }
  for (std::size_t n = 0; n < count; ++n) {
    if (turn(n) <= 0) concave_.push_back(n);
  }
}

/// Corners at the same point as one of the triangle's, as a slit to a hole has, are not in it.
bool EarClipper::is_ear(std::size_t n) const {
  if (!(turn(n) > 0)) return false;
  const std::array<std::size_t, 3> ear{before_[n], n, after_[n]};
  return std::none_of(concave_.begin(), concave_.end(), [&](std::size_t c) {
    if (gone_[c]) return false;
    for (const std::size_t e : ear) {
      if (polygon_[c] == polygon_[e]) return false;
    }
    for (std::size_t side = 0; side < 3; ++side) {
      const Vec2& from = flat_[ear[side]];
      if (cross(flat_[ear[(side + 1) % 3]] - from, flat_[c] - from) < 0) return false;
    }
    return true;
  });
}

void EarClipper::cut(std::size_t n) {
  gone_[n] = true;
  after_[before_[n]] = after_[n];
  before_[after_[n]] = before_[n];
}

bool EarClipper::clip(std::vector<std::array<std::size_t, 3>>& triangles) {
  // First in, first out: cuts go round the polygon, and no corner collects all of them.
  std::deque<std::size_t> to_try;
  for (std::size_t n = 0; n < flat_.size(); ++n) to_try.push_back(n);
  std::size_t left = flat_.size();
  while (left > 3 && !to_try.empty()) {
    const std::size_t n = to_try.front();
    to_try.pop_front();
    if (gone_[n] || !is_ear(n)) continue;
    triangles.push_back({before_[n], n, after_[n]});
    cut(n);
    --left;
    to_try.push_back(before_[n]);
    to_try.push_back(after_[n]);
  }
  std::size_t first = 0;
  while (gone_[first]) ++first;
  for (std::size_t n = after_[first]; after_[n] != first; n = after_[n]) {
    triangles.push_back({first, n, after_[n]});
  }
  return left == 3 && turn(first) >= 0;
}

}  // namespace

bool is_concave_quad(const Vec3List& points, std::span<const int> quad) {
  constexpr double kStraight = 1e-9;  // sine of the least angle that counts as a bend
  if (quad[0] == quad[2] || quad[1] == quad[3]) return true;
  const Vec3List corners = to_unit(points, quad);
  const Vec3 normal = vector_area(corners).normalized();
  for (std::size_t n = 0; n < 4; ++n) {
    const Vec3 in = (corners[n] - corners[(n + 3) % 4]).normalized();
    const Vec3 out = (corners[(n + 1) % 4] - corners[n]).normalized();
    if (!(in.cross(out).dot(normal) > kStraight)) return true;
  }
  return false;
}

std::optional<std::size_t> crossed_edge(const Vec3List& points, std::span<const int> polygon) {
  const std::size_t count = polygon.size();
  if (count < 4 || count > kMostCrossed) return {};
  const Vec3List corners = to_unit(points, polygon);
  const std::vector<Vec2> flat = flattened(corners);
  constexpr double kTouch = 1e-9;
  const auto parted = [&](std::size_t edge, std::size_t other) {
    const Vec2& from = flat[edge];
    const Vec2 along = flat[(edge + 1) % count] - from;
    const double a = cross(along, flat[other] - from);
    const double b = cross(along, flat[(other + 1) % count] - from);
    return std::min(a, b) < -kTouch && std::max(a, b) > kTouch;
  };
  for (std::size_t edge = 0; edge + 2 < count; ++edge) {
    for (std::size_t other = edge + 2; other < count - (edge == 0 ? 1 : 0); ++other) {
      if (parted(edge, other) && parted(other, edge)) return edge;
    }
  }
  return {};
}

bool split_polygon(const Vec3List& points, std::span<const int> polygon,
                   std::vector<std::array<int, 3>>& triangles) {
  const Vec3List corners = to_unit(points, polygon);
  const Vec3 area = vector_area(corners);
  const double size = area.norm();
  // Without an area any plane will do: its pieces have none either.
  constexpr double kNoArea = 1e-14;
  const bool flat = size > kNoArea;
  std::vector<std::array<std::size_t, 3>> cut;
  EarClipper clipper(corners, flat ? Vec3(area / size) : Vec3(Vec3::UnitZ()), polygon);
  const bool whole = clipper.clip(cut);
  for (const auto& [a, b, c] : cut) triangles.push_back({polygon[a], polygon[b], polygon[c]});
  return whole && flat;
}

}  // namespace vdb_offset
