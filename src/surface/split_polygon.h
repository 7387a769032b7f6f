#pragma once

#include <array>
#include <span>
#include <vector>

#include "vdb_offset/core/vec.h"

namespace vdb_offset {

/// Whether four corners are not all different, or one of them has 180 degrees or more, seen along
/// the quad's vector area.
bool is_concave_quad(const Vec3List& points, std::span<const int> quad);

/// Appends triangles that make up a polygon, of its sense, to `triangles`; false if no ears could
/// be found to the end, since it crosses itself or has no area. Of m corners, r of them concave, in
/// time m * r.
bool split_polygon(const Vec3List& points, std::span<const int> polygon,
                   std::vector<std::array<int, 3>>& triangles);

}  // namespace vdb_offset
