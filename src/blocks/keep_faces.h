#pragma once

#include "blocks/window.h"
#include "vdb_offset/blocks/multi_block.h"
#include "vdb_offset/surface/surface.h"

namespace vdb_offset {

/// Lowers columns, and neighbours' with them so that heights do not step, where layers over faces
/// do not keep from facing ones as they are now (see `face_room`). Returns how many.
int keep_faces_apart(const Surface& surface, const ColumnGraph& graph, MultiBlock& mesh);

}  // namespace vdb_offset
