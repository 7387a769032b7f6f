#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "blocks/column_system.h"
#include "blocks/window.h"
#include "vdb_offset/blocks/multi_block.h"
#include "vdb_offset/surface/boundary.h"

namespace vdb_offset {

/// What the cells over one face of a window should be like.
struct FaceGoal {
  std::array<std::vector<double>, 4>
      edges_world;           ///< ideal, from each column to the next: by level
  double least_quality = 0;  ///< scaled Jacobian
  double weight = 1;         ///< how much they count
  int misses = 0;            ///< windows around it that did not mend it
  bool tetrahedra = false;   ///< judged by those too, which can be inverted between sound corners
};

/// A window's points, and where they should be.
struct WindowShape {
  Window window;
  ColumnVector points_world;                       ///< by slot and level
  std::vector<std::vector<double>> heights_world;  ///< by slot: of each level, true distance
  std::vector<std::size_t> first_free;             ///< by slot: its lowest level that may move
  std::vector<FaceGoal> goals;                     ///< by face
  std::vector<int> ends_on;  ///< by slot: the internal surface that its last level stays on, or -1
  std::vector<BoundarySet> kept_from;  ///< by slot: the surfaces that it keeps from
  double work = 0;  ///< done to untangle it, of each of its free points (see untangle.h)
};

/// The window as the mesh has it. Cells want the wall's edges, except where columns spread far;
/// and `quality`, where the wall's own angles allow it. Levels near the wall stay as they are
/// where their cells are good.
WindowShape make_shape(const MultiBlock& mesh, Window window, double quality);

/// Some of a window's columns, others held; `part` is of its slots and faces.
WindowShape cut_out(const WindowShape& whole, const Window& part);

/// Puts the free columns of that part back.
void put_back(const WindowShape& cut, const Window& part, WindowShape& whole);

}  // namespace vdb_offset
