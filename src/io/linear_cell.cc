#include "io/linear_cell.h"

#include <algorithm>

namespace vdb_offset {
namespace {

bool contains(const Polygon& polygon, std::int32_t point) {
  const auto end = polygon.points.begin() + polygon.count;
  return std::find(polygon.points.begin(), end, point) != end;
}

/// The other end of the edge that leads from `point` of the triangle `from` to the triangle `to`.
std::int32_t across(const std::array<Polygon, 6>& faces, std::int32_t point, const Polygon& to) {
  for (const Polygon& face : faces) {
    if (face.count != 4) continue;
    for (std::size_t n = 0; n < 4; ++n) {
      if (face.points[n] != point) continue;
      for (const std::size_t other : {(n + 1) % 4, (n + 3) % 4}) {
        if (contains(to, face.points[other])) return face.points[other];
      }
    }
  }
  return -1;
}

std::int32_t corner_off(const Corners& corners, const Polygon& face) {
  return *std::ranges::find_if(corners, [&](std::int32_t p) { return !contains(face, p); });
}

/// A face's corners, seen from within the cell.
void begin_with(const Polygon& base, LinearCell& cell) {
  cell.count = static_cast<std::size_t>(base.count);
  std::reverse_copy(base.points.begin(), base.points.begin() + base.count, cell.corners.begin());
}

}  // namespace

LinearCell linear_cell(const Corners& corners) {
  const std::array<Polygon, 6> faces = polygons(corners);
  std::array<const Polygon*, 6> triangles{};
  std::array<const Polygon*, 6> quads{};
  std::size_t three = 0;
  std::size_t four = 0;
  for (const Polygon& face : faces) {
    if (!face.has_area()) continue;
    face.count == 3 ? triangles[three++] = &face : quads[four++] = &face;
  }
  LinearCell cell{LinearCell::Kind::Hexahedron, corners, 8};
  if (four == 3 && three == 2) {
    cell.kind = LinearCell::Kind::Prism;
    begin_with(*triangles[0], cell);
    for (std::size_t n = 0; n < 3; ++n) {
      cell.corners[cell.count++] = across(faces, cell.corners[n], *triangles[1]);
    }
  } else if (three == 4 && four <= 1) {
    const Polygon& base = four == 1 ? *quads[0] : *triangles[0];
    cell.kind = four == 1 ? LinearCell::Kind::Pyramid : LinearCell::Kind::Tetrahedron;
    begin_with(base, cell);
    cell.corners[cell.count++] = corner_off(corners, base);
  }
  return cell;
}

}  // namespace vdb_offset
