#include "io/cell_parts.h"

#include <algorithm>
#include <array>

namespace vdb_offset {
namespace {

using Place = CellMesh::Place;

/// The element that a cell is; nothing if it is none.
std::optional<LinearCell> element_of(const Corners& corners) {
  const LinearCell cell = linear_cell(corners);
  if (cell.kind != LinearCell::Kind::Hexahedron) return cell;
  const std::array<Polygon, 6> faces = polygons(corners);
  const bool is_whole =
      std::ranges::all_of(faces, [](const Polygon& face) { return face.count == 4; });
  return is_whole ? std::optional(cell) : std::nullopt;
}

bool contains(const Polygon& polygon, std::int32_t point) {
  const auto end = polygon.points.begin() + polygon.count;
  return std::find(polygon.points.begin(), end, point) != end;
}

std::array<std::size_t, 5> count_faces(const std::array<Polygon, 6>& faces) {
  std::array<std::size_t, 5> counts{};
  for (const Polygon& face : faces) ++counts[static_cast<std::size_t>(face.count)];
  return counts;
}

/// The point of a folded cell that is on its quads alone; nothing if it is no such cell.
std::optional<std::int32_t> hinge_of(const Corners& corners) {
  const std::array<Polygon, 6> faces = polygons(corners);
  const std::array<std::size_t, 5> counts = count_faces(faces);
  if (counts[3] != 2 || counts[4] != 2) return {};
  for (const std::int32_t point : corners) {
    const bool is_hinge = std::ranges::all_of(faces, [&](const Polygon& face) {
      return face.count < 3 || contains(face, point) == (face.count == 4);
    });
    if (is_hinge) return point;
  }
  return {};
}

/// The face, seen from within.
std::vector<std::int32_t> base(const Polygon& face) {
  return {face.points.rend() - face.count, face.points.rend()};
}

Polygon triangle(std::int32_t a, std::int32_t b, std::int32_t c) { return {{a, b, c, -1}, 3}; }

/// A quad along the diagonal that does not end in the hinge: at the hinge, and off it.
std::array<Polygon, 2> split(const Polygon& quad, std::int32_t hinge) {
  std::array<std::int32_t, 4> p = quad.points;
  std::ranges::rotate(p, std::ranges::find(p, hinge));
  return {triangle(p[0], p[1], p[3]), triangle(p[1], p[2], p[3])};
}

/// Of a folded cell, which is all but the corner at its hinge.
LinearCell tetrahedron(const Corners& corners, std::int32_t hinge) {
  const std::array<Polygon, 6> faces = polygons(corners);
  const Polygon& one =
      *std::ranges::find_if(faces, [](const Polygon& face) { return face.count == 3; });
  LinearCell cell{LinearCell::Kind::Tetrahedron, {}, 4};
  std::ranges::copy(base(one), cell.corners.begin());
  cell.corners[3] = *std::ranges::find_if(
      corners, [&](std::int32_t p) { return p != hinge && !contains(one, p); });
  return cell;
}

/// The mean of the corners, each once.
Vec3 middle(const MultiBlock& mesh, int block, const Place& place, const Corners& corners) {
  const std::array<int, 4> ring =
      mesh.blocks[static_cast<std::size_t>(block)].stack(place[0], place[1]);
  Vec3 sum = Vec3::Zero();
  double count = 0;
  for (std::size_t c = 0; c < 8; ++c) {
    if (std::find(corners.begin(), corners.begin() + c, corners[c]) != corners.begin() + c) {
      continue;
    }
    sum += mesh.layers.at(ring[c % 4], place[2] + (c < 4 ? 0 : 1));
    ++count;
  }
  return sum / count;
}

}  // namespace

CellParts::CellParts(const MultiBlock& mesh, const CellMesh& cells) : mesh_(mesh), cells_(cells) {
  find_folded();
  find_parted();
}

void CellParts::find_folded() {
  cells_.for_cells([&](int block, const Place& place) {
    const Corners corners = cells_.corners(block, place);
    if (element_of(corners)) return;
    const std::int32_t cell = cells_.cell(block, place);
    if (const auto hinge = hinge_of(corners)) {
      hinges_[cell] = *hinge;
    } else {
      parted_[cell] = 0;
    }
  });
}

void CellParts::find_parted() {
  if (hinges_.empty() && parted_.empty()) return;
  cells_.for_cells([&](int block, const Place& place) {
    if (!hinges_.contains(cells_.cell(block, place))) return;
    for (std::size_t f = 0; f < 6; ++f) {
      const auto of = static_cast<BlockFace>(f);
      const Polygon quad = polygons(cells_.corners(block, place))[f];
      const std::int32_t beyond = quad.count == 4 ? cells_.beyond(block, place, of) : -1;
      if (beyond >= 0 && !hinges_.contains(beyond)) parted_[beyond] = 0;
    }
  });
  cells_.for_cells([&](int block, const Place& place) {
    const auto found = parted_.find(cells_.cell(block, place));
    if (found == parted_.end()) return;
    found->second = static_cast<std::int32_t>(middles_.size());
    middles_.push_back(middle(mesh_, block, place, cells_.corners(block, place)));
    further_ -= 1;
    for (std::size_t f = 0; f < 6; ++f) {
      further_ += std::ssize(face(block, place, static_cast<BlockFace>(f)));
    }
  });
}

std::vector<Polygon> CellParts::face(int block, const Place& place, BlockFace of) const {
  const Polygon whole = polygons(cells_.corners(block, place))[static_cast<std::size_t>(of)];
  if (!whole.has_area()) return {};
  if (whole.count != 4 || hinges_.empty()) return {whole};
  auto folded = hinges_.find(cells_.cell(block, place));
  if (folded == hinges_.end()) folded = hinges_.find(cells_.beyond(block, place, of));
  if (folded == hinges_.end()) return {whole};
  const auto [at_hinge, off_it] = split(whole, folded->second);
  return {at_hinge, off_it};
}

void CellParts::put(int block, const Place& place, const Emit& emit) const {
  const Corners corners = cells_.corners(block, place);
  const std::int32_t cell = cells_.cell(block, place);
  if (const auto part = parted_.find(cell); part != parted_.end()) {
    for (std::size_t f = 0; f < 6; ++f) {
      for (const Polygon& polygon : face(block, place, static_cast<BlockFace>(f))) {
        std::vector<std::int32_t> points = base(polygon);
        points.push_back(cells_.points() + part->second);
        emit(polygon.count == 4 ? LinearCell::Kind::Pyramid : LinearCell::Kind::Tetrahedron,
             points);
      }
    }
    return;
  }
  const auto folded = hinges_.find(cell);
  const LinearCell element =
      folded == hinges_.end() ? linear_cell(corners) : tetrahedron(corners, folded->second);
  emit(element.kind, element.points());
}

}  // namespace vdb_offset
