#pragma once

// Surfaces of triangles and quads.

#include <array>
#include <cmath>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "vdb_offset/surface/patch.h"

namespace vdb_offset::test {

/// The same cells as polygons.
inline Patch as_polygons(const Patch& grid) {
  Patch patch;
  patch.name = grid.name;
  patch.family = grid.family;
  patch.points_world = grid.points_world;
  for_cells(grid, [&](const std::array<int, 4>& corners) { patch.faces.push_back(corners); });
  patch.ni = static_cast<int>(patch.points_world.size());
  return patch;
}

inline Patches as_polygons(const Patches& grids) {
  Patches patches;
  for (const Patch& grid : grids) patches.push_back(as_polygons(grid));
  return patches;
}

/// Every quad cut into two triangles.
inline Patch as_triangles(const Patch& grid) {
  Patch patch = as_polygons(grid);
  std::vector<std::array<int, 4>> triangles;
  for (const auto& [a, b, c, d] : patch.faces) {
    triangles.push_back({a, b, c, c});
    triangles.push_back({a, c, d, d});
  }
  patch.faces = std::move(triangles);
  return patch;
}

/// An icosahedron, each triangle cut into four `times` times, on the unit sphere.
inline Patch icosphere(int times) {
  const double g = (1 + std::sqrt(5.0)) / 2;
  Patch patch;
  patch.name = "icosphere";
  patch.points_world = {{-1, g, 0},  {1, g, 0},  {-1, -g, 0}, {1, -g, 0}, {0, -1, g},  {0, 1, g},
                        {0, -1, -g}, {0, 1, -g}, {g, 0, -1},  {g, 0, 1},  {-g, 0, -1}, {-g, 0, 1}};
  for (Vec3& p : patch.points_world) p.normalize();
  patch.faces = {{0, 11, 5, 5}, {0, 5, 1, 1},   {0, 1, 7, 7},   {0, 7, 10, 10}, {0, 10, 11, 11},
                 {1, 5, 9, 9},  {5, 11, 4, 4},  {11, 10, 2, 2}, {10, 7, 6, 6},  {7, 1, 8, 8},
                 {3, 9, 4, 4},  {3, 4, 2, 2},   {3, 2, 6, 6},   {3, 6, 8, 8},   {3, 8, 9, 9},
                 {4, 9, 5, 5},  {2, 4, 11, 11}, {6, 2, 10, 10}, {8, 6, 7, 7},   {9, 8, 1, 1}};
  for (int n = 0; n < times; ++n) {
    std::map<std::pair<int, int>, int> middles;
    const auto middle = [&](int a, int b) {
      const auto [found, is_new] =
          middles.try_emplace(std::minmax(a, b), patch.points_world.size());
      if (is_new) {
        const Vec3 sum = patch.points_world[static_cast<std::size_t>(a)] +
                         patch.points_world[static_cast<std::size_t>(b)];
        patch.points_world.push_back(sum.normalized());
      }
      return found->second;
    };
    std::vector<std::array<int, 4>> finer;
    for (const auto& [a, b, c, again] : patch.faces) {
      const int ab = middle(a, b);
      const int bc = middle(b, c);
      const int ca = middle(c, a);
      finer.insert(finer.end(),
                   {{a, ab, ca, ca}, {ab, b, bc, bc}, {ca, bc, c, c}, {ab, bc, ca, ca}});
    }
    patch.faces = std::move(finer);
  }
  patch.ni = static_cast<int>(patch.points_world.size());
  return patch;
}

}  // namespace vdb_offset::test
