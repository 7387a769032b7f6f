#include "surface/solid_angle.h"

#include <Eigen/Geometry>
#include <cmath>

namespace vdb_offset {
namespace {

/// The law of Biot and Savart for a straight piece of wire from a to b, seen from the origin.
Vec3 wire(const Vec3& a, const Vec3& b) {
  const double la = a.norm();
  const double lb = b.norm();
  const double product = la * lb;
  return (la + lb) / (product * (product + a.dot(b))) * a.cross(b);
}

}  // namespace

/// Van Oosterom and Strackee, The solid angle of a plane triangle, 1983.
double solid_angle(const TriangleGeometry& t, const Vec3& q) {
  const Vec3 a = t.a - q;
  const Vec3 b = a + t.ab;
  const Vec3 c = a + t.ac;
  const double la = a.norm();
  const double lb = b.norm();
  const double lc = c.norm();
  const double above = a.dot(b.cross(c));
  const double below = la * lb * lc + a.dot(b) * lc + b.dot(c) * la + c.dot(a) * lb;
  return above == 0 && below == 0 ? 0 : 2 * std::atan2(above, below);
}

Vec3 solid_angle_gradient(const TriangleGeometry& t, const Vec3& q) {
  const Vec3 a = t.a - q;
  const Vec3 b = a + t.ab;
  const Vec3 c = a + t.ac;
  return wire(a, b) + wire(b, c) + wire(c, a);
}

}  // namespace vdb_offset
