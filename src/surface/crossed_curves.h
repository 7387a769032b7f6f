#pragma once

#include "vdb_offset/surface/surface.h"

namespace vdb_offset {

/// Throws InputError naming the place where a curve of a flat surface crosses itself, or touches
/// itself, if one does; curves that share points are one.
/// Cost  O(n log n) in its segments, and those that lie over each other along x.
void refuse_crossed_curves(const Surface& surface);

}  // namespace vdb_offset
