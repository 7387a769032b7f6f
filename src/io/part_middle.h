#pragma once

#include <vector>

#include "vdb_offset/core/vec.h"

namespace vdb_offset {

/// A face of a cell, corners counter-clockwise seen from within: three or four.
using InnerFace = std::vector<Vec3>;

/// Six times the least volume that the faces have with `apex`: of a triangle its tetrahedron, of a
/// quad the tetrahedra at its four corners, which are the corner Jacobians of the pyramid.
double least_part_about(const std::vector<InnerFace>& faces, const Vec3& apex);

/// Where a cell is to be parted: at `mean` if all parts are positive there, else where the nearest
/// of the planes of the faces' corners is farthest within.
///
/// That is linear programming in four unknowns of at most 24 rules; its best point is where four
/// of them are equal, and they are all tried.
Vec3 part_middle(const std::vector<InnerFace>& faces, const Vec3& mean);

}  // namespace vdb_offset
