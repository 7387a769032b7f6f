#pragma once

#include <optional>

#include "vdb_offset/core/vec.h"
#include "vdb_offset/surface/wall.h"

namespace vdb_offset {

/// Whether an end of a segment that lies on the wall counts as beyond it.
enum class EndsCount { Yes, No };

/// A straight way, world.
struct Segment {
  Vec3 from, to;
};

/// Places this near a wall, in parts of its size and of its coordinates, are on it: rounding.
inline constexpr double kOnWall = 1e-12;
/// The same beside its free edges: a surface may end on the plane that the domain ends on.
inline constexpr double kOnRim = 1e-9;

/// How near a place on a wall is, world.
double on_wall(const Wall& wall);

/// The part of a segment after which it first goes through a wall; nothing if it does not.
///
/// Watertight: a segment that goes through where triangles share an edge or a vertex goes through
/// one of them at least, and of consecutive segments one at least goes through where they meet.
/// Cost  that of the triangles in the segment's box.
std::optional<double> first_crossing(const Wall& wall, const Segment& segment, EndsCount ends);

/// The same of one triangle of the wall; ends on it do not count.
std::optional<double> crossing_of(const Wall& wall, const Segment& segment, int triangle);

}  // namespace vdb_offset
