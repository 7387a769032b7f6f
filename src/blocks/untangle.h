#pragma once

#include <vector>

#include "blocks/column_system.h"
#include "blocks/window.h"
#include "vdb_offset/core/progress.h"
#include "vdb_offset/surface/surface.h"

namespace vdb_offset {

/// A window's points, where its levels should lie, and how long its edges should be.
struct WindowShape {
  /// Of each face: how much its cells count, and whether they are judged by their tetrahedra too,
  /// which can be inverted between sound corners.
  struct Care {
    double weight = 1;
    bool tetrahedra = false;
  };
  ColumnVector points_world;                       ///< by slot and level
  std::vector<std::vector<double>> heights_world;  ///< by slot: of each level, true distance
  std::vector<std::array<std::vector<double>, 4>> edges_world;  ///< of each face, from each column
                                                                ///< to the next: by level
  std::vector<Care> care;
};

/// Moves the free points of a window until its corners are as near to the ideal, and its levels to
/// their heights, as they can be.
///
/// Minimises sum f(corners) + sum weight ((phi - height) / layer)^2 by Newton steps, each solved by
/// conjugate gradients preconditioned with the columns alone. Points on boundaries stay on them.
/// Out       how many Newton steps it took.
/// Accuracy  until a step lowers the sum by less than 1e-3 of it, twice.
/// Cost      about 0.15 milliseconds a point; 0.8 kilobytes a point.
/// Threads   side by side, bitwise the same result for any count.
int untangle(const Surface& surface, const Window& window, WindowShape& shape,
             const Progress& progress);

}  // namespace vdb_offset
