#include "blocks/cell_row.h"

#include <cmath>
#include <cstring>
#include <utility>

namespace vdb_offset {

using namespace hexahedron;

namespace {

using Line = CellRow::Line;

VDB_OFFSET_INLINE void move(const Line& line, std::size_t k, Pack& values) {
  std::memcpy(&values, line.data() + k, sizeof(values));
}
VDB_OFFSET_INLINE void move(Line& line, std::size_t k, const Pack& values) {
  std::memcpy(line.data() + k, &values, sizeof(values));
}

// Lines to packs or back, from position k on: Lines may be const, or Packs.
template <typename Lines, typename Packs>
VDB_OFFSET_INLINE void move_triple(Lines& lines, std::size_t k, Packs& packs) {
  move(lines.x, k, packs.x);
  move(lines.y, k, packs.y);
  move(lines.z, k, packs.z);
}

template <typename Lines, typename Packs>
VDB_OFFSET_INLINE void move_edge(Lines& lines, std::size_t k, Packs& packs) {
  move_triple(lines.along, k, packs.along);
  move(lines.length2, k, packs.length2);
  move(lines.inverse, k, packs.inverse);
}

template <typename Lines, typename Packs>
VDB_OFFSET_INLINE void move_face(Lines& lines, std::size_t k, Packs& packs) {
  for (std::size_t n = 0; n < 4; ++n) {
    move_triple(lines.area[n], k, packs.area[n]);
    move(lines.inverse[n], k, packs.inverse[n]);
  }
  move_triple(lines.sum_x, k, packs.sum_x);
  move_triple(lines.sum_y, k, packs.sum_y);
  move(lines.shortest2, k, packs.shortest2);
  move(lines.longest2, k, packs.longest2);
}

VDB_OFFSET_INLINE Triple<Pack> point_at(const Triple<Line>& lines, std::size_t k) {
  Triple<Pack> point;
  move_triple(lines, k, point);
  return point;
}

VDB_OFFSET_INLINE CellEdge<Pack> edge_at(const CellEdge<Line>& lines, std::size_t k) {
  CellEdge<Pack> packs;
  move_edge(lines, k, packs);
  return packs;
}

/// The edges of a side whose points are there, and how its columns grow.
VDB_OFFSET_CLONES void measure_side(CellRow::Side& side, std::size_t count) {
  for (std::size_t k = 0; k <= count; k += kPack) {
    const CellEdge<Pack> across = edge(point_at(side.point[0], k), point_at(side.point[1], k));
    move_edge(side.across, k, across);
  }
  std::array<std::array<double, CellRow::kStack + 1>, 2> height2;
  for (std::size_t c = 0; c < 2; ++c) {
    for (std::size_t k = 0; k < count; k += kPack) {
      const CellEdge<Pack> up = edge(point_at(side.point[c], k), point_at(side.point[c], k + 1));
      move_edge(side.up[c], k, up);
      std::memcpy(height2[c].data() + k + 1, &up.length2, sizeof(Pack));
    }
    height2[c][0] = side.below2[c];
  }
  for (std::size_t k = 0; k < count; k += kPack) {
    Pack growth2{};
    for (std::size_t c = 0; c < 2; ++c) {
      Pack below;
      Pack here;
      std::memcpy(&below, height2[c].data() + k, sizeof(below));
      std::memcpy(&here, height2[c].data() + k + 1, sizeof(here));
      const Pack ratio = here / below;
      growth2 = greatest(growth2, Pack(below > Pack{} ? ratio : Pack{}));
    }
    move(side.growth2, k, std::as_const(growth2));
  }
}

using Sides = std::array<const CellRow::Side*, 2>;  // at i and at i + 1

VDB_OFFSET_INLINE void measure_faces(const Sides& sides, std::size_t count,
                                     LevelFace<Line>& faces) {
  for (std::size_t k = 0; k <= count; k += kPack) {
    const LevelFace<Pack> face =
        level_face<Pack>({edge(point_at(sides[0]->point[0], k), point_at(sides[1]->point[0], k)),
                          edge(point_at(sides[0]->point[1], k), point_at(sides[1]->point[1], k))},
                         {edge_at(sides[0]->across, k), edge_at(sides[1]->across, k)});
    move_face(faces, k, face);
  }
}

VDB_OFFSET_CLONES void measure_stack(const Sides& sides, std::size_t count, LevelFace<Line>& faces,
                                     CellRow::Stack& stack) {
  measure_faces(sides, count, faces);
  const LevelFace<Line>& levels = faces;
  for (std::size_t k = 0; k < count; k += kPack) {
    Cell<Pack> cell;
    move_face(levels, k, cell.below);
    move_face(levels, k + 1, cell.above);
    for (std::size_t n = 0; n < 4; ++n) {
      const CellRow::Side& side = *sides[n & 1U];
      cell.column[n] = edge_at(side.up[n >> 1U], k);
      cell.corner[n] = point_at(side.point[n >> 1U], k);
      cell.corner[n + 4] = point_at(side.point[n >> 1U], k + 1);
    }
    const Measures<Pack> m = measure(cell);
    Pack left;
    Pack right;
    move(sides[0]->growth2, k, left);
    move(sides[1]->growth2, k, right);
    move(stack.scaled_jacobian, k, m.scaled_jacobian);
    move(stack.min_jacobian, k, m.min_jacobian);
    move(stack.least_part, k, m.least_part);
    move(stack.volume, k, m.volume);
    move(stack.skewness, k, m.skewness);
    move(stack.aspect2, k, m.aspect2);
    move(stack.orthogonality, k, m.orthogonality);
    move(stack.growth2, k, greatest(left, right));
    move(stack.sound, k, m.sound);
  }
}

}  // namespace

void CellRow::load_side(const std::array<int, 2>& columns, Side& side) const {
  for (std::size_t c = 0; c < 2; ++c) {
    const Vec3* const points = &mesh_.layers.at(columns[c], first_);
    Triple<Line>& lines = side.point[c];
    for (std::size_t k = 0; k <= count_; ++k) {
      lines.x[k] = points[k].x();
      lines.y[k] = points[k].y();
      lines.z[k] = points[k].z();
    }
    double below2 = 0;
    if (first_ > 0) {
      const Triple<double> up{points[0].x() - points[-1].x(), points[0].y() - points[-1].y(),
                              points[0].z() - points[-1].z()};
      below2 = dot(up, up);
    }
    side.below2[c] = below2;
  }
  measure_side(side, count_);
}

void CellRow::turn_to(std::array<int, 2> stack, int first, int count) {
  i_ = stack[0];
  j_ = stack[1];
  first_ = first;
  count_ = static_cast<std::size_t>(count);
  if (!block_.is_grid()) return;
  load_side({block_.column(i_, j_), block_.column(i_, j_ + 1)},
            sides_[static_cast<std::size_t>(i_) % 2]);
}

const CellRow::Stack& CellRow::next() {
  const std::array<int, 4> ring = block_.stack(i_, j_);
  Side& left = sides_[static_cast<std::size_t>(i_) % 2];
  ++i_;
  Side& right = sides_[static_cast<std::size_t>(i_) % 2];
  if (!block_.is_grid()) load_side({ring[0], ring[3]}, left);
  load_side({ring[1], ring[2]}, right);
  measure_stack({&left, &right}, count_, faces_, stack_);
  judge_unsound({&left, &right});
  return stack_;
}

/// Cells with collapsed edges, or of numbers that are not finite, have to be looked at one by one.
void CellRow::judge_unsound(const std::array<const Side*, 2>& sides) {
  for (std::size_t k = 0; k < count_; ++k) {
    if (stack_.sound[k] > 0) continue;
    std::array<Triple<double>, 8> corners;
    for (std::size_t n = 0; n < 8; ++n) {
      const Triple<Line>& lines = sides[n & 1U]->point[n >> 1U & 1U];
      const std::size_t level = k + (n >> 2U);
      corners[n] = {lines.x[level], lines.y[level], lines.z[level]};
    }
    const Measures<double> m = measure_cell(corners);
    stack_.scaled_jacobian[k] = m.scaled_jacobian;
    stack_.min_jacobian[k] = m.min_jacobian;
    stack_.least_part[k] = m.least_part;
    stack_.volume[k] = m.volume;
    stack_.skewness[k] = m.skewness;
    stack_.aspect2[k] = m.aspect2;
    stack_.orthogonality[k] = m.orthogonality;
  }
}

}  // namespace vdb_offset
