#pragma once

#include "vdb_offset/core/vec.h"
#include "vdb_offset/surface/wall.h"

namespace vdb_offset {

/// The solid angle under which a triangle is seen from a point, positive from behind it, in
/// [-2 pi, 2 pi].
double solid_angle(const TriangleGeometry& t, const Vec3& query);

/// How it changes with the point, which is not on the triangle's edges.
Vec3 solid_angle_gradient(const TriangleGeometry& t, const Vec3& query);

}  // namespace vdb_offset
