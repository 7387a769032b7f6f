#include "vdb_offset/rasterize/thin_parts.h"

#include <Eigen/Geometry>

#include <array>

#include "core/parallel.h"

namespace vdb_offset {
namespace {

struct Cell {
  Vec3 middle_world;
  Vec3 normal;
};

std::vector<Cell> cells_of(const Patch& patch) {
  std::vector<Cell> cells;
  cells.reserve(patch.cells());
  for_cells(patch, [&](const std::array<int, 4>& corners) {
    const auto at = [&](std::size_t c) -> const Vec3& {
      return patch.points_world[static_cast<std::size_t>(corners[c])];
    };
    const Vec3 middle = corners[2] == corners[3] ? Vec3((at(0) + at(1) + at(2)) / 3)
                                                 : Vec3((at(0) + at(1) + at(2) + at(3)) / 4);
    cells.push_back({middle, (at(2) - at(0)).cross(at(3) - at(1)).normalized()});
  });
  return cells;
}

/// How thick the body is behind a cell; 0 for two voxels and more.
double thickness(const Wall& wall, const Cell& cell, double voxel_world) {
  constexpr double kNearer = 1 - 1e-6;  // than the cell itself is
  constexpr double kParallel = 0.94;    // cosine
  const Vec3 behind = cell.middle_world - voxel_world * cell.normal;
  const WallPoint near = wall.closest(behind, kNearer * voxel_world);
  if (near.triangle < 0) return 0;
  if (wall.triangle_normal(near.triangle).dot(cell.normal) > -kParallel) return 0;
  return std::max((cell.middle_world - near.point_world).dot(cell.normal), 0.0);
}

}  // namespace

std::vector<ThinPart> thin_parts(const Surface& surface, double voxel_world) {
  if (surface.topology.components == 0 || surface.both_sides) return {};
  std::vector<ThinPart> parts;
  for (std::size_t p = 0; p < surface.patches.size() && !surface.is_fan(p); ++p) {
    const Patch& patch = surface.patches[p];
    if (patch.is_grid() && patch.nj < 2) continue;
    const std::vector<Cell> cells = cells_of(patch);
    std::vector<double> thick(cells.size());
    parallel::for_ranges(cells.size(), 256, [&](std::size_t begin, std::size_t end) {
      for (std::size_t c = begin; c < end; ++c) {
        thick[c] = thickness(*surface.wall, cells[c], voxel_world);
      }
    });
    ThinPart part{.patch = static_cast<int>(p)};
    for (std::size_t c = 0; c < cells.size(); ++c) {
      if (thick[c] <= 0) continue;
      if (part.cells == 0 || thick[c] < part.thickness_world) {
        part.thickness_world = thick[c];
        part.place_world = cells[c].middle_world;
      }
      ++part.cells;
    }
    if (part.cells > 0) parts.push_back(part);
  }
  return parts;
}

}  // namespace vdb_offset
