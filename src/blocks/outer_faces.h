#pragma once

#include <vector>

#include "vdb_offset/blocks/multi_block.h"
#include "vdb_offset/surface/surface.h"

namespace vdb_offset {

/// The outermost level of a block as boundary faces, without conditions: rectangles of faces of
/// cells whose columns all end on one internal surface, which have its name, and of the others,
/// "outer". One, if all are alike.
std::vector<BoundaryFace> outer_faces(const Surface& surface, const MultiBlock& mesh, int block);

/// The same for all blocks, in place of those that there are, after ends of columns were moved.
/// Conditions stay with their names; an "outer" that is new is farfield.
void part_outer_levels(const Surface& surface, MultiBlock& mesh);

}  // namespace vdb_offset
