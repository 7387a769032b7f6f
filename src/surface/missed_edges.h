#pragma once

#include <optional>
#include <string>

#include "surface/plane_finder.h"
#include "vdb_offset/surface/surface.h"

namespace vdb_offset {

/// How far the nearest free edge that runs along a plane, but not on it, is off it, world; infinite
/// if there is none.
double nearest_missed(const PlaneFinder& finder, const Plane& plane);

/// Free edges that are left, run along a plane and are off it by little: within a thousandth of the
/// surface's size.
std::optional<MissedEdges> missed_edges(const PlaneFinder& finder, const Plane& plane);

}  // namespace vdb_offset
