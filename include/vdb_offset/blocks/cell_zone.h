#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "vdb_offset/blocks/connectivity.h"
#include "vdb_offset/core/vec.h"

namespace vdb_offset {

enum class CellKind { Tetrahedron, Pyramid, Prism, Hexahedron, Polyhedron };
inline constexpr std::size_t kCellKinds = 5;

/// Lists of points, one after another.
struct PointLists {
  std::vector<std::int32_t> points = {};
  std::vector<std::size_t> first{0};  ///< that each list begins with, and the end

  std::size_t size() const { return first.size() - 1; }
  std::span<const std::int32_t> operator[](std::size_t n) const {
    return std::span(points).subspan(first[n], first[n + 1] - first[n]);
  }
  void add(std::span<const std::int32_t> list) {
    points.insert(points.end(), list.begin(), list.end());
    first.push_back(points.size());
  }
};

/// Boundary faces of one name.
struct CellBoundary {
  std::string name;
  std::string type = {};  ///< as the file has it; empty: it has none
  PointLists faces = {};  ///< points around, in either sense
};

/// An unstructured volume mesh as a file holds it: nothing of it need be true, but that points
/// which cells and faces name are there.
///
/// Corners in VTK's order, the base (of the prism: the first triangle) counter-clockwise seen from
/// within: pyramids end with the apex. A polyhedron's are the number of its faces, then for each
/// the number of its points and these, counter-clockwise seen from outside.
struct CellZone {
  Vec3List points_world;
  std::vector<CellKind> kinds;
  PointLists cells;
  std::vector<CellBoundary> boundaries;
  /// Whether the format has boundaries: else a face of one cell need not be in any.
  bool names_boundaries = true;
  /// Of two dimensions, in z = 0, made one cell thick: the first half of the points is the mesh.
  bool flat = false;
  /// What reading found wrong and had to leave out: a sentence each.
  std::vector<std::string> faults = {};

  void add(CellKind kind, std::span<const std::int32_t> corners) {
    kinds.push_back(kind);
    cells.add(corners);
  }
};

/// "tetrahedra", "pyramids", "prisms", "hexahedra", "polyhedra"
const char* name_of(CellKind kind);

/// A cell's corners as those of a hexahedron, VTK's order, on which edges are collapsed where it is
/// none; not of a polyhedron.
std::array<std::int32_t, 8> as_hexahedron(CellKind kind, std::span<const std::int32_t> corners);

/// `visit(points)` for each face of a cell, points counter-clockwise seen from outside, each once;
/// faces that have collapsed to a line are left out.
template <typename Visit>
void for_cell_faces(CellKind kind, std::span<const std::int32_t> corners, const Visit& visit) {
  if (kind == CellKind::Polyhedron) {
    std::size_t at = 1;
    for (std::int32_t f = 0; f < corners[0]; ++f) {
      const auto count = static_cast<std::size_t>(corners[at]);
      visit(corners.subspan(at + 1, count));
      at += count + 1;
    }
    return;
  }
  constexpr std::array<std::array<std::size_t, 4>, 6> kFaces{
      {{0, 4, 7, 3}, {1, 2, 6, 5}, {0, 1, 5, 4}, {3, 7, 6, 2}, {0, 3, 2, 1}, {4, 5, 6, 7}}};
  const std::array<std::int32_t, 8> all = as_hexahedron(kind, corners);
  for (const auto& face : kFaces) {
    std::array<std::int32_t, 4> points{};
    std::size_t count = 0;
    for (const std::size_t corner : face) {
      if (count == 0 || points[count - 1] != all[corner]) points[count++] = all[corner];
    }
    while (count > 1 && points[count - 1] == points[0]) --count;
    const bool is_folded = count == 4 && (points[0] == points[2] || points[1] == points[3]);
    if (count >= 3 && !is_folded) visit(std::span<const std::int32_t>(points.data(), count));
  }
}

}  // namespace vdb_offset
