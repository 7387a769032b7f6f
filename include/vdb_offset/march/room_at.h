#pragma once

#include <optional>

#include "vdb_offset/core/vec.h"
#include "vdb_offset/surface/surface.h"

namespace vdb_offset {

/// Free height at a point: the true distance at which the gradient line through it, away from the
/// wall that is nearest, meets the front of a facing wall.
///
/// In     `point_world`: beyond a front too; the wall behind that is then the nearest.
/// Out    world; nothing if the front is farther from the wall than `reach_world`.
/// Cost   2 distance queries where nothing is near, else about 100.
std::optional<double> room_at(const Surface& surface, const Vec3& point_world, double reach_world);

/// True height of the bisector of a sharp concave corner, where the gradient line through a point,
/// away from the wall that is nearest, meets it.
///
/// In     `rise`: sine of half the corner's inner angle, at most.
/// Out    world; nothing where there is no such bisector within `reach_world` of the wall.
/// Cost   as of room_at.
std::optional<double> bisector_at(const Surface& surface, const Vec3& point_world, double rise,
                                  double reach_world);

}  // namespace vdb_offset
