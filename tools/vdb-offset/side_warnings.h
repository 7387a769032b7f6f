#pragma once

#include "console.h"
#include "vdb_offset/pipeline.h"

namespace vdb_offset::command {

/// Warns of internal surfaces that go through cells, of those that were given for nothing, and of
/// points beyond boundaries. Of finished blocks.
void warn_of_sides(const Console& console, const MeshResult& result, const SurfaceOptions& options);

/// Warns of layers that lie in those over other faces. Of finished blocks.
void warn_of_crossings(const Console& console, const MeshResult& result);

}  // namespace vdb_offset::command
