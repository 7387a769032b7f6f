#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <limits>
#include <vector>

#include "blocks/window.h"
#include "vdb_offset/blocks/quality.h"
#include "vdb_offset/core/vec.h"

namespace vdb_offset {

/// The worst of the cells over one face.
struct FaceState {
  bool positive = true;
  double scaled_jacobian = 1;
};

/// The cell of a face between two levels, in VTK's order; where three columns meet the last is
/// there twice. `point(column, level)`.
template <typename Point>
std::array<Vec3, 8> cell_of(const ColumnFace& face, std::size_t layer, const Point& point) {
  std::array<Vec3, 8> corners;
  for (std::size_t c = 0; c < 4; ++c) {
    const int column = face.column[std::min(c, face.count - 1)];
    corners[c] = point(column, layer);
    corners[c + 4] = point(column, layer + 1);
  }
  return corners;
}

template <typename Point>
FaceState judge_face(const ColumnFace& face, std::size_t layers, const Point& point) {
  FaceState state;
  for (std::size_t k = 0; k < layers; ++k) {
    const CellQuality quality = cell_quality(cell_of(face, k, point));
    state.positive = state.positive && quality.positive;
    state.scaled_jacobian = std::min(state.scaled_jacobian, quality.scaled_jacobian);
  }
  return state;
}

/// Scaled Jacobian of a face's corners where columns leave the wall: what the wall's own angles
/// leave to its cells. Of a fan's faces, which are lines or points there, that of the first cell.
template <typename Point>
double wall_quality(const ColumnFace& face, const Point& point) {
  double least = 1;
  for (std::size_t c = 0; c < face.count; ++c) {
    const Vec3 own = point(face.column[c], 0);
    if (point(face.next(c), 0) == own) {
      return std::max(0.0, cell_quality(cell_of(face, 0, point)).scaled_jacobian);
    }
    const Vec3 a = (point(face.next(c), 0) - own).normalized();
    const Vec3 b = (point(face.previous(c), 0) - own).normalized();
    const Vec3 up = (point(face.column[c], 1) - own).normalized();
    least = std::min(least, a.x() * (b.y() * up.z() - b.z() * up.y()) +
                                a.y() * (b.z() * up.x() - b.x() * up.z()) +
                                a.z() * (b.x() * up.y() - b.y() * up.x()));
  }
  return least;
}

/// Part of the wall's own quality that the cells over it have to keep.
inline constexpr double kOfWall = 0.7;

/// Scaled Jacobian that the cells over a face have to have where `quality` is asked for.
template <typename Point>
double wanted_quality(const ColumnFace& face, double quality, const Point& point) {
  return std::min(quality, kOfWall * wall_quality(face, point));
}

inline bool is_good(const CellQuality& cell, double least_quality) {
  return cell.positive && cell.scaled_jacobian >= least_quality;
}

/// Least area of a face's corners at a level over that on the wall, by their cross products along
/// the wall's; below 0 where columns have crossed.
template <typename Point>
double spread(const ColumnFace& face, std::size_t level, const Point& point) {
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t c = 0; c < face.count; ++c) {
    const auto area = [&](std::size_t k) {
      const Vec3 own = point(face.column[c], k);
      const Vec3 a = point(face.next(c), k) - own;
      const Vec3 b = point(face.previous(c), k) - own;
      return Vec3(a.y() * b.z() - a.z() * b.y(), a.z() * b.x() - a.x() * b.z(),
                  a.x() * b.y() - a.y() * b.x());
    };
    const Vec3 wall = area(0);
    const double wall2 = wall.squaredNorm();
    if (wall2 > 0) least = std::min(least, area(level).dot(wall) / wall2);
  }
  return least;
}

}  // namespace vdb_offset
