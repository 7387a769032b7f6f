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

/// A quad along the diagonal that ends in one of its points.
std::vector<Polygon> split_at(const Polygon& quad, std::int32_t point) {
  std::array<std::int32_t, 4> p = quad.points;
  std::ranges::rotate(p, std::ranges::find(p, point));
  return {triangle(p[0], p[1], p[2]), triangle(p[0], p[2], p[3])};
}

/// A folded cell whose quads are its level faces: of its columns one alone has a height. Folded,
/// the triangle of the others would lie on the wall and on every level; so it is parted about its
/// hinge.
bool has_one_column(const Corners& corners) {
  const std::array<Polygon, 6> faces = polygons(corners);
  return faces[static_cast<std::size_t>(BlockFace::KMin)].count == 4 &&
         faces[static_cast<std::size_t>(BlockFace::KMax)].count == 4;
}

/// The point of a column of no height; -1: there is none.
std::int32_t flat_column(const Corners& corners) {
  for (std::size_t c = 0; c < 4; ++c) {
    if (corners[c] == corners[c + 4]) return corners[c];
  }
  return -1;
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

/// The corners of one cell, and where they are.
struct PlacedCell {
  Corners corners;
  std::array<Vec3, 8> at;

  PlacedCell(const MultiBlock& mesh, int block, const Place& place, const Corners& points)
      : corners(points) {
    const std::array<int, 4> ring =
        mesh.blocks[static_cast<std::size_t>(block)].stack(place[0], place[1]);
    for (std::size_t c = 0; c < 8; ++c) {
      at[c] = mesh.layers.at(ring[c % 4], place[2] + (c < 4 ? 0 : 1));
    }
  }

  Vec3 of(std::int32_t point) const {
    return at[static_cast<std::size_t>(std::ranges::find(corners, point) - corners.begin())];
  }

  /// Of the corners, each once.
  Vec3 mean() const {
    Vec3 sum = Vec3::Zero();
    double count = 0;
    for (std::size_t c = 0; c < 8; ++c) {
      const auto end = corners.begin() + static_cast<std::ptrdiff_t>(c);
      if (std::find(corners.begin(), end, corners[c]) != end) continue;
      sum += at[c];
      ++count;
    }
    return sum / count;
  }

  InnerFace inner(const Polygon& face) const {
    InnerFace out;
    for (const std::int32_t point : base(face)) out.push_back(of(point));
    return out;
  }
};

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
      (has_one_column(corners) ? corners_ : hinges_)[cell] = *hinge;
    } else {
      parted_[cell] = 0;
    }
  });
}

void CellParts::find_parted() {
  if (hinges_.empty() && parted_.empty() && corners_.empty()) return;
  cells_.for_cells([&](int block, const Place& place) {
    const auto hinge = hinges_.find(cells_.cell(block, place));
    if (hinge == hinges_.end()) return;
    judge_folded(block, place, hinge->second);
    for (std::size_t f = 0; f < 6; ++f) {
      const auto of = static_cast<BlockFace>(f);
      const Polygon quad = polygons(cells_.corners(block, place))[f];
      const std::int32_t beyond = quad.count == 4 ? cells_.beyond(block, place, of) : -1;
      if (beyond >= 0 && !hinges_.contains(beyond)) parted_[beyond] = 0;
    }
  });
  find_coned();
  cells_.for_cells([&](int block, const Place& place) {
    const std::int32_t cell = cells_.cell(block, place);
    if (const auto coned = corners_.find(cell); coned != corners_.end()) {
      const std::vector<InnerFace> faces = faces_off(block, place, coned->second);
      further_ += std::ssize(faces) - 1;
      inverted_ += is_sound(block, place, faces, coned->second) ? 0 : 1;
    } else if (const auto found = parted_.find(cell); found != parted_.end()) {
      found->second = static_cast<std::int32_t>(middles_.size());
      part(block, place);
    }
  });
}

/// Stacks whose cells have a column of no height in one place, and are better parted about that.
void CellParts::find_coned() {
  struct Stack {
    std::int64_t cells = 0;
    std::int64_t gained = 0;
    std::int32_t corner = -1;
    bool is_one = true;
  };
  std::map<std::array<int, 3>, Stack> stacks;
  const auto stack_of = [&](int block, const Place& place) -> Stack& {
    return stacks[{block, place[0], place[1]}];
  };
  const auto for_parted = [&](const auto& visit) {
    cells_.for_cells([&](int block, const Place& place) {
      if (parted_.contains(cells_.cell(block, place))) visit(block, place);
    });
  };
  for_parted([&](int block, const Place& place) {
    Stack& stack = stack_of(block, place);
    const std::int32_t corner = flat_column(cells_.corners(block, place));
    if (stack.cells++ == 0) stack.corner = corner;
    stack.is_one = stack.is_one && corner >= 0 && corner == stack.corner;
    if (!stack.is_one) return;
    const PlacedCell cell(mesh_, block, place, cells_.corners(block, place));
    const std::vector<InnerFace> all = faces_off(block, place, -1);
    const bool has_middle = least_part_about(all, part_middle(all, cell.mean())) > 0;
    const bool has_cone = is_sound(block, place, faces_off(block, place, corner), corner);
    stack.gained += (has_cone ? 1 : 0) - (has_middle ? 1 : 0);
  });
  for_parted([&](int block, const Place& place) {
    const Stack& stack = stack_of(block, place);
    const int levels = mesh_.blocks[static_cast<std::size_t>(block)].nk - 1;
    if (!stack.is_one || stack.cells != levels || stack.gained <= 0) return;
    corners_[cells_.cell(block, place)] = stack.corner;
  });
  for (const auto& [cell, corner] : corners_) parted_.erase(cell);
}

/// The faces that do not have the point.
std::vector<InnerFace> CellParts::faces_off(int block, const Place& place,
                                            std::int32_t point) const {
  const PlacedCell cell(mesh_, block, place, cells_.corners(block, place));
  std::vector<InnerFace> faces;
  for (std::size_t f = 0; f < 6; ++f) {
    for (const Polygon& polygon : face(block, place, static_cast<BlockFace>(f))) {
      if (!contains(polygon, point)) faces.push_back(cell.inner(polygon));
    }
  }
  return faces;
}

bool CellParts::is_sound(int block, const Place& place, const std::vector<InnerFace>& faces,
                         std::int32_t corner) const {
  const PlacedCell cell(mesh_, block, place, cells_.corners(block, place));
  return least_part_about(faces, cell.of(corner)) > 0;
}

void CellParts::judge_folded(int block, const Place& place, std::int32_t hinge) {
  const PlacedCell cell(mesh_, block, place, cells_.corners(block, place));
  const LinearCell element = tetrahedron(cell.corners, hinge);
  const InnerFace base{cell.of(element.corners[0]), cell.of(element.corners[1]),
                       cell.of(element.corners[2])};
  if (!(least_part_about({base}, cell.of(element.corners[3])) > 0)) ++inverted_;
}

void CellParts::part(int block, const Place& place) {
  const PlacedCell cell(mesh_, block, place, cells_.corners(block, place));
  const std::vector<InnerFace> faces = faces_off(block, place, -1);
  const Vec3 middle = part_middle(faces, cell.mean());
  middles_.push_back(middle);
  further_ += std::ssize(faces) - 1;
  if (!(least_part_about(faces, middle) > 0)) ++inverted_;
}

std::vector<Polygon> CellParts::face(int block, const Place& place, BlockFace of) const {
  const Polygon whole = polygons(cells_.corners(block, place))[static_cast<std::size_t>(of)];
  if (!whole.has_area()) return {};
  if (whole.count != 4) return {whole};
  if (const auto coned = corners_.find(cells_.cell(block, place)); coned != corners_.end()) {
    if (contains(whole, coned->second)) return split_at(whole, coned->second);
  }
  if (hinges_.empty()) return {whole};
  auto folded = hinges_.find(cells_.cell(block, place));
  if (folded == hinges_.end()) folded = hinges_.find(cells_.beyond(block, place, of));
  if (folded == hinges_.end()) return {whole};
  const auto [at_hinge, off_it] = split(whole, folded->second);
  return {at_hinge, off_it};
}

void CellParts::put(int block, const Place& place, const Emit& emit) const {
  const Corners corners = cells_.corners(block, place);
  const std::int32_t cell = cells_.cell(block, place);
  const auto parted = parted_.find(cell);
  const auto coned = corners_.find(cell);
  if (parted != parted_.end() || coned != corners_.end()) {
    const std::int32_t apex =
        coned != corners_.end() ? coned->second : cells_.points() + parted->second;
    for (std::size_t f = 0; f < 6; ++f) {
      for (const Polygon& polygon : face(block, place, static_cast<BlockFace>(f))) {
        if (contains(polygon, apex)) continue;
        std::vector<std::int32_t> points = base(polygon);
        points.push_back(apex);
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
