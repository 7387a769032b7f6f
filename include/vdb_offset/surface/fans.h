#pragma once

#include <cstddef>
#include <vector>

#include "vdb_offset/core/vec.h"

namespace vdb_offset {

/// Convex grid edges over which the cells' normals turn by more are sharp: 40 degrees, in radians.
inline constexpr double kSharpTurn = 0.6981317007977318;
/// Cells over which the angle of a fan grows where it closes.
inline constexpr int kFanClosing = 4;

/// Sharp convex edges opened into patches without area, so that N more columns of cells stand on
/// them.
///
/// A fan is a patch of `N + 1` x (points along the edge): of the N + 1 nodes at each place of the
/// edge each has its own way out, in equal angles from the one side's normal to the other's.
/// A node where three such edges meet opens into three patches of `N / 2 + 1` squared, if N is
/// even. A fan stays open where its edge goes on, and where it ends on a boundary. Elsewhere (the
/// edge ends within the surface, a concave edge or a pole meets it, other edges meet) it closes:
/// its nodes there are the one of the wall, and its angle grows from it over kFanClosing cells.
struct Fans {
  int patches = 0;           ///< they are the last of the surface's
  std::vector<int> node_at;  ///< of the last nodes, the fans' own: a node of the wall at the place
  Vec3List direction;        ///< of each node: the way out, unit; zero: the wall's.  Empty: no fans

  /// Whether a node has a way out of its own.
  bool leads(std::size_t node) const {
    return node < direction.size() && direction[node].squaredNorm() > 0;
  }
};

}  // namespace vdb_offset
