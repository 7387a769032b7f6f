#pragma once

#include <vector>

#include "surface/plane_parts.h"

namespace vdb_offset {

/// Which of the names that a plane is given each of its parts has, -1 for none: the part nearest to
/// a name's point is its own; what closes around the flow and is nobody's is left, or that of the
/// name that takes the rest; all else goes to the nearest point. Throws InputError where that is
/// not to be told, with the points that would.
std::vector<int> share_plane(const PlaneFinder& finder, const Plane& plane,
                             const std::vector<NamedPlane>& names,
                             const std::vector<PlanePart>& parts);

}  // namespace vdb_offset
