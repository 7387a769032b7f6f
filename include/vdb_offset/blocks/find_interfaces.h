#pragma once

#include "vdb_offset/blocks/zone_mesh.h"

namespace vdb_offset {

/// Add the interfaces of a mesh whose file says where boundaries are, but not what zones are to
/// each other: faces of two cells with the same four points, bit for bit, in rectangles.
///
/// In     ranges of `mesh.boundary_faces` lie on faces of their zones.
/// Out    Faces that two boundaries, or more than two cells, share are left alone. Where faces of a
///        boundary all have a cell in no boundary on their other side, it is an internal surface,
///        and becomes an interface of its name.
/// Cost   200 bytes a face of a cell on zones' surfaces, and some microseconds.
void find_interfaces(ZoneMesh& mesh);

}  // namespace vdb_offset
