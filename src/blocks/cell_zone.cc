#include "vdb_offset/blocks/cell_zone.h"

namespace vdb_offset {

const char* name_of(CellKind kind) {
  constexpr std::array<const char*, kCellKinds> kNames{"tetrahedra", "pyramids", "prisms",
                                                       "hexahedra", "polyhedra"};
  return kNames[static_cast<std::size_t>(kind)];
}

std::array<std::int32_t, 8> as_hexahedron(CellKind kind, std::span<const std::int32_t> corners) {
  constexpr std::array<std::array<std::size_t, 8>, 4> kCorners{{{0, 1, 2, 2, 3, 3, 3, 3},
                                                                {0, 1, 2, 3, 4, 4, 4, 4},
                                                                {0, 1, 2, 2, 3, 4, 5, 5},
                                                                {0, 1, 2, 3, 4, 5, 6, 7}}};
  std::array<std::int32_t, 8> out{};
  for (std::size_t n = 0; n < 8; ++n) out[n] = corners[kCorners[static_cast<std::size_t>(kind)][n]];
  return out;
}

}  // namespace vdb_offset
