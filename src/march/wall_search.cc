#include "march/wall_search.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace vdb_offset {

void WallSearch::begin(std::span<const int> own) {
  own_.assign(own.begin(), own.end());
  last_ = own_.empty() ? -1 : own_.front();
}

WallPoint WallSearch::nearest(const Vec3& point_world) {
  if (boundaries_ == nullptr) return nearest_in_domain(point_world);
  const Folded folded = boundaries_->fold(point_world);
  WallPoint found = nearest_in_domain(folded.point_world());
  if (!folded.moved()) return found;
  found.point_world = folded.unfold(found.point_world);
  found.normal = folded.unfold_direction(found.normal);
  return found;
}

WallPoint WallSearch::nearest_in_domain(const Vec3& point_world) {
  const WallPoint found = wall_.closest_from(last_, point_world);
  last_ = found.triangle;
  return found;
}

WallPoint WallSearch::nearest_own(const Vec3& point_world) const {
  double best2 = std::numeric_limits<double>::infinity();
  int best = -1;
  for (const int triangle : own_) {
    const double d2 = wall_.distance2(triangle, point_world);
    if (d2 < best2) {
      best2 = d2;
      best = triangle;
    }
  }
  return best < 0 ? WallPoint{} : wall_.closest_on(best, point_world);
}

double WallSearch::distance_own(const Vec3& point_world) const {
  double best2 = std::numeric_limits<double>::infinity();
  for (const int triangle : own_) best2 = std::min(best2, wall_.distance2(triangle, point_world));
  return std::sqrt(best2);
}

bool WallSearch::is_clear(const Vec3& point_world, double distance_world) const {
  const Vec3 point =
      boundaries_ == nullptr ? point_world : boundaries_->fold(point_world).point_world();
  return wall_.closest_place(point, distance_world).triangle < 0;
}

}  // namespace vdb_offset
