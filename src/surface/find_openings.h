#pragma once

#include <cstddef>
#include <vector>

#include "surface/plane_finder.h"

namespace vdb_offset {

/// Closed loops of free edges in one plane, around the flow: where a duct is open.
struct Opening {
  Plane plane;                     ///< normal of unit length, towards the wall at the loops
  std::vector<std::size_t> edges;  ///< of the finder's
};

/// Those made of edges that are not taken yet, the wall upright on their planes at 45 degrees or
/// more. The wall may pass the planes elsewhere.
std::vector<Opening> find_openings(const PlaneFinder& finder);

}  // namespace vdb_offset
