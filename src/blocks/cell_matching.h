#pragma once

#include <array>
#include <vector>

#include "vdb_offset/blocks/check_cells.h"

namespace vdb_offset {

/// Kinds of which base and top are exchanged.
using Mirrored = std::array<bool, kCellKinds>;

/// Faces of cells and of boundaries brought together: counts those that fit, into `check`, and
/// gives a fault for each way not to.
std::vector<MeshFault> match_faces(const CellZone& mesh, const Mirrored& mirrored,
                                   CellCheck& check);

/// A fault for points of no cell; nothing if there are none.
std::vector<MeshFault> find_unused(const CellZone& mesh);

}  // namespace vdb_offset
