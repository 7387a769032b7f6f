// Ericson, Real-time collision detection, 2005, section 5.1.5.

#include "surface/triangle.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>

namespace vdb_offset {

namespace {

// Triangles whose doubled area is below this part of the product of their edges are treated as
// their three edges: the barycentric coordinates have no digits left.
constexpr double kNeedle = 1e-13;

struct SegmentPoint {
  Vec3 point;
  double parameter;
};

SegmentPoint closest_on_segment(const Vec3& a, const Vec3& ab, const Vec3& p) {
  const double length2 = ab.squaredNorm();
  const double t = length2 > 0 ? std::clamp(ab.dot(p - a) / length2, 0.0, 1.0) : 0.0;
  return {a + t * ab, t};
}

TrianglePoint closest_on_needle(const TriangleGeometry& t, const Vec3& p) {
  const Vec3 b = t.a + t.ab;
  const std::array<SegmentPoint, 3> sides{closest_on_segment(t.a, t.ab, p),
                                          closest_on_segment(b, t.ac - t.ab, p),
                                          closest_on_segment(t.a, t.ac, p)};
  constexpr std::array<Feature, 3> kEdge{Feature::EdgeAB, Feature::EdgeBC, Feature::EdgeCA};
  constexpr std::array<Feature, 3> kStart{Feature::VertexA, Feature::VertexB, Feature::VertexA};
  constexpr std::array<Feature, 3> kEnd{Feature::VertexB, Feature::VertexC, Feature::VertexC};
  std::size_t best = 0;
  for (std::size_t s = 1; s < 3; ++s) {
    if ((sides[s].point - p).squaredNorm() < (sides[best].point - p).squaredNorm()) best = s;
  }
  const double u = sides[best].parameter;
  const Feature feature = u <= 0 ? kStart[best] : (u >= 1 ? kEnd[best] : kEdge[best]);
  return {sides[best].point, feature};
}

}  // namespace

TrianglePoint closest_on_triangle(const TriangleGeometry& t, const Vec3& p) {
  const Vec3 ap = p - t.a;
  const double d1 = t.ab.dot(ap);
  const double d2 = t.ac.dot(ap);
  if (d1 <= 0 && d2 <= 0) return {t.a, Feature::VertexA};
  // Dot products with b and c are written through those with a: the same value, fewer roundings.
  const double abab = t.ab.squaredNorm();
  const double abac = t.ab.dot(t.ac);
  const double acac = t.ac.squaredNorm();
  const double d3 = d1 - abab;
  const double d4 = d2 - abac;
  if (d3 >= 0 && d4 <= d3) return {t.a + t.ab, Feature::VertexB};
  const double d5 = d1 - abac;
  const double d6 = d2 - acac;
  if (d6 >= 0 && d5 <= d6) return {t.a + t.ac, Feature::VertexC};
  const double area2 = abab * acac - abac * abac;
  if (area2 <= kNeedle * abab * acac) return closest_on_needle(t, p);
  const double v = acac * d1 - abac * d2;  // barycentric coordinates times area2
  const double w = abab * d2 - abac * d1;
  if (w <= 0 && d1 >= 0 && d3 <= 0) return {t.a + (d1 / abab) * t.ab, Feature::EdgeAB};
  if (v <= 0 && d2 >= 0 && d6 <= 0) return {t.a + (d2 / acac) * t.ac, Feature::EdgeCA};
  const double along = d4 - d3;
  const double back = d5 - d6;
  if (area2 - v - w <= 0 && along >= 0 && back >= 0) {
    return {t.a + t.ab + (along / (along + back)) * (t.ac - t.ab), Feature::EdgeBC};
  }
  // Along the normal: barycentric coordinates lose as many digits as a needle has, twice.
  const Vec3 normal = t.ab.cross(t.ac);
  return {p - (normal.dot(ap) / normal.squaredNorm()) * normal, Feature::Face};
}

}  // namespace vdb_offset
