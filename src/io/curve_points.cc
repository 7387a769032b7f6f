#include "io/curve_points.h"

namespace vdb_offset {

double size_of(const Vec3List& points) {
  Box box;
  for (const Vec3& p : points) box.add(p);
  return box.size();
}

double enclosed_area(const Vec3List& loop) {
  double twice = 0.0;
  for (std::size_t n = 0; n < loop.size(); ++n) {
    // About the first point: far from the origin, nothing cancels.
    const Vec3 a = loop[n] - loop.front();
    const Vec3 b = loop[(n + 1) % loop.size()] - loop.front();
    twice += a.x() * b.y() - a.y() * b.x();
  }
  return 0.5 * twice;
}

void drop_repeats(Vec3List& points, double size) {
  const double tolerance = 1e-9 * size;
  Vec3List kept;
  kept.reserve(points.size());
  for (const Vec3& p : points) {
    if (kept.empty() || (p - kept.back()).norm() > tolerance) {
      kept.push_back(p);
    } else if (&p == &points.back() && kept.size() > 1) {
      kept.back() = p;
    }
  }
  points = std::move(kept);
}

}  // namespace vdb_offset
