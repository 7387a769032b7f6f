#pragma once

#include <cstddef>
#include <vector>

#include "vdb_offset/core/vec.h"
#include "vdb_offset/surface/surface.h"

namespace vdb_offset {

/// A patch with cells that have the other side of the body close behind them.
struct ThinPart {
  int patch = 0;
  std::size_t cells = 0;            ///< of the patch, that are thin
  double thickness_world = 0;       ///< the least at a cell's middle
  Vec3 place_world{0.0, 0.0, 0.0};  ///< that middle
};

/// Where the body behind the wall is thinner than two voxels, so that no voxel is sure to lie
/// within it: plates, trailing edges; wherever its sides are parallel to 20 degrees. An edge that
/// is sharper than that is thin at any voxel.
///
/// Out      by patch, each once; nothing for a surface without sides.
/// Cost     a distance query a cell, which looks no farther than a voxel.
/// Threads  cells side by side; the same result for any number.
std::vector<ThinPart> thin_parts(const Surface& surface, double voxel_world);

}  // namespace vdb_offset
