#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "io/cell_mesh.h"
#include "io/linear_cell.h"
#include "io/part_middle.h"

namespace vdb_offset {

/// Cells as tetrahedra, pyramids, prisms and hexahedra alone, so that faces still fit.
///
/// Where fans close, first cells are prisms whose bottom is folded to a line: two triangles and
/// two quads that meet in three points. The middle one of these, the hinge, is the end of two edges
/// alone, so the quads' corners there lie back to back, and no point sees both from within. Such a
/// cell is the tetrahedron of its other points: the quads become triangles off the hinge, and
/// their parts at the hinge, in one place, close on each other. A neighbour that sees such a
/// quad, and any other cell that is no element, is parted about a point in its middle, the mean of
/// its corners if that sees all faces (part_middle.h): a pyramid or tetrahedron for each face.
/// Where a column has no height and no point sees all faces the whole stack is parted about that
/// column: a pyramid for each face off it, and level faces are cut along the diagonal from it.
class CellParts {
 public:
  /// `emit(kind, points)`; points as in LinearCell.
  using Emit = std::function<void(LinearCell::Kind, std::span<const std::int32_t>)>;

  CellParts(const MultiBlock& mesh, const CellMesh& cells);

  /// Cells with all that are parted, and less those that were.
  std::int64_t elements() const { return cells_.cells() + further_; }
  /// Cells that these are not positive of.
  std::int64_t inverted() const { return inverted_; }
  /// Of the cells that are parted: points behind all others.
  const Vec3List& middles() const { return middles_; }

  /// The elements of one cell; further points are numbered in the order of cells.
  void put(int block, const CellMesh::Place& place, const Emit& emit) const;
  /// The polygons that a cell's face is.
  std::vector<Polygon> face(int block, const CellMesh::Place& place, BlockFace of) const;

 private:
  void find_folded();
  void find_parted();
  void find_coned();
  std::vector<InnerFace> faces_off(int block, const CellMesh::Place& place,
                                   std::int32_t point) const;
  bool is_sound(int block, const CellMesh::Place& place, const std::vector<InnerFace>& faces,
                std::int32_t corner) const;
  void judge_folded(int block, const CellMesh::Place& place, std::int32_t hinge);
  void part(int block, const CellMesh::Place& place);

  const MultiBlock& mesh_;
  const CellMesh& cells_;
  std::map<std::int32_t, std::int32_t> hinges_;   ///< of cells that are folded
  std::map<std::int32_t, std::int32_t> parted_;   ///< cells, and which of `middles_` they have
  std::map<std::int32_t, std::int32_t> corners_;  ///< cells, and the point they are parted about
  Vec3List middles_;
  std::int64_t further_ = 0;
  std::int64_t inverted_ = 0;
};

}  // namespace vdb_offset
