#pragma once

#include "io/cad/face_sides.h"
#include "vdb_offset/surface/patch.h"

namespace vdb_offset::cad {

/// A face of any loops as triangles: a constrained Delaunay triangulation in its plane of the nodes
/// of its edges and of points between them. Nothing where the loops do not bound an area.
Patch triangles_of(const Face& face, const SharedEdges& edges, const CadOptions& options);

}  // namespace vdb_offset::cad
