#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "vdb_offset/blocks/multi_block.h"

namespace vdb_offset {

/// The foot of a stack of cells: three or four different columns, counter-clockwise seen from the
/// marching side.
struct ColumnFace {
  std::array<int, 4> column{-1, -1, -1, -1};
  std::size_t count = 0;

  int next(std::size_t corner) const { return column[(corner + 1) % count]; }
  int previous(std::size_t corner) const { return column[(corner + count - 1) % count]; }
};

/// All faces of a mesh, and the faces around each column.
struct ColumnGraph {
  std::vector<ColumnFace> faces;
  std::vector<std::size_t> first;         ///< of each column in `around`, and the end
  std::vector<int> around;                ///< faces
  std::vector<std::vector<int>> face_of;  ///< by block and stack of cells, i fastest; -1: no face

  explicit ColumnGraph(const MultiBlock& mesh);
  /// Of faces whose columns are numbered from 0; without blocks.
  ColumnGraph(std::vector<ColumnFace> of_faces, std::size_t columns);

 private:
  void connect(std::size_t columns);
};

/// Columns that may move, with the stacks of cells that they touch. Columns of a window are called
/// by their slots: the free ones first.
struct Window {
  std::vector<int> nodes;         ///< column of the mesh in each slot
  std::size_t free = 0;           ///< slots that may move
  std::vector<ColumnFace> faces;  ///< of slots
  std::vector<int> face_index;    ///< of each face in the graph
};

/// Connected parts of the columns that are marked, each with the faces around it; in the order of
/// their lowest column.
std::vector<Window> find_windows(const ColumnGraph& graph, const std::vector<bool>& marked);

/// Marks all columns within `rings` faces of a marked one.
void widen(const ColumnGraph& graph, int rings, std::vector<bool>& marked);

}  // namespace vdb_offset
