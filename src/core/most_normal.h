#pragma once

#include "vdb_offset/core/vec.h"

namespace vdb_offset {

/// A direction, and the least of its cosines to some normals.
struct Visible {
  Vec3 direction;
  double least_cosine;
};

double least_cosine(const Vec3& direction, const Vec3List& normals);

/// The direction that sees all cells at a node best: of the largest least cosine to their normals,
/// to a hundredth; above 0 whenever one is that sees all of them (of 200 at most).
/// In  unit normals, at least one; a direction to begin with.
Visible most_normal(const Vec3List& normals, const Vec3& start);

}  // namespace vdb_offset
