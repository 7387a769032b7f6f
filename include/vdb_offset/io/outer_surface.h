#pragma once

#include <filesystem>

#include "vdb_offset/blocks/multi_block.h"
#include "vdb_offset/surface/patch.h"

namespace vdb_offset {

/// The outermost level, a patch a block: normals point away from the wall, and points are those of
/// the blocks to the bit. It is whole, what lies on internal surfaces too: that bounds what is left
/// as the rest does. Of a flat mesh: curves (`nj == 1`).
///
/// For another mesher, to fill what the layers leave: `write_plot3d`, `write_cgns` or `write_stl`
/// it, or the following.
Patches outer_level(const MultiBlock& mesh);

/// Write the outermost level as Wavefront `.obj`: points once, each double to the bit, quads (where
/// edges are collapsed triangles), a group a block; of a flat mesh lines. Watertight where the
/// level is closed, seams and poles included. By temporary file and rename.
/// Throws IoError naming the file; LimitError beyond 2^31 - 1 points.
void write_outer_obj(const std::filesystem::path& file, const MultiBlock& mesh);

}  // namespace vdb_offset
