#pragma once

#include <filesystem>

#include "vdb_offset/march/march.h"
#include "vdb_offset/sweep/sweep.h"

namespace vdb_offset {

/// Write the grids `phi` and, with `layers`, `level` (the outermost level's points, a
/// PointDataGrid).
///
/// `phi` is GRID_LEVEL_SET (negative behind the wall, background = half-width in world units) for a
/// closed surface, else GRID_UNKNOWN and unsigned. By temporary file and rename. Throws IoError.
void write_vdb(const std::filesystem::path& file, const DistanceField& field,
               const Layers* layers = nullptr);

}  // namespace vdb_offset
