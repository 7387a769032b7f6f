#pragma once

#include <array>

#include "vdb_offset/core/vec.h"
#include "vdb_offset/surface/surface.h"

namespace vdb_offset {

/// Free edges both ends of which lie so near to nodes of other free edges that welding with a
/// larger tolerance makes them one: cracks, unless they are meant.
struct OpenGaps {
  int edges = 0;
  double weld_first = 0;                 ///< `SurfaceOptions::weld` that joins the first of them
  double weld_all = 0;                   ///< and all of them; below 0.5
  std::array<Vec3, 2> first_world = {};  ///< ends of the edge that is joined first
};

/// Nodes of one body alone are welded; those of a flat surface, and of its second side, are not
/// asked for. `weld`, the tolerance that the surface was welded with, joins no more than it did:
/// nodes that it left apart are of two sides of something thin. Cost  O(n log n) in the number of
/// free edges.
OpenGaps open_gaps(const Surface& surface, double weld = 0);

}  // namespace vdb_offset
