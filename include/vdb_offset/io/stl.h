#pragma once

#include <filesystem>

#include "vdb_offset/surface/patch.h"

namespace vdb_offset {

/// Write a surface as binary STL: triangles, quads cut along their shorter diagonal, normals as the
/// patches'. Its numbers are floats, so points are rounded to 24 bits, the same wherever patches
/// share them; triangles that rounding leaves without area are left out.
/// By temporary file and rename.
/// Throws  IoError naming the file; InputError for curves; LimitError from 2^32 triangles.
void write_stl(const std::filesystem::path& file, const Patches& patches);

}  // namespace vdb_offset
