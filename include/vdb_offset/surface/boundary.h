#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "vdb_offset/core/vec.h"
#include "vdb_offset/surface/patch.h"
#include "vdb_offset/surface/wall.h"

namespace vdb_offset {

/// A plane through `point_world`; `normal` need not be of unit length.
struct Plane {
  Vec3 point_world = Vec3::Zero();
  Vec3 normal = Vec3::UnitX();
};

/// "x = 0.5", or "through (0, 0, 1), normal (0, 0.6, 0.8)"; in two dimensions without z.
std::string describe(const Plane& plane, bool is_flat = false);

/// What a surface of any shape is to the domain.
enum class ShapeRole {
  End,       ///< the domain ends there
  Internal,  ///< the flow passes it, columns do not cross it
  Wall       ///< part of the wall, without layers; the domain may go on behind it
};

/// One boundary surface of an open domain (the paper's special boundary plane): the wall ends on
/// it, and columns of nodes on it march within it.
class Boundary {
 public:
  /// A plane whose normal points into the domain. A normal along an axis, to rounding, is taken as
  /// that axis, so that points put on the plane have its coordinate to the bit.
  Boundary(std::string name, const Plane& plane);
  /// The same where the wall passes the plane elsewhere: beyond it lies only what is nearer to
  /// `rim`, the part of the wall that ends on it, than to `crossing`, what lies past the plane.
  Boundary(std::string name, const Plane& plane, std::shared_ptr<const Wall> rim,
           std::shared_ptr<const Wall> crossing);
  /// A surface of any shape, as triangles whose normals point into the domain if it is an end.
  Boundary(std::string name, std::shared_ptr<const Wall> shape, ShapeRole role = ShapeRole::End);

  const std::string& name() const { return name_; }
  void rename(std::string name) { name_ = std::move(name); }
  bool is_plane() const { return shape_ == nullptr; }
  /// Two-sided: it ends no domain, but columns do not cross it; a wall without layers too.
  bool is_internal() const { return role_ != ShapeRole::End; }
  bool is_bare_wall() const { return role_ == ShapeRole::Wall; }
  bool is_local() const { return rim_ != nullptr; }  ///< a plane that the wall passes elsewhere
  const Plane& plane() const { return plane_; }      ///< unit normal; of no meaning for a shape

  /// Signed distance, world: positive in the domain, and past the rim of a shape; beyond a local
  /// plane at most the distance to where that is not.
  double side(const Vec3& point_world) const;
  /// The nearest place on it; past its rim, on the plane that goes on there.
  Vec3 project(const Vec3& point_world) const;
  /// Whether the point lies over it, its rim included.
  bool covers(const Vec3& point_world) const;
  /// Whether the point lies on it to rounding, 1e-12 of its size; none does on a plane.
  bool holds(const Vec3& point_world) const;
  /// The part of a straight way, world, after which that first goes through an internal surface;
  /// ends that lie on it count. No way leaks through where facets meet.
  std::optional<double> crossing(const Vec3& from, const Vec3& to) const;
  /// The same for ends that lie on either side of it, by more than rounding.
  bool parts(const Vec3& from, const Vec3& to) const;
  /// The tangent plane at the nearest place, normal into the domain.
  Plane tangent(const Vec3& point_world) const;

 private:
  std::string name_;
  Plane plane_;
  std::shared_ptr<const Wall> shape_;
  ShapeRole role_ = ShapeRole::End;
  std::shared_ptr<const Wall> rim_, crossing_;
};

/// The boundaries that a node lies on, as bits.
using BoundarySet = std::uint32_t;

/// A point reflected into the domain, and the way back.
class Folded {
 public:
  explicit Folded(const Vec3& point_world) : point_world_(point_world) {}

  const Vec3& point_world() const { return point_world_; }
  bool moved() const { return count_ > 0; }
  void reflect(const Plane& mirror);
  bool full() const { return count_ == mirrors_.size(); }
  /// What stands at `place_world` in the domain, as seen from where the point was.
  Vec3 unfold(const Vec3& place_world) const;
  Vec3 unfold_direction(const Vec3& direction) const;

 private:
  Vec3 point_world_;
  std::array<Plane, 6> mirrors_;
  std::size_t count_ = 0;
};

/// All boundaries of a domain: what lies on the inner side of each that is not internal.
///
/// Beyond a boundary everything is as if mirrored on it. The wall lies in the domain, so for a
/// point of the domain the distance to the wall is that to the wall and all its images: mirroring
/// costs no geometry, and only points beyond a boundary need to be folded back.
class Boundaries {
 public:
  /// Throws InputError beyond 32.
  void add(Boundary boundary);
  void rename(std::size_t boundary, std::string name) { list_[boundary].rename(std::move(name)); }

  bool empty() const { return list_.empty(); }
  bool has_internal() const;
  const std::vector<Boundary>& list() const { return list_; }

  /// Least signed distance; positive in the domain, +infinity without boundaries.
  double side(const Vec3& point_world) const;
  /// The boundary of least signed distance, none of the internal; there must be one.
  const Boundary& nearest(const Vec3& point_world) const;
  Folded fold(const Vec3& point_world) const;
  /// Onto all boundaries of `on`, and onto those that it would lie beyond then.
  Vec3 contain(const Vec3& point_world, BoundarySet on = 0) const;
  /// Onto all boundaries of `on`: their common place near the point. Planes to rounding, shapes to
  /// 1e-12 of the way moved.
  Vec3 hold(BoundarySet on, const Vec3& point_world) const;
  /// The part of a direction within all boundaries of `on`, unit length; zero if there is none.
  Vec3 along(BoundarySet on, const Vec3& point_world, const Vec3& direction) const;

 private:
  std::vector<Boundary> list_;
};

}  // namespace vdb_offset
