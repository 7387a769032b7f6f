#pragma once

#include <vector>

#include "vdb_offset/core/vec.h"
#include "vdb_offset/surface/surface.h"

namespace vdb_offset {

/// An opening of the flow that the wall goes through, as a shaft that sticks out of a duct.
struct PiercedOpening {
  int boundary;      ///< of the surface's
  Vec3 place_world;  ///< on its plane: the first of the wall's edges that pass it
};

/// Those on planes that the wall passes elsewhere (Boundary::is_local): layers go on through them.
/// Of openings that loops of free edges do not close by themselves nothing is known.
/// Cost  O(edges), and for each that passes the plane O(edges of the opening).
std::vector<PiercedOpening> find_pierced(const Surface& surface);

}  // namespace vdb_offset
