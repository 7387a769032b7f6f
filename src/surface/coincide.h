#pragma once

#include <string>

#include "vdb_offset/core/vec.h"
#include "vdb_offset/surface/boundary.h"

namespace vdb_offset {

/// A plane over some points, and how near to it is on it, world.
struct PlaneOver {
  const Plane& plane;
  const Vec3List& points_world;
  double tolerance_world;
};

/// Whether all these points are as far off another plane, of either sign.
bool is_same_plane(const Plane& other, const PlaneOver& over);

/// Throws InputError if all of an internal surface lies on one of those from number `first` on.
void refuse_same_surface(const Boundaries& there, std::size_t first, const std::string& name,
                         const Wall& shape);

}  // namespace vdb_offset
