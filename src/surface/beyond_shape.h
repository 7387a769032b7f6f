#pragma once

#include <string>

#include "surface/find_boundaries.h"

namespace vdb_offset {

/// Throws InputError naming the farthest of the wall's points that lie beyond a boundary shape, if
/// any do by more than its facets may miss what they stand for, and than `near_world`: the domain
/// ends there, and the field beyond is the image of what is before it. Past the rim of a shape
/// nothing lies beyond.
void refuse_beyond(const OpenSurface& surface, const std::string& name, const Wall& shape,
                   double near_world);

}  // namespace vdb_offset
