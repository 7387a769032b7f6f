#pragma once

#include <vector>

#include "vdb_offset/surface/overlaps.h"

namespace vdb_offset {

/// The same for the closed curves of a flat surface, by their winding numbers in the plane.
/// Cost  the edges that lie in another curve's box times those of all.
std::vector<Overlap> find_flat_overlaps(const Surface& surface);

}  // namespace vdb_offset
