#pragma once

#include <Eigen/Geometry>

#include "vdb_offset/core/vec.h"

namespace vdb_offset {

/// How an edge leaves a corner of a face that is not its own.
enum class CornerTouch { Apart, AlongSide, OnFace };

/// Of a way from the corner, and those to the next corner and to the one before.
inline CornerTouch corner_touch(const Vec3& way, const Vec3& next, const Vec3& previous) {
  constexpr double kNear = 1e-3;  // radians
  const Vec3 d = way.normalized();
  const Vec3 a = next.normalized();
  const Vec3 b = previous.normalized();
  for (const Vec3& side : {a, b}) {
    if (d.dot(side) > 0 && d.cross(side).norm() < kNear) return CornerTouch::AlongSide;
  }
  const Vec3 normal = a.cross(b).normalized();
  const bool is_between = a.cross(d).dot(normal) > 0 && d.cross(b).dot(normal) > 0;
  const bool is_on = std::abs(d.dot(normal)) < kNear && is_between && d.dot(a + b) > 0;
  return is_on ? CornerTouch::OnFace : CornerTouch::Apart;
}

/// What to do where an edge has three faces.
inline constexpr const char* kStandsThere =
    "where a part stands on another, take it away, or give it a thickness and unite them";

}  // namespace vdb_offset
