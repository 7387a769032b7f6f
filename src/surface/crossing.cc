// Woop, Benthin, Wald, Watertight ray/triangle intersection, 2013: seen along the segment an edge
// has the same two corners for both of its triangles, and the order of two rounded products is
// that of the exact ones, or they are equal, which counts as inside for both.

#include "surface/crossing.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <utility>
#include <vector>

namespace vdb_offset {

namespace {

/// Corners as seen along a segment.
class View {
 public:
  explicit View(const Segment& segment) : eye_(segment.from) {
    const Vec3 way = segment.to - segment.from;
    way.cwiseAbs().maxCoeff(&along_);
    slope_ = {way[(along_ + 1) % 3] / way[along_], way[(along_ + 2) % 3] / way[along_]};
  }

  struct Place {
    double x, y;
  };
  Place of(const Vec3& point) const {
    const Vec3 off = point - eye_;
    return {off[(along_ + 1) % 3] - slope_[0] * off[along_],
            off[(along_ + 2) % 3] - slope_[1] * off[along_]};
  }

 private:
  Vec3 eye_;
  Eigen::Index along_ = 0;
  std::array<double, 2> slope_{};
};

/// On which side of the line through two places the eye is: products are compared, not subtracted.
int turn(const View::Place& a, const View::Place& b) {
  const double one = a.x * b.y;
  const double other = a.y * b.x;
  return (one > other ? 1 : 0) - (one < other ? 1 : 0);
}

/// A wall, and what of it a segment may go through.
struct Test {
  const Wall& wall;
  const Segment& segment;
  EndsCount ends;
  View view;
  double on_wall, on_rim;

  bool is_seen(const Wall::Triangle& triangle) const;
  std::optional<double> crossing(int triangle) const;
};

bool Test::is_seen(const Wall::Triangle& triangle) const {
  std::array<View::Place, 3> place{};
  for (std::size_t c = 0; c < 3; ++c) {
    place[c] = view.of(wall.vertices()[static_cast<std::size_t>(triangle[c])]);
  }
  const std::array<int, 3> turns{turn(place[0], place[1]), turn(place[1], place[2]),
                                 turn(place[2], place[0])};
  const auto [least, most] = std::minmax_element(turns.begin(), turns.end());
  return *least * *most >= 0 && *least + *most != 0;
}

std::optional<double> Test::crossing(int index) const {
  const TriangleGeometry& g = wall.geometry()[static_cast<std::size_t>(index)];
  const Vec3 normal = g.ab.cross(g.ac).normalized();
  const double before = normal.dot(segment.from - g.a);
  const double after = normal.dot(segment.to - g.a);
  if (!(std::abs(before - after) > 0)) return {};
  const double nearer = std::min(std::abs(before), std::abs(after));
  const bool is_through = (before < 0) != (after < 0) && nearer > on_wall;
  if (!is_through && (ends == EndsCount::No || nearer > on_wall)) return {};
  const double part = std::clamp(before / (before - after), 0.0, 1.0);
  const Vec3 place = segment.from + part * (segment.to - segment.from);
  if (is_through && is_seen(wall.triangles()[static_cast<std::size_t>(index)])) return part;
  if (wall.distance2(index, place) > on_rim * on_rim) return {};
  const WallPoint nearest = wall.closest_on(index, place);
  const bool is_on = nearest.distance_world <= (nearest.on_free_edge ? on_rim : on_wall);
  return is_on ? std::optional(part) : std::nullopt;
}

/// Whether a segment comes near a box.
bool meets(const Segment& segment, const Box& box, double reach) {
  double first = 0;
  double last = 1;
  for (Eigen::Index axis = 0; axis < 3; ++axis) {
    const double way = segment.to[axis] - segment.from[axis];
    const double lo = box.lo[axis] - reach - segment.from[axis];
    const double hi = box.hi[axis] + reach - segment.from[axis];
    if (way == 0) {
      if (lo > 0 || hi < 0) return false;
      continue;
    }
    first = std::max(first, std::min(lo / way, hi / way));
    last = std::min(last, std::max(lo / way, hi / way));
  }
  return first <= last * (1 + 1e-12) + 1e-12;
}

}  // namespace

double on_wall(const Wall& wall) {
  const Box& bounds = wall.bounds();
  const Vec3 farthest = bounds.lo.cwiseAbs().cwiseMax(bounds.hi.cwiseAbs());
  return kOnWall * (bounds.size() + farthest.maxCoeff());
}

std::optional<double> first_crossing(const Wall& wall, const Segment& segment, EndsCount ends) {
  if (!segment.from.allFinite() || !segment.to.allFinite() || segment.from == segment.to) return {};
  const double on_rim = kOnRim * wall.bounds().size();
  const Test test{wall, segment, ends, View(segment), on_wall(wall), on_rim};
  Box around;
  around.add(segment.from);
  around.add(segment.to);
  std::vector<TriangleRun> runs;
  wall.near_box(around, test.on_rim, runs);
  std::optional<double> first;
  for (const TriangleRun& run : runs) {
    if (!meets(segment, run.box, test.on_rim)) continue;
    for (std::uint32_t t = run.first; t < run.last; ++t) {
      const std::optional<double> part = test.crossing(static_cast<int>(t));
      if (part && (!first || *part < *first)) first = part;
    }
  }
  return first;
}

std::optional<double> crossing_of(const Wall& wall, const Segment& segment, int triangle) {
  const double on_rim = kOnRim * wall.bounds().size();
  return Test{wall, segment, EndsCount::No, View(segment), on_wall(wall), on_rim}.crossing(
      triangle);
}

}  // namespace vdb_offset
