#pragma once

#include "blocks/window_shape.h"
#include "vdb_offset/surface/surface.h"

namespace vdb_offset {

/// Moves free levels along their columns to their true distances from the wall, as far as cells
/// stay as good as they are, or no worse than the window's worst and by a tenth at most. Levels on
/// internal surfaces stay there.
/// Cost      about 5 microseconds a point.
/// Threads   side by side, bitwise the same result for any count.
void meet_heights(const Surface& surface, WindowShape& shape);

}  // namespace vdb_offset
