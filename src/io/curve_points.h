#pragma once

#include "vdb_offset/core/vec.h"

/// What the readers of curves have in common.
namespace vdb_offset {

/// Diagonal of the points' bounding box.
double size_of(const Vec3List& points);

/// Area behind a loop in the plane of x and y, positive counter-clockwise; the edge from the last
/// point to the first is part of it.
double enclosed_area(const Vec3List& loop);

/// Drop points within 1e-9 of `size` of the one before them; the last point stays.
void drop_repeats(Vec3List& points, double size);

}  // namespace vdb_offset
