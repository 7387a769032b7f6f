// Columns that need no marching. The distance to a wall rises no faster than the way that is gone,
// so where it equals the length of a straight line at the line's end it does so all along: the line
// is a gradient line of the true distance, with the node as foot. It meets no other front on the
// way.
//
// Off a convex node there is a cone of such lines. The one is taken that ends about where the
// field's column would, so that neighbours fit together, straight or not.

#include <algorithm>

#include "march/column.h"
#include "vdb_offset/rasterize/rasterize.h"

namespace vdb_offset {

namespace {

// Part of the way to the next nodes by which a straight column may differ from the field's, and the
// voxels between two looks at that.
constexpr double kStraying = 0.125;
constexpr double kStride = 3;
constexpr double kSteep = 0.5;  // cosine to the line at which the field's column is no longer that
constexpr double kExactly = 1e-12;  // of a length: rounding of distances

/// Whether a column that is off its place by so much crowds one beside it. Along the edge to that
/// alone it counts: how fine the wall is across does not matter.
bool strays(const ColumnStart& start, const Vec3& off) {
  return std::any_of(start.edges.begin(), start.edges.end(), [&](const Vec3& edge) {
    return !(std::abs(off.dot(edge)) <= kStraying * edge.squaredNorm());
  });
}

}  // namespace

/// The way to the end of the field's column, in few looks at it: unit; zero where a straight line
/// between its ends would leave it by so much that it crowds columns beside it that follow the
/// field.
Vec3 ColumnTracer::chord(const ColumnStart& start) {
  const double stride = kStride * voxel_world_;
  const double straight = kSeedReachVoxels * voxel_world_;
  off_.clear();
  Vec3 off = Vec3::Zero();
  for (double s = straight; s < distance_world_; s += stride) {
    off_.push_back({s, off});
    const double length = std::min(stride, distance_world_ - s);
    const Vec3 ahead = off_.size() < 2 ? off : Vec3(1.5 * off - 0.5 * off_[off_.size() - 2].off);
    const FieldSample sample =
        sampler_.at(start.point_world + (s + 0.5 * length) * start.direction + ahead);
    const double along = start.side * sample.gradient.dot(start.direction);
    if (!sample.inside || !(along > kSteep * sample.gradient.norm())) return Vec3::Zero();
    off += length * (start.side / along * sample.gradient - start.direction);
  }
  for (const auto& at : off_) {
    const Vec3 bend = at.off - (at.s_world / distance_world_) * off;
    if (strays(start, bend)) return Vec3::Zero();
  }
  return (distance_world_ * start.direction + off).normalized();
}

/// Whether a straight line from a convex node is the column, and a gradient line of the true
/// distance: that holds if the distance is the length at its end, since it rises no faster. Then no
/// wall is met on the way either, nor within the margin beyond the distance.
bool ColumnTracer::goes_straight(const ColumnStart& start, ColumnPath& path) {
  const double length = distance_world_ / (1 - gap_margin_) * (1 + 1e-9);
  const auto end = [&](const Vec3& direction) {
    return Vec3(start.point_world + length * direction);
  };
  const auto is_own = [&](const Vec3& direction) {
    return search_.distance_own(end(direction)) >= length * (1 - kExactly);
  };
  // A fan's column has a direction of its own, which the field's column does not end in.
  if (!may_be_straight_ || start.in_fan) return false;
  side_ = start.side;
  search_.begin(start.triangles);
  if (!is_own(start.direction)) return false;
  Vec3 direction = lean_.isZero(0) ? chord(start) : start.direction;
  if (direction.isZero()) return false;
  direction = steer(start.point_world, direction);
  if (!is_own(direction)) {
    if (strays(start, distance_world_ * (direction - start.direction))) return false;
    direction = start.direction;
  }
  const Vec3 to = end(direction);
  if ((keep(to) - to).norm() > kExactly * length) return false;
  if (!search_.is_clear(to, length * (1 - kExactly))) return false;
  path.clear();
  path.add({0, start.point_world, direction});
  path.add({length, to, direction});
  return true;
}

}  // namespace vdb_offset
