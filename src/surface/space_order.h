#pragma once

#include <cstdint>
#include <vector>

#include "vdb_offset/core/vec.h"

namespace vdb_offset {

/// Indices of points (fewer than 2^32) in an order that keeps neighbours together: along Morton's
/// curve over 1024^3 cells of the points' box, in a cell by index.
std::vector<std::uint32_t> order_in_space(const Vec3List& points);

}  // namespace vdb_offset
