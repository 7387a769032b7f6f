#pragma once

#include "vdb_offset/surface/patch.h"
#include "vdb_offset/surface/surface_options.h"

namespace vdb_offset {

/// The names and kinds that boundaries are given: none is called as a part of the wall is, whose
/// conditions go by name too, and curves bound a plane, surfaces a space.
void check_boundaries(const Patches& wall, const SurfaceOptions& options, bool flat);

}  // namespace vdb_offset
