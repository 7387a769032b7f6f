#pragma once

#include <array>
#include <cstddef>
#include <string>
#include <vector>

#include "vdb_offset/core/vec.h"

namespace vdb_offset {

/// Where a patch of polygons ends: loops of points that edges join, the first again behind the last
/// of each; -1 between loops.
struct Rim {
  std::vector<int> points;
  std::vector<int> faces;  ///< inside the edge from each point to the next; -1 where there is none
};

/// A four-sided structured surface grid: `ni x nj` points, i fastest; its normal is d/di x d/dj.
///
/// With `nj == 1` it is a curve in a plane z = const (z = 0 where a format has no z): i runs along
/// it, its normal is d/di x z, and so the side that is marched into lies on its right, seen from
/// +z. A closed curve has its first and last point equal bit for bit; given counter-clockwise it
/// is a body in the flow, clockwise the wall round a flow.
///
/// With `faces` it is no grid but a patch of triangles and quads on its points: `ni` is the number
/// of these, `nj` is 0.
struct Patch {
  std::string name;  ///< unique in a surface; "patch 3" where the file gives none (counted from 1)
  std::string family;        ///< the wall family; empty where the file gives none
  int ni = 0;                ///< points along i, at least 2
  int nj = 0;                ///< points along j, at least 2; 1: a curve; 0: polygons
  Vec3List points_world;     ///< ni * nj points; of polygons ni
  std::string file = {};     ///< that it was read from, for messages; empty: none
  std::string part_of = {};  ///< the patch that it was split from; empty: none
  int body = 0;  ///< points of patches of two bodies are kept apart, also where they coincide
  /// Its file does not say which side is out, as of faces of no closed part: if welding makes a
  /// closed surface of such patches alone, `build_surface` turns it outward.
  bool loose = false;
  /// Of polygons: points of each, counter-clockwise seen from its normal's side; the last one twice
  /// where there are three.
  std::vector<std::array<int, 4>> faces = {};
  Rim rim = {};  ///< of polygons, by `build_surface`

  bool is_grid() const { return faces.empty(); }
  std::size_t cells() const {
    return is_grid() ? static_cast<std::size_t>(ni - 1) * static_cast<std::size_t>(nj - 1)
                     : faces.size();
  }

  const Vec3& at(int i, int j) const {
    return points_world[static_cast<std::size_t>(j) * static_cast<std::size_t>(ni) +
                        static_cast<std::size_t>(i)];
  }
  Vec3& at(int i, int j) {
    return points_world[static_cast<std::size_t>(j) * static_cast<std::size_t>(ni) +
                        static_cast<std::size_t>(i)];
  }
};

using Patches = std::vector<Patch>;

/// `visit(corners)`: the points around each cell, as an array of four, counter-clockwise seen from
/// the normal's side.
template <typename Visit>
void for_cells(const Patch& patch, const Visit& visit) {
  for (const std::array<int, 4>& face : patch.faces) visit(face);
  for (int j = 0; j + 1 < patch.nj; ++j) {
    for (int i = 0; i + 1 < patch.ni; ++i) {
      const int n = j * patch.ni + i;
      visit(std::array<int, 4>{n, n + 1, n + patch.ni + 1, n + patch.ni});
    }
  }
}

/// `visit(a, b)`: the points of each edge, once; of polygons when their rim is known.
template <typename Visit>
void for_edges(const Patch& patch, const Visit& visit) {
  for (const std::array<int, 4>& face : patch.faces) {
    for (std::size_t c = 0; c < 4; ++c) {
      if (face[c] < face[(c + 1) % 4]) visit(face[c], face[(c + 1) % 4]);
    }
  }
  for (std::size_t r = 0; r + 1 < patch.rim.points.size(); ++r) {
    const int from = patch.rim.points[r];
    const int to = patch.rim.points[r + 1];
    if (patch.rim.faces[r] >= 0 && from > to) visit(to, from);
  }
  for (int j = 0; j < patch.nj; ++j) {
    for (int i = 0; i < patch.ni; ++i) {
      const int n = j * patch.ni + i;
      if (i + 1 < patch.ni) visit(n, n + 1);
      if (j + 1 < patch.nj) visit(n, n + patch.ni);
    }
  }
}

}  // namespace vdb_offset
