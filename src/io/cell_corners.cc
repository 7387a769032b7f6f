#include "io/cell_mesh.h"

namespace vdb_offset {

void Polygon::add(std::int32_t point) {
  if (count == 0 || points[static_cast<std::size_t>(count - 1)] != point) {
    points[static_cast<std::size_t>(count++)] = point;
  }
}

void Polygon::close() {
  while (count > 1 && points[static_cast<std::size_t>(count - 1)] == points[0]) --count;
  // Opposite corners that are one: the face is folded onto its diagonal.
  if (count == 4 && (points[0] == points[2] || points[1] == points[3])) count = 0;
}

std::array<Polygon, 6> polygons(const Corners& corners) {
  constexpr std::array<std::array<std::size_t, 4>, 6> kFaces{
      {{0, 4, 7, 3}, {1, 2, 6, 5}, {0, 1, 5, 4}, {3, 7, 6, 2}, {0, 3, 2, 1}, {4, 5, 6, 7}}};
  std::array<Polygon, 6> out;
  for (std::size_t f = 0; f < kFaces.size(); ++f) {
    for (const std::size_t corner : kFaces[f]) out[f].add(corners[corner]);
    out[f].close();
  }
  return out;
}

Polygon CellMesh::plane_cell(const Corners& corners) {
  Polygon cell;
  for (const std::size_t corner : {0U, 4U, 5U, 1U}) cell.add(corners[corner]);
  cell.close();
  return cell;
}

Polygon CellMesh::plane_side(const Corners& corners, BlockFace face) {
  constexpr std::array<std::array<std::size_t, 2>, 6> kSides{
      {{0, 4}, {5, 1}, {0, 0}, {0, 0}, {1, 0}, {4, 5}}};
  Polygon side;
  for (const std::size_t corner : kSides[static_cast<std::size_t>(face)]) {
    side.add(corners[corner]);
  }
  return side;
}

}  // namespace vdb_offset
