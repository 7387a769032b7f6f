#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "vdb_offset/core/vec.h"

namespace vdb_offset {

/// A surface as polygons, as STL, OBJ, PLY and OFF files hold it: nothing of it need be true.
struct PolygonMesh {
  Vec3List points_world;
  std::vector<int> corners;             ///< of all faces one after another: points, around each
  std::vector<std::size_t> first{0};    ///< corner that each face begins with, and the end
  std::vector<int> family = {};         ///< of each face in `families`; empty: all are of one
  std::vector<std::string> families{};  ///< solids, groups or objects; empty: no names
  std::string file = {};                ///< that it was read from, for messages; empty: none
  bool counted_from_one = false;        ///< by a file whose format counts points from 0; mended

  std::size_t faces() const { return first.size() - 1; }
  /// The points of a face, around it.
  std::span<const int> face(std::size_t f) const {
    return std::span(corners).subspan(first[f], first[f + 1] - first[f]);
  }
  int family_of(std::size_t f) const { return family.empty() ? 0 : family[f]; }
  /// Adds a face of the last family.
  void add(std::span<const int> points) {
    corners.insert(corners.end(), points.begin(), points.end());
    first.push_back(corners.size());
    if (!families.empty()) family.push_back(static_cast<int>(families.size()) - 1);
  }
};

}  // namespace vdb_offset
