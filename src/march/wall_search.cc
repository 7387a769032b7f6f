#include "march/wall_search.h"

#include <cmath>
#include <limits>

namespace vdb_offset {

void WallSearch::begin(std::span<const int> own) {
  own_.assign(own.begin(), own.end());
  last_ = own_.empty() ? -1 : own_.front();
}

WallPoint WallSearch::nearest(const Vec3& point_world) {
  WallPoint found;
  if (last_ >= 0) {
    // The bound is a distance to the wall, so what is nearest lies within it, rounding apart.
    const double bound = std::sqrt(wall_.distance2(last_, point_world));
    found = wall_.closest(point_world, bound * (1 + 1e-12));
  }
  if (found.triangle < 0) found = wall_.closest(point_world);
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

}  // namespace vdb_offset
