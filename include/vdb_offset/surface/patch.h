#pragma once

#include <array>
#include <string>
#include <vector>

#include "vdb_offset/core/vec.h"

namespace vdb_offset {

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
  /// Of polygons: points of each, counter-clockwise seen from its normal's side; -1 last where
  /// there are three.
  std::vector<std::array<int, 4>> faces = {};

  bool is_grid() const { return faces.empty(); }

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

}  // namespace vdb_offset
