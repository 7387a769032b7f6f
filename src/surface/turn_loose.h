#pragma once

#include "surface/orient.h"

namespace vdb_offset {

/// Turns the closed components that loose patches alone make up, and whose normals point inward,
/// but for those within other closed ones; how many.
int turn_loose(NodeGrids grids, Orientation& orientation);

}  // namespace vdb_offset
