// What lies on two boundaries at once would have one of their names only.

#include "surface/coincide.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "vdb_offset/core/error.h"

namespace vdb_offset {
namespace {

double height(const Plane& plane, const Vec3& p) { return plane.normal.dot(p - plane.point_world); }

/// Vertices and middles of its triangles.
template <typename Holds>
bool lies_on(const Wall& shape, const Holds& holds) {
  return std::ranges::all_of(shape.geometry(), [&](const TriangleGeometry& t) {
    return holds(t.a) && holds(t.a + t.ab) && holds(t.a + t.ac) && holds(t.a + (t.ab + t.ac) / 3);
  });
}

}  // namespace

bool is_same_plane(const Plane& other, const PlaneOver& over) {
  const double turned = other.normal.dot(over.plane.normal) < 0 ? -1 : 1;
  return std::ranges::all_of(over.points_world, [&](const Vec3& p) {
    return std::abs(height(other, p) - turned * height(over.plane, p)) <= over.tolerance_world;
  });
}

void refuse_same_surface(const Boundaries& there, std::size_t first, const std::string& name,
                         const Wall& shape) {
  for (std::size_t b = first; b < there.list().size(); ++b) {
    const Boundary& other = there.list()[b];
    if (!lies_on(shape, [&](const Vec3& p) { return other.holds(p); })) continue;
    throw InputError(fmt::format(
        "the internal surface '{}' lies on '{}', all of it; give one of them, or parts that do not "
        "overlap",
        name, other.name()));
  }
}

}  // namespace vdb_offset
