#pragma once

#include <cstddef>
#include <vector>

#include "vdb_offset/core/vec.h"
#include "vdb_offset/surface/surface.h"

namespace vdb_offset {

/// A closed part of a wall whose layers would lie in the solid of another.
struct Overlap {
  int patch = -1;                   ///< of the part, where it does so first
  int other = -1;                   ///< of the other, its first
  Vec3 place_world = Vec3::Zero();  ///< on the part
  /// Triangles of the part that lie so, or edges of a curve; 1 where an edge alone does.
  std::size_t faces = 0;
};

/// Closed parts, closed curves in two dimensions, that overlap, or one of which lies within another
/// as if both were solid.
///
/// Beside a wall, on the side that layers grow on, its winding number is 0, or -1 where normals
/// point into what is enclosed (a duct); a shell within another whose normals point inward is a
/// hollow, and fits. Numbers of 1 or -2 are those of places in a solid, or twice in the flow.
/// Parts that are open, that cross themselves alone, and walls with layers on both sides are passed
/// over. Each pair is found from the triangles of either whose middles lie in the other; both are
/// named where both do. One more is found by edges that go through another, deeper than 1e-4 of
/// their length.
/// Cost    for parts whose boxes meet a query of Winding each triangle there, and one of the
///         hierarchy each edge.
/// Threads the same result for any count.
std::vector<Overlap> find_overlaps(const Surface& surface);

/// Edges of a wall's triangles that go through others of its triangles.
struct SelfCrossing {
  std::size_t edges = 0;
  Vec3 place_world = Vec3::Zero();  ///< of the first, where it does so
};

/// Cost  a query of the hierarchy for each edge, side by side. The same for any thread count.
SelfCrossing find_self_crossing(const Wall& wall);

/// A closed part that encloses nothing: no side of it is an inside.
struct FlatPart {
  Vec3 place_world = Vec3::Zero();  ///< a corner of it
  double thickness_world = 0;       ///< twice its volume by its area
};

/// Parts of a closed wall thinner than 1e-9 of its size and farthest coordinate, in its order.
std::vector<FlatPart> find_flat_parts(const Wall& wall);

}  // namespace vdb_offset
