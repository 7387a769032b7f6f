#pragma once

#include <array>
#include <vector>

#include "surface/find_boundaries.h"
#include "surface/plane_finder.h"

namespace vdb_offset {

/// The ends of curves that bound a body and come near to their own beginning again, as an airfoil
/// with an open trailing edge: nearer than a fifth of their size. They are taken, so that no plane
/// is found on them.
std::vector<std::array<Vec3, 2>> leave_open_tails(const OpenSurface& surface, PlaneFinder& finder);

}  // namespace vdb_offset
