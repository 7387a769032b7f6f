#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "vdb_offset/march/march.h"
#include "vdb_offset/surface/surface.h"

namespace vdb_offset {

/// The foot of a stack of cells: three or four nodes, the last one twice where there are three.
struct WallFace {
  std::array<int, 4> node;
  std::size_t count() const { return node[2] == node[3] ? 3 : 4; }
};

struct FacePair {
  WallFace first, second;
};

/// Pairs of faces whose stacks of cells may meet: those whose convex hulls do, and whose columns go
/// towards each other or across (60 degrees apart at least). Not of faces that meet in a node.
///
/// In       layers: heights stretched by a factor.
/// Complete but for what hides in a gap far below a face's size: columns that met nothing keep
///          what is between them clear if they are close together, and are not looked at.
/// Cost     30 nanoseconds a face where nothing is met and faces are smaller than layers are high;
///          else some microseconds. Threads: the same result for any count.
std::vector<FacePair> facing_stacks(const Surface& surface, const Layers& layers, double stretch);

/// Heights to which columns have to be lowered so that layers over whole faces, not at their nodes
/// alone, keep from facing walls and their layers.
///
/// Columns of two faces whose stacks meet are let up to one height, the most at which they do not,
/// less the margin. The margin is what faces may bend into: stacks that leave a fiftieth of it are
/// let alone, and so are those that meet over a concave corner's bisector.
/// Out  for each node, infinite for those that need not be lowered; empty if none does.
/// Accuracy  1 % of the height, on the near side. Cost and threads as `facing_stacks`, and 100
///           distance queries for each pair that meets.
std::vector<double> face_room(const Surface& surface, const Layers& layers, double gap_margin);

}  // namespace vdb_offset
