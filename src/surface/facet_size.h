#pragma once

#include <algorithm>
#include <cstddef>

#include "vdb_offset/surface/wall.h"

namespace vdb_offset {

/// A boundary shape's facets may miss what they stand for by this part of their size: 14 degrees an
/// edge.
inline constexpr double kSagitta = 0.03;

/// Longest edge of one triangle; of none (-1) 0.
inline double facet_size(const Wall& shape, int triangle) {
  if (triangle < 0) return 0;
  const TriangleGeometry& g = shape.geometry()[static_cast<std::size_t>(triangle)];
  return std::max({g.ab.norm(), g.ac.norm(), (g.ac - g.ab).norm()});
}

}  // namespace vdb_offset
