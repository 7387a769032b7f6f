#pragma once

#include <array>
#include <cstddef>

#include "blocks/hexahedron.h"
#include "vdb_offset/blocks/multi_block.h"

namespace vdb_offset {

/// Rows of cells along i of a block, judged a stack at a time: the cells of some layers over one
/// quad, or over one polygon, side by side in vectors.
class CellRow {
 public:
  static constexpr std::size_t kStack = 32;  ///< most cells of a stack
  /// A value a level or layer; whole packs beyond the last.
  using Line = std::array<double, kStack + hexahedron::kPack>;
  using Stack = hexahedron::Measures<Line>;

  /// `mesh` and `block` have to stay.
  CellRow(const MultiBlock& mesh, const Block& block) : mesh_(mesh), block_(block) {}

  /// Turns to row j and layers `first` to first + count - 1 (count <= kStack), before stack i.
  void turn_to(std::array<int, 2> stack, int first, int count);

  /// The measures of the next stack along i, from its lowest layer up.
  const Stack& next();

  /// Two columns, j and j + 1, and the edges between and along them.
  struct Side {
    std::array<hexahedron::Triple<Line>, 2> point;
    hexahedron::CellEdge<Line> across;
    std::array<hexahedron::CellEdge<Line>, 2> up;
    Line growth2;
    std::array<double, 2> below2;  ///< squared heights of the layer below the first, 0: none
  };

 private:
  void load_side(const std::array<int, 2>& columns, Side& side) const;
  void judge_unsound(const std::array<const Side*, 2>& sides);

  const MultiBlock& mesh_;
  const Block& block_;
  int j_ = 0;
  int i_ = 0;
  int first_ = 0;
  std::size_t count_ = 0;
  std::array<Side, 2> sides_{};  // side i in i % 2
  hexahedron::LevelFace<Line> faces_{};
  Stack stack_{};
};

}  // namespace vdb_offset
