// Gilbert, Johnson, Keerthi, A fast procedure for computing the distance between complex objects in
// three-dimensional space, 1988: the point nearest to 0 of the convex hull of all differences, by
// simplices of at most four of them. Nearest places of triangles are found as in Ericson, Real-time
// collision detection, 2005.

#include "core/hulls.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>

namespace vdb_offset {
namespace {

constexpr std::size_t kMostSteps = 64;
constexpr double kExact = 1e-9;  // of a distance
constexpr double kMeet = 1e-10;  // of the sets' size: nearer hulls meet
constexpr double kFlat = 1e-10;  // of a tetrahedron's edges' product: its volume

/// A difference, and where it is from.
struct Corner {
  Vec3 at, first, second;
};

/// A place in a simplex: its corners' parts.
struct Simplex {
  std::array<const Corner*, 4> corner{};
  std::array<double, 4> part{};
  std::size_t count = 0;

  Vec3 place() const {
    Vec3 sum = Vec3::Zero();
    for (std::size_t c = 0; c < count; ++c) sum += part[c] * corner[c]->at;
    return sum;
  }
  void add(const Corner& with, double of) {
    corner[count] = &with;
    part[count++] = of;
  }
};

Simplex nearest_of(const Corner& a, const Corner& b) {
  const Vec3 edge = b.at - a.at;
  const double along = edge.squaredNorm() > 0 ? -a.at.dot(edge) / edge.squaredNorm() : 0;
  Simplex found;
  if (along < 1) found.add(a, 1 - std::max(along, 0.0));
  if (along > 0) found.add(b, std::min(along, 1.0));
  return found;
}

Simplex nearer(const Simplex& a, const Simplex& b) {
  return b.place().squaredNorm() < a.place().squaredNorm() ? b : a;
}

Simplex nearest_of(const Corner& a, const Corner& b, const Corner& c) {
  const Vec3 normal = (b.at - a.at).cross(c.at - a.at);
  const double area2 = normal.squaredNorm();
  if (area2 > 0) {
    const double of_a = b.at.cross(c.at).dot(normal) / area2;
    const double of_b = c.at.cross(a.at).dot(normal) / area2;
    const double of_c = 1 - of_a - of_b;
    if (of_a > 0 && of_b > 0 && of_c > 0) {
      Simplex found;
      found.add(a, of_a);
      found.add(b, of_b);
      found.add(c, of_c);
      return found;
    }
  }
  return nearer(nearer(nearest_of(a, b), nearest_of(b, c)), nearest_of(c, a));
}

/// Four corners are left where 0 lies within them.
Simplex nearest_of(const Simplex& four) {
  const Corner& a = *four.corner[0];
  const Corner& b = *four.corner[1];
  const Corner& c = *four.corner[2];
  const Corner& d = *four.corner[3];
  const Vec3 ab = b.at - a.at;
  const Vec3 ac = c.at - a.at;
  const Vec3 ad = d.at - a.at;
  const double volume = ab.cross(ac).dot(ad);
  if (std::abs(volume) > kFlat * ab.norm() * ac.norm() * ad.norm()) {
    const double of_b = -a.at.dot(ac.cross(ad)) / volume;
    const double of_c = -a.at.dot(ad.cross(ab)) / volume;
    const double of_d = -a.at.dot(ab.cross(ac)) / volume;
    if (of_b >= 0 && of_c >= 0 && of_d >= 0 && of_b + of_c + of_d <= 1) {
      Simplex found = four;
      found.part = {1 - of_b - of_c - of_d, of_b, of_c, of_d};
      return found;
    }
  }
  return nearer(nearer(nearest_of(a, b, c), nearest_of(a, b, d)),
                nearer(nearest_of(a, c, d), nearest_of(b, c, d)));
}

Simplex nearest_in(const Simplex& simplex) {
  const auto& corner = simplex.corner;
  switch (simplex.count) {
    case 1:
      return simplex;
    case 2:
      return nearest_of(*corner[0], *corner[1]);
    case 3:
      return nearest_of(*corner[0], *corner[1], *corner[2]);
    default:
      return nearest_of(simplex);
  }
}

const Vec3& farthest(std::span<const Vec3> points, const Vec3& way) {
  const Vec3* best = points.data();
  double most = -std::numeric_limits<double>::infinity();
  for (const Vec3& point : points) {
    const double along = point.dot(way);
    if (!(along > most)) continue;
    most = along;
    best = &point;
  }
  return *best;
}

HullGap search(std::span<const Vec3> first, std::span<const Vec3> second, bool any_plane) {
  const auto corner_along = [&](const Vec3& way) {
    const Vec3& a = farthest(first, -way);
    const Vec3& b = farthest(second, way);
    return Corner{a - b, a, b};
  };
  std::array<Corner, kMostSteps + 1> corners;
  corners[0] = corner_along(first.front() - second.front());
  Simplex simplex;
  simplex.add(corners[0], 1);
  double size = 0;
  for (std::size_t n = 0; n < kMostSteps; ++n) {
    const Vec3 place = simplex.place();
    const Corner& next = corners[n + 1] = corner_along(place);
    size = std::max(size, next.at.norm());
    const double length2 = place.squaredNorm();
    if (simplex.count == 4 || length2 <= kMeet * kMeet * size * size) return {};
    const double bound = next.at.dot(place);  // of the least distance, times this length
    const bool is_nearest = length2 - bound <= kExact * length2;
    if (is_nearest || (any_plane && bound > kMeet * size * std::sqrt(length2))) break;
    Simplex wider = simplex;
    wider.add(next, 0);
    wider = nearest_in(wider);
    if (!(wider.count == 4 || wider.place().squaredNorm() < length2)) break;  // rounding
    simplex = wider;
  }
  HullGap gap{simplex.place().norm()};
  for (std::size_t c = 0; c < simplex.count; ++c) {
    gap.first += simplex.part[c] * simplex.corner[c]->first;
    gap.second += simplex.part[c] * simplex.corner[c]->second;
  }
  return gap;
}

}  // namespace

HullGap hull_gap(std::span<const Vec3> first, std::span<const Vec3> second) {
  return search(first, second, false);
}

bool are_apart(std::span<const Vec3> first, std::span<const Vec3> second) {
  return search(first, second, true).distance_world > 0;
}

}  // namespace vdb_offset
