#pragma once

#include "vdb_offset/surface/surface.h"

namespace vdb_offset {

/// Whether a surface has an inside: it is closed, or in two dimensions made of closed curves.
inline bool has_inside(const Surface& surface) {
  return surface.closed || (surface.flat && surface.free_edges() == 0);
}

}  // namespace vdb_offset
