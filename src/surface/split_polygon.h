#pragma once

#include <array>
#include <cstddef>
#include <optional>
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

/// The first of a polygon's edges, counted from that between its first two corners, that another
/// one crosses, seen along its vector area (where there is little of that, along the normal of its
/// sharpest corner); nothing for those of more than kMostCrossed corners, which are not looked at.
std::optional<std::size_t> crossed_edge(const Vec3List& points, std::span<const int> polygon);

constexpr std::size_t kMostCrossed = 64;

}  // namespace vdb_offset
