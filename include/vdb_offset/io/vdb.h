#pragma once

#include <filesystem>

#include "vdb_offset/march/march.h"
#include "vdb_offset/sweep/sweep.h"

namespace vdb_offset {

/// Write the grids `phi` and, with `layers`, `level` (the outermost level's points, a
/// PointDataGrid, in node order within a voxel).
///
/// `phi` is GRID_LEVEL_SET for a closed surface: negative behind the wall, inactive voxels too,
/// background = half-width in world units. A closed surface that the blocks fill from inside (a
/// duct) is signed as well, but GRID_UNKNOWN: level sets cannot be negative out to infinity.
/// An open surface gives GRID_UNKNOWN and |phi|.
/// Cost    a copy of the tree. The same trees and metadata for any thread count.
/// Throws  IoError naming the file. By temporary file and rename.
void write_vdb(const std::filesystem::path& file, const DistanceField& field,
               const Layers* layers = nullptr);

}  // namespace vdb_offset
