#pragma once

#include "sweep/kernel.h"
#include "sweep/tile_schedule.h"

namespace vdb_offset {

/// Voxels of a tile, by their bits, when a sweep starts.
struct TileMarks {
  TileBits negative;
  TileBits open;  ///< not reached yet
};

/// Wake, for the news of a tile's seeds, the tiles that touch them, in the octants that lead away.
/// `marks` are those of all tiles; the buffers hold codes.
void wake_from_seeds(TileSchedule& schedule, const TileMarks* marks, std::size_t tile);

}  // namespace vdb_offset
