#pragma once

#include "sweep/kernel.h"
#include "sweep/tile_schedule.h"

namespace vdb_offset {

/// Wake, for the news of a tile's seeds, the tiles that touch them, in the octants that lead away.
/// `open` has the bits of each tile's unreached voxels; the buffers hold codes.
void wake_from_seeds(TileSchedule& schedule, const TileBits* open, std::size_t tile);

}  // namespace vdb_offset
