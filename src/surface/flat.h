#pragma once

#include "vdb_offset/surface/surface.h"

namespace vdb_offset {

/// Whether all patches are curves. Throws InputError for a mixture with surfaces.
bool is_flat(const Patches& patches);

/// Makes strips of curves in a plane z = const, from z = 0 to the curves' size; adds the two planes
/// that the strips end on to `options`, before all others. Returns the width of the strips.
/// Throws InputError where the curves are in no such plane.
double extrude(Patches& patches, SurfaceOptions& options);

}  // namespace vdb_offset
