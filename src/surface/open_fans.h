#pragma once

#include <vector>

#include "vdb_offset/surface/surface.h"

namespace vdb_offset {

/// Opens the sharp convex edges of an oriented surface into fans (see Fans) of `columns` cells
/// each; patches that such edges run through are split along them first.
///
/// In   surface: oriented, with its wall and boundaries, all sides that are marched on.
///      component: of each patch.
/// Out  both with the patches added. The topology is not touched.
void open_fans(Surface& surface, int columns, std::vector<int>& component);

}  // namespace vdb_offset
