#pragma once

#include "console.h"
#include "vdb_offset/pipeline.h"

namespace vdb_offset::command {

/// Warns of internal surfaces that go through cells, of those that were given for nothing, and of
/// points beyond boundaries. Of finished blocks.
void warn_of_sides(const Console& console, const MeshResult& result, const SurfaceOptions& options);

}  // namespace vdb_offset::command
