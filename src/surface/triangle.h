#pragma once

#include "vdb_offset/core/vec.h"
#include "vdb_offset/surface/wall.h"

namespace vdb_offset {

/// What of a triangle (a, b, c) a nearest point lies on.
enum class Feature { Face, VertexA, VertexB, VertexC, EdgeAB, EdgeBC, EdgeCA };

struct TrianglePoint {
  Vec3 point_world;
  Feature feature;
};

/// Twice the area, along the normal: exact in direction also for needles. Zero where the width is
/// nothing but rounding; such a triangle never has its nearest point on the face.
Vec3 doubled_area(const TriangleGeometry& t);

/// Nearest point of a triangle to `p`, exact to the rounding of its corners and 1e-14 of the
/// distance, also for needles and triangles of zero area.
/// Ericson, Real-time collision detection, 2005, section 5.1.5 (Voronoi regions of the features).
TrianglePoint closest_on_triangle(const TriangleGeometry& t, const Vec3& p);

}  // namespace vdb_offset
