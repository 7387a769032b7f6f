#pragma once

#include <cstddef>
#include <vector>

#include "vdb_offset/core/vec.h"
#include "vdb_offset/surface/surface.h"

namespace vdb_offset {

/// An open part of a wall that lies in the solid of closed ones, or stands on their faces or edges
/// without sharing nodes.
struct Sheet {
  int patch = -1;                   ///< of the sheet, where it does so first
  int other = -1;                   ///< of the closed part, nearest to there
  Vec3 place_world = Vec3::Zero();  ///< on the sheet
  std::size_t faces = 0;            ///< triangles in the solid
  std::size_t edges = 0;            ///< free edges on it: where there are no such triangles
};

/// Open parts, in the order of their patches. Free edges stand on a closed part both ends of which
/// lie within kOnShape of their length of it. Solid is what is behind normals, once, as for
/// `find_overlaps`; flat surfaces and walls with layers on both sides are passed over.
/// Cost    of a wall with both kinds of parts a query of Winding for each triangle of open ones
///         within the box around closed ones, and one of the hierarchy for each end of free edges.
/// Threads the same result for any count.
std::vector<Sheet> find_sheets(const Surface& surface);

}  // namespace vdb_offset
