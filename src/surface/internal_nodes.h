#pragma once

#include <string>

#include "surface/find_boundaries.h"

namespace vdb_offset {

/// An internal surface, and its number among the boundaries.
struct InternalShape {
  const std::string& name;
  const Wall& shape;
  int boundary;
};

/// Marks the nodes that an internal surface meets the wall at: both ends of the edges of the wall's
/// cells within kOnShape of its facets, of a cell's shortest side, unless the surface goes on over
/// a cell beside: there it runs along the wall, and the wall stays as it is. Throws InputError
/// where it lies on the wall: columns there would have no height.
void mark_internal_nodes(const OpenSurface& surface, const InternalShape& internal, Ends& ends);

/// Throws InputError if a boundary surface lies on cells of the wall, as the wall itself does.
void refuse_on_wall(const OpenSurface& surface, const std::string& name, const Wall& shape);

}  // namespace vdb_offset
