#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "io/cell_mesh.h"

namespace vdb_offset {

/// A cell without its collapsed edges, as formats of unstructured meshes know it. Bases run
/// counter-clockwise seen from within the cell, tops behind them in the same order.
struct LinearCell {
  enum class Kind { Tetrahedron, Pyramid, Prism, Hexahedron };

  Kind kind = Kind::Hexahedron;
  std::array<std::int32_t, 8> corners{};
  std::size_t count = 8;

  std::span<const std::int32_t> points() const { return std::span(corners).first(count); }
};

/// Cells with other faces than these kinds have stay hexahedra, with points that repeat.
LinearCell linear_cell(const Corners& corners);

}  // namespace vdb_offset
