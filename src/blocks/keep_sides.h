#pragma once

#include <cstddef>

#include "blocks/window_shape.h"
#include "vdb_offset/surface/surface.h"

namespace vdb_offset {

/// Finds the internal surfaces that each free column has to keep from, as the window is: those that
/// it does not go through, from level to level, and that its node does not lie on.
void find_kept_from(const Surface& surface, WindowShape& shape);

/// Whether a column goes through none of them, as it is now.
bool keeps_side(const Surface& surface, const WindowShape& shape, std::size_t slot);

/// The part of a straight way from a column's foot that ends before all of them.
double free_part(const Surface& surface, const WindowShape& shape, std::size_t slot,
                 const Vec3& end_world);

}  // namespace vdb_offset
