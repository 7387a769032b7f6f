#pragma once

#include <filesystem>

#include "vdb_offset/blocks/multi_block.h"
#include "vdb_offset/io/cgns.h"

namespace vdb_offset {

/// Writes a mesh with blocks of polygons: all of it as one unstructured zone.
void write_cgns_cells(const std::filesystem::path& file, const MultiBlock& mesh,
                      const CgnsWriteOptions& options);

}  // namespace vdb_offset
