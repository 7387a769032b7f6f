#pragma once

#include <vector>

#include "blocks/column_system.h"
#include "blocks/corner_energy.h"
#include "blocks/window.h"
#include "vdb_offset/core/progress.h"
#include "vdb_offset/surface/surface.h"

namespace vdb_offset {

/// A window's points, and where its levels should lie.
struct WindowShape {
  ColumnVector points_world;                        ///< by slot and level
  std::vector<std::vector<double>> heights_world;   ///< by slot: of each level, true distance
  std::vector<int> surface_node;                    ///< by slot: whose boundaries hold it
};

struct UntangleReport {
  int steps = 0;
  int inner_steps = 0;    ///< of the linear solver
  double energy = 0;      ///< a corner, 1 is ideal
  double least = 0;       ///< D of the corners, above 0: none is inverted
  bool settled = false;
};

/// Moves the free points of a window until its corners are as near to the ideal, and its levels to
/// their heights, as they can be.
///
/// Minimises sum f(corners) + weight * sum ((phi - height) / layer)^2 by Newton steps, each solved
/// by conjugate gradients preconditioned with the columns alone.
UntangleReport untangle(const Surface& surface, const Window& window, WindowShape& shape,
                        const Progress& progress);

}  // namespace vdb_offset
