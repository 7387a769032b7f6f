#pragma once

#include <vector>

#include "vdb_offset/surface/clean_polygons.h"
#include "vdb_offset/surface/polygons.h"

namespace vdb_offset {

/// Flips the longest edge of triangles that are no higher than 1e-6 of it, such as those that close
/// T-junctions, with the face across: its corner that lies on that edge becomes one of that face's
/// pieces, and the surface stays as it is. Counted in the report; so are those left, whose longest
/// edge is not one of two faces, where the other diagonal is an edge already, or makes another such
/// triangle with an edge as long.
///
/// In       triangles and quads alone; `numbers`: of each face, those of pieces become that of the
///          face across.
void flip_flat_triangles(PolygonMesh& mesh, std::vector<int>& numbers, CleanReport& report);

}  // namespace vdb_offset
