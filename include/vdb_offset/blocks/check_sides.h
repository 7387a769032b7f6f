#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "vdb_offset/blocks/multi_block.h"
#include "vdb_offset/core/progress.h"
#include "vdb_offset/core/vec.h"
#include "vdb_offset/surface/surface.h"

namespace vdb_offset {

/// What lies on the wrong side of a boundary, past its rim, or on both sides of an internal
/// surface.
struct Astray {
  std::string name;                 ///< of the boundary
  std::uint64_t count = 0;          ///< points; cells that an internal surface cuts
  double farthest_world = 0;        ///< of points, from it
  Vec3 place_world = Vec3::Zero();  ///< the first point, or where the first edge is cut
};

struct SidesReport {
  std::vector<Astray> beyond;  ///< by boundary, those alone that there is something of
  std::vector<Astray> cut;     ///< by internal surface
  std::vector<Astray> past;    ///< by boundary surface: points on it that are past its rim
};

/// Points beyond this part of the distance are.
inline constexpr double kBeyond = 1e-6;

/// Finds points of columns that lie beyond a boundary, farther than their feet on the wall do, and
/// cells of which an edge (of a column, or of a level, the wall's too) goes through an internal
/// surface from one side to the other; and points of columns that march on a boundary surface where
/// that has ended.
///
/// Accuracy  points by kBeyond of the distance; edges by rounding.
/// Cost      a query a point and surface, and four an edge and internal surface.
/// Threads   bitwise the same for any count.
SidesReport check_sides(const Surface& surface, const MultiBlock& mesh,
                        const Progress& progress = {});

}  // namespace vdb_offset
