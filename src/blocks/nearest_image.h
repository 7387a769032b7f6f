#pragma once

#include "vdb_offset/core/vec.h"
#include "vdb_offset/surface/surface.h"

namespace vdb_offset {

/// Nearest place on the wall, or on its image where a point lies beyond a boundary. `guess`: the
/// triangle of the last such place near by, -1: none; becomes this one's.
inline WallPoint nearest_image(const Surface& surface, const Vec3& point_world, int& guess) {
  const Boundaries* const boundaries = surface.boundaries.get();
  WallPoint near;
  if (boundaries != nullptr && !boundaries->empty()) {
    const Folded folded = boundaries->fold(point_world);
    near = surface.wall->closest_from(guess, folded.point_world());
    near.point_world = folded.unfold(near.point_world);
  } else {
    near = surface.wall->closest_from(guess, point_world);
  }
  guess = near.triangle;
  return near;
}

}  // namespace vdb_offset
