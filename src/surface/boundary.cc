// Section 4.3 of Wang, Guibault, Camarero: special boundary planes close an open domain. Here the
// field beside them is that of the mirrored wall, not a two-dimensional solution within the plane:
// the wall's distance law then holds on the plane too (the solution within the plane gives levels
// that jump where the wall is oblique to it), and it extends to surfaces of any shape.

#include "vdb_offset/surface/boundary.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "surface/crossing.h"
#include "vdb_offset/core/error.h"

namespace vdb_offset {

namespace {

constexpr double kAxis = 1e-9;  // a unit normal nearer to an axis than this is the axis

Plane unit_plane(const Plane& plane) {
  // Scaled first: squares of huge and of tiny components are none.
  Vec3 normal = (plane.normal / plane.normal.cwiseAbs().maxCoeff()).normalized();
  if (!normal.allFinite() || !plane.point_world.allFinite()) {
    throw InputError("a boundary plane needs a finite point and a normal of non-zero length");
  }
  for (int axis = 0; axis < 3; ++axis) {
    const Vec3 exact = normal[axis] < 0 ? Vec3(-Vec3::Unit(axis)) : Vec3(Vec3::Unit(axis));
    if ((normal - exact).norm() < kAxis) normal = exact;
  }
  return {plane.point_world, normal};
}

double height(const Plane& plane, const Vec3& p) { return plane.normal.dot(p - plane.point_world); }

/// p - height n, with the plane's own coordinate where the normal is an axis.
Vec3 foot(const Plane& plane, const Vec3& p) {
  Vec3 result = p - height(plane, p) * plane.normal;
  for (int axis = 0; axis < 3; ++axis) {
    if (std::abs(plane.normal[axis]) == 1) result[axis] = plane.point_world[axis];
  }
  return result;
}

/// Onto the common place of the planes of `on`: rounds of projections come near to that slowly
/// where they meet at a sharp angle.
Vec3 onto_planes(const std::vector<Boundary>& list, BoundarySet on, const Vec3& p) {
  Eigen::Matrix<double, Eigen::Dynamic, 3, Eigen::RowMajor, 32, 3> normals(0, 3);
  Eigen::Matrix<double, Eigen::Dynamic, 1, 0, 32, 1> heights(0);
  for (std::size_t b = 0; b < list.size(); ++b) {
    if ((on >> b & 1U) == 0 || !list[b].is_plane()) continue;
    normals.conservativeResize(normals.rows() + 1, 3);
    heights.conservativeResize(heights.rows() + 1);
    normals.bottomRows<1>() = list[b].plane().normal.transpose();
    heights[heights.rows() - 1] = height(list[b].plane(), p);
  }
  if (heights.rows() < 2) return p;
  return p - Vec3(normals.completeOrthogonalDecomposition().solve(heights));
}

Vec3 mirrored(const Plane& plane, const Vec3& p) {
  return p - (2 * height(plane, p)) * plane.normal;
}

}  // namespace

std::string describe(const Plane& plane, bool is_flat) {
  for (int axis = 0; axis < 3; ++axis) {
    if (std::abs(plane.normal[axis]) != 1) continue;
    return fmt::format("{} = {:.6g}", "xyz"[axis], plane.point_world[axis]);
  }
  const Vec3& p = plane.point_world;
  const Vec3& n = plane.normal;
  if (is_flat) {
    return fmt::format("through ({:.6g}, {:.6g}), normal ({:.6g}, {:.6g})", p.x(), p.y(), n.x(),
                       n.y());
  }
  return fmt::format("through ({:.6g}, {:.6g}, {:.6g}), normal ({:.6g}, {:.6g}, {:.6g})", p.x(),
                     p.y(), p.z(), n.x(), n.y(), n.z());
}

Boundary::Boundary(std::string name, const Plane& plane)
    : name_(std::move(name)), plane_(unit_plane(plane)) {}

Boundary::Boundary(std::string name, const Plane& plane, std::shared_ptr<const Wall> rim,
                   std::shared_ptr<const Wall> crossing)
    : name_(std::move(name)),
      plane_(unit_plane(plane)),
      rim_(std::move(rim)),
      crossing_(std::move(crossing)) {}

Boundary::Boundary(std::string name, std::shared_ptr<const Wall> shape, ShapeRole role)
    : name_(std::move(name)), shape_(std::move(shape)), role_(role) {}

bool Boundary::covers(const Vec3& point_world) const {
  if (is_plane()) return true;
  const WallPoint nearest = shape_->closest(point_world);
  if (!nearest.on_free_edge) return true;
  // Over the rim itself: a surface may end on the plane that the domain ends on.
  const Vec3 away = point_world - nearest.point_world;
  const Vec3 beside = away - away.dot(nearest.normal) * nearest.normal;
  return beside.norm() <= kOnRim * shape_->bounds().size();
}

bool Boundary::holds(const Vec3& point_world) const {
  return !is_plane() && shape_->closest_place(point_world, on_wall(*shape_)).triangle >= 0;
}

std::optional<double> Boundary::crossing(const Vec3& from, const Vec3& to) const {
  return is_internal() ? first_crossing(*shape_, {from, to}, EndsCount::Yes) : std::nullopt;
}

bool Boundary::parts(const Vec3& from, const Vec3& to) const {
  return is_internal() && first_crossing(*shape_, {from, to}, EndsCount::No).has_value();
}

Plane Boundary::tangent(const Vec3& point_world) const {
  if (is_plane()) return plane_;
  const WallPoint nearest = shape_->closest(point_world);
  // Off edges and corners the way to the nearest place is the surface's normal there.
  const Vec3 away = point_world - nearest.point_world;
  const bool on_rim = nearest.on_free_edge || away.norm() < 1e-9 * shape_->bounds().size();
  const Vec3 normal = on_rim ? nearest.normal : Vec3(nearest.side(point_world) * away.normalized());
  return {nearest.point_world, normal};
}

double Boundary::side(const Vec3& point_world) const {
  if (is_plane()) {
    const double above = height(plane_, point_world);
    if (!is_local() || above >= 0) return above;
    const double excess = rim_->closest_place(point_world).distance_world -
                          crossing_->closest_place(point_world).distance_world;
    return std::max(above, 0.5 * excess);
  }
  const WallPoint nearest = shape_->closest(point_world);
  if (nearest.on_free_edge && !is_internal()) return nearest.distance_world;
  return nearest.side(point_world) * nearest.distance_world;
}

Vec3 Boundary::project(const Vec3& point_world) const {
  if (is_plane()) return foot(plane_, point_world);
  const WallPoint nearest = shape_->closest(point_world);
  if (!nearest.on_free_edge) return nearest.point_world;
  return point_world - nearest.normal.dot(point_world - nearest.point_world) * nearest.normal;
}

void Folded::reflect(const Plane& mirror) {
  point_world_ = mirrored(mirror, point_world_);
  mirrors_[count_++] = mirror;
}

Vec3 Folded::unfold(const Vec3& place_world) const {
  Vec3 place = place_world;
  for (std::size_t n = count_; n-- > 0;) place = mirrored(mirrors_[n], place);
  return place;
}

Vec3 Folded::unfold_direction(const Vec3& direction) const {
  Vec3 result = direction;
  for (std::size_t n = count_; n-- > 0;) {
    result -= (2 * mirrors_[n].normal.dot(result)) * mirrors_[n].normal;
  }
  return result;
}

void Boundaries::add(Boundary boundary) {
  if (list_.size() == 32) throw InputError("more than 32 boundary surfaces");
  list_.push_back(std::move(boundary));
}

bool Boundaries::has_internal() const {
  return std::any_of(list_.begin(), list_.end(),
                     [](const Boundary& boundary) { return boundary.is_internal(); });
}

double Boundaries::side(const Vec3& point_world) const {
  double least = std::numeric_limits<double>::infinity();
  for (const Boundary& boundary : list_) {
    if (!boundary.is_internal()) least = std::min(least, boundary.side(point_world));
  }
  return least;
}

const Boundary& Boundaries::nearest(const Vec3& point_world) const {
  const auto rank = [&](const Boundary& boundary) {
    return boundary.is_internal() ? std::numeric_limits<double>::infinity()
                                  : boundary.side(point_world);
  };
  return *std::min_element(list_.begin(), list_.end(),
                           [&](const Boundary& a, const Boundary& b) { return rank(a) < rank(b); });
}

Folded Boundaries::fold(const Vec3& point_world) const {
  Folded folded(point_world);
  // In turn, as two planes that meet at a right angle or lie parallel need it.
  for (bool again = true; again && !folded.full();) {
    again = false;
    for (const Boundary& boundary : list_) {
      if (folded.full() || boundary.is_internal()) continue;
      if (!(boundary.side(folded.point_world()) < 0)) continue;
      folded.reflect(boundary.tangent(folded.point_world()));
      again = true;
    }
  }
  return folded;
}

Vec3 Boundaries::contain(const Vec3& point_world, BoundarySet on) const {
  const auto beyond = [&](const Vec3& point) {
    BoundarySet set = 0;
    for (std::size_t b = 0; b < list_.size(); ++b) {
      if (!list_[b].is_internal() && list_[b].side(point) < 0) set |= BoundarySet{1} << b;
    }
    return set;
  };
  // Where boundaries meet at a sharp angle the way back from one leads beyond another.
  Vec3 point = hold(on, point_world);
  BoundarySet left = beyond(point);
  while ((left & ~on) != 0) {
    on |= left;
    point = hold(on, point_world);
    left = beyond(point);
  }
  // Rounding may have left it beyond one that it is held on.
  for (std::size_t b = 0; left >> b != 0; ++b) {
    if ((left >> b & 1U) != 0) point = list_[b].project(point);
  }
  return point;
}

Vec3 Boundaries::hold(BoundarySet on, const Vec3& point_world) const {
  Vec3 point = point_world;
  if (on == 0) return point;
  const bool single = (on & (on - 1)) == 0;
  // Alternating projections; planes at right angles are done after one round.
  const int rounds = single ? 1 : 100;
  for (int n = 0; n < rounds; ++n) {
    const Vec3 before = point;
    for (std::size_t b = 0; b < list_.size(); ++b) {
      if ((on >> b & 1U) != 0) point = list_[b].project(point);
    }
    if ((point - before).norm() <= 1e-16 * point.norm()) break;
    if (n == 1) point = onto_planes(list_, on, point);
  }
  return point;
}

Vec3 Boundaries::along(BoundarySet on, const Vec3& point_world, const Vec3& direction) const {
  Vec3 result = direction;
  Vec3List normals;  // orthonormal
  for (std::size_t b = 0; b < list_.size(); ++b) {
    if ((on >> b & 1U) == 0) continue;
    Vec3 normal = list_[b].tangent(point_world).normal;
    for (const Vec3& other : normals) normal -= normal.dot(other) * other;
    if (normal.norm() < 1e-6) continue;  // the same boundary twice
    normals.push_back(normal.normalized());
    result -= result.dot(normals.back()) * normals.back();
  }
  const double length = result.norm();
  return length > 1e-9 ? Vec3(result / length) : Vec3(Vec3::Zero());
}

}  // namespace vdb_offset
