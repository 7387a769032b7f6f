// Without branches: the least of the distances to the three sides, or that to the plane where the
// place lies above the triangle, as `surface/triangle.cc` has them.

#include "rasterize/exact_distances.h"

namespace vdb_offset {

namespace {

// Below this sine, squared, of the angle at the first corner dot products with its two sides have
// lost a digit and more.
constexpr double kNeedle2 = 1e-2;

using Lanes3 = std::array<Doubles, 3>;

VDB_OFFSET_INLINE Lanes3 load3(const std::array<std::array<double, kRow>, 3>& from) {
  Lanes3 to;
  for (std::size_t x = 0; x < 3; ++x) std::memcpy(&to[x], from[x].data(), sizeof(Doubles));
  return to;
}

VDB_OFFSET_INLINE Doubles dot(const Lanes3& u, const Lanes3& v) {
  return u[0] * v[0] + u[1] * v[1] + u[2] * v[2];
}

/// |q - t e|^2 with t = part / whole, held to the edge.
VDB_OFFSET_INLINE Doubles edge_distance2(const Lanes3& q, const Lanes3& e, const Doubles& part,
                                         const Doubles& whole) {
  const Doubles one = Doubles{} + 1.0;
  Doubles t = part / whole;
  t = t > 0.0 ? t : Doubles{};
  t = t < one ? t : one;
  const Lanes3 r{q[0] - t * e[0], q[1] - t * e[1], q[2] - t * e[2]};
  return dot(r, r);
}

struct Given {
  const std::array<std::array<double, kRow>, 3>&place, &a, &ab, &ac;
};

/// Negative where the triangle is a needle.
VDB_OFFSET_CLONES void find_eight(const Given& given, double* distance2) {
  const Lanes3 ab = load3(given.ab);
  const Lanes3 ac = load3(given.ac);
  const Lanes3 a = load3(given.a);
  Lanes3 q = load3(given.place);
  for (std::size_t x = 0; x < 3; ++x) q[x] -= a[x];
  const Doubles abab = dot(ab, ab);
  const Doubles abac = dot(ab, ac);
  const Doubles acac = dot(ac, ac);
  const Doubles d1 = dot(ab, q);
  const Doubles d2 = dot(ac, q);
  const Lanes3 bc{ac[0] - ab[0], ac[1] - ab[1], ac[2] - ab[2]};
  const Lanes3 from_b{q[0] - ab[0], q[1] - ab[1], q[2] - ab[2]};
  const Doubles to_ab = edge_distance2(q, ab, d1, abab);
  const Doubles to_ac = edge_distance2(q, ac, d2, acac);
  const Doubles to_bc = edge_distance2(from_b, bc, dot(from_b, bc), dot(bc, bc));
  Doubles least = to_ab < to_ac ? to_ab : to_ac;
  least = to_bc < least ? to_bc : least;
  const Lanes3 normal{ab[1] * ac[2] - ab[2] * ac[1], ab[2] * ac[0] - ab[0] * ac[2],
                      ab[0] * ac[1] - ab[1] * ac[0]};
  const Doubles height = dot(normal, q);
  const Doubles to_plane = height * height / dot(normal, normal);
  const Doubles area2 = abab * acac - abac * abac;
  const Doubles v = acac * d1 - abac * d2;  // barycentric coordinates times area2
  const Doubles w = abab * d2 - abac * d1;
  const auto inside = (v > 0.0) & (w > 0.0) & (area2 - v - w > 0.0);
  least = inside ? to_plane : least;
  least = area2 > kNeedle2 * abab * acac ? least : Doubles{} - 1.0;
  std::memcpy(distance2, &least, sizeof(least));
}

}  // namespace

std::span<const double> ExactDistances::find(const Wall& wall) {
  find_eight({place_, a_, ab_, ac_}, distance2_.data());
  for (std::size_t n = 0; n < count_; ++n) {
    if (distance2_[n] >= 0) continue;
    const Vec3 place(place_[0][n], place_[1][n], place_[2][n]);
    distance2_[n] = wall.distance2(triangles_[n], place);
  }
  const std::span<const double> found(distance2_.data(), count_);
  count_ = 0;
  return found;
}

}  // namespace vdb_offset
