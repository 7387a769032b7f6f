#pragma once

#include <cstddef>
#include <vector>

#include "surface/cut_faces.h"
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

/// Those of chains that planes cut off, which end the whole wall: the inlet of half a pipe.
std::vector<Opening> find_cut_openings(const PlaneFinder& finder, std::vector<CutPlane> planes);

}  // namespace vdb_offset
