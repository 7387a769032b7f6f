#pragma once

#include <vector>

#include "vdb_offset/surface/clean_polygons.h"
#include "vdb_offset/surface/polygons.h"

namespace vdb_offset {

/// Fills the report's part on edges, points, parts and area, and turns faces of `mesh` so that
/// neighbours agree. Corners of a face are different points.
void orient_polygons(PolygonMesh& mesh, bool turn_outward, CleanReport& report);

}  // namespace vdb_offset
