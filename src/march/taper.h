#pragma once

#include "vdb_offset/march/march.h"
#include "vdb_offset/surface/surface.h"

namespace vdb_offset {

/// Lowers heights towards nodes where the wall goes on smoothly without layers (see `march`).
void taper(const Surface& surface, Layers& layers);

}  // namespace vdb_offset
