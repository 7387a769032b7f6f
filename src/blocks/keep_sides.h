#pragma once

#include <cstddef>

#include "blocks/window_shape.h"
#include "vdb_offset/surface/surface.h"

namespace vdb_offset {

/// Finds what each free column has to keep from, as the window is: internal surfaces that it does
/// not go through, from level to level, and boundaries that it has no point beyond; none that its
/// node lies on.
void find_kept_from(const Surface& surface, WindowShape& shape);

/// Whether a column keeps from all of them, as it is now.
bool keeps_side(const Surface& surface, const WindowShape& shape, std::size_t slot);

/// The part of a straight way from a column's foot that ends before all of them.
double free_part(const Surface& surface, const WindowShape& shape, std::size_t slot,
                 const Vec3& end_world);

/// A point on the boundaries of `on`, moved: onto them, and beside others of the domain at a tenth
/// at least of the distance that it had, so that none gets beyond. Where that is not to be had it
/// stays.
Vec3 moved_inside(const Surface& surface, BoundarySet on, const Vec3& from_world,
                  const Vec3& to_world);

}  // namespace vdb_offset
