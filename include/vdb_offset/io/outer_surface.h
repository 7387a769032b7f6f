#pragma once

#include <filesystem>

#include "vdb_offset/blocks/multi_block.h"
#include "vdb_offset/surface/patch.h"

namespace vdb_offset {

/// The outermost level, a patch a block: normals point away from the wall, and points are those of
/// the blocks to the bit. Of a flat mesh: curves (`nj == 1`).
///
/// For another mesher, to fill what the layers leave: `write_plot3d` or `write_cgns` it, or one of
/// the following.
Patches outer_level(const MultiBlock& mesh);

/// Write the outermost level as Wavefront `.obj`: points once, each double to the bit, quads (where
/// edges are collapsed triangles), a group a block; of a flat mesh lines. Watertight where the
/// level is closed, seams and poles included. By temporary file and rename.
/// Throws IoError naming the file; LimitError beyond 2^31 - 1 points.
void write_outer_obj(const std::filesystem::path& file, const MultiBlock& mesh);

/// Write it as binary STL: triangles, quads cut along their shorter diagonal. Its numbers are
/// floats, so points are the blocks' rounded to 24 bits, the same wherever they are shared;
/// triangles that rounding leaves without area are left out.
/// Throws as `write_outer_obj`, and InputError for a flat mesh; LimitError from 2^32 triangles.
void write_outer_stl(const std::filesystem::path& file, const MultiBlock& mesh);

}  // namespace vdb_offset
