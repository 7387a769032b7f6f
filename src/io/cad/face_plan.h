#pragma once

#include <vector>

#include "io/cad/face_sides.h"

namespace vdb_offset::cad {

/// What a face becomes.
enum class Shape {
  Quad,      ///< four sides: one patch
  Wedge,     ///< three, of which the second is short: one patch, the corner across is a point
  Ring,      ///< two loops, without corners: one patch, cut from one to the other
  Midpoint,  ///< three or five sides: as many patches about a point
  Disc,      ///< a loop of two corners or less: five patches
  Triangles
};

struct Plan {
  Shape shape = Shape::Triangles;
  std::vector<Side> sides;  ///< around the face; of a ring the outer and the inner loop
  int pole_cells = 1;       ///< between two poles across from each other
};

/// By the loops and how they turn.
Plan plan_face(const Face& face, const SharedEdges& edges);

/// Raises cells of edges to what lines across the faces ask for, and until sides across from each
/// other have as many and others sum up as their shape needs. Faces for which that has no end
/// become triangles.
void settle_cells(const std::vector<Face>& faces, std::vector<Plan>& plans, SharedEdges& edges,
                  const CadOptions& options);

/// Of side `k` of a midpoint subdivision, the cells before the point that it is cut at.
int cells_before_cut(const Plan& plan, std::size_t k, const SharedEdges& edges);

}  // namespace vdb_offset::cad
