// Ericson, Real-time collision detection, 2005, section 5.1.5.

#include "surface/triangle.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>

namespace vdb_offset {

namespace {

// Below this sine, squared, of the angle at `a` a triangle is a needle: what is found through dot
// and cross products of ab and ac has lost a digit and more.
constexpr double kNeedle2 = 1e-2;
// Below this sine a triangle is its three edges, and has no normal.
constexpr double kFlatSine = 2e-15;

struct SegmentPoint {
  Vec3 point;
  double parameter;
};

SegmentPoint closest_on_segment(const Vec3& a, const Vec3& ab, const Vec3& p) {
  const double length2 = ab.squaredNorm();
  const double t = length2 > 0 ? std::clamp(ab.dot(p - a) / length2, 0.0, 1.0) : 0.0;
  return {a + t * ab, t};
}

TrianglePoint closest_on_sides(const TriangleGeometry& t, const Vec3& p) {
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

/// A needle in the frame of its longest edge e and of w, from that edge to the third corner:
/// corner = start + cx e + w, with w orthogonal to e. The angles at the ends of e are the small
/// ones.
struct NeedleFrame {
  Vec3 e, w;
  Vec3 q;  // from the start of e to the query
  double ee, ww, cx;
  bool from_b;   // e is bc, else it starts in a
  bool turned;   // e x w points against the normal
  bool is_flat;  // a width of nothing but rounding has no direction
};

NeedleFrame needle_frame(const TriangleGeometry& t, const Vec3& ap) {
  const Vec3 bc = t.ac - t.ab;
  const double abab = t.ab.squaredNorm();
  const double acac = t.ac.squaredNorm();
  const double bcbc = bc.squaredNorm();
  NeedleFrame n;
  n.from_b = bcbc > abab && bcbc > acac;
  n.turned = !n.from_b && acac > abab;
  n.e = n.from_b ? bc : (n.turned ? t.ac : t.ab);
  n.ee = n.from_b ? bcbc : (n.turned ? acac : abab);
  n.q = n.from_b ? Vec3(ap - t.ab) : ap;
  const Vec3 f = n.from_b ? Vec3(-t.ab) : (n.turned ? t.ab : t.ac);
  n.cx = f.dot(n.e) / n.ee;
  n.w = f - n.cx * n.e;
  n.ww = n.w.squaredNorm();
  n.is_flat = !(n.ww > kFlatSine * kFlatSine * f.squaredNorm());
  return n;
}

/// q = x e + y w + what is orthogonal to both.
///
/// Why this is exact however thin the needle: w is off by eps |f|, which moves one corner by as
/// much, no more than rounding the edges did. x e and y w are off by eps |q| along the plane: a
/// slip of eps of the distance or of the edges, not of their ratio to the width. And 0 <= x <= 1
/// keeps the foot from slipping out past a sharp corner.
TrianglePoint closest_on_needle(const TriangleGeometry& t, const Vec3& p) {
  const NeedleFrame n = needle_frame(t, p - t.a);
  if (n.is_flat) return closest_on_sides(t, p);
  const double x = n.q.dot(n.e) / n.ee;
  const double y = (n.q - x * n.e).dot(n.w) / n.ww;
  const bool inside = x >= 0 && x <= 1 && y >= 0 && x >= y * n.cx && 1 - x >= y * (1 - n.cx);
  if (!inside) return closest_on_sides(t, p);
  const Vec3 start = n.from_b ? Vec3(t.a + t.ab) : t.a;
  return {start + (x * n.e + y * n.w), Feature::Face};
}

}  // namespace

Vec3 doubled_area(const TriangleGeometry& t) {
  const Vec3 cross = t.ab.cross(t.ac);
  if (cross.squaredNorm() > kNeedle2 * t.ab.squaredNorm() * t.ac.squaredNorm()) return cross;
  const NeedleFrame n = needle_frame(t, Vec3::Zero());
  if (n.is_flat) return Vec3::Zero();
  return n.turned ? Vec3(n.w.cross(n.e)) : Vec3(n.e.cross(n.w));
}

TrianglePoint closest_on_triangle(const TriangleGeometry& t, const Vec3& p) {
  const Vec3 ap = p - t.a;
  const double d1 = t.ab.dot(ap);
  const double d2 = t.ac.dot(ap);
  if (d1 <= 0 && d2 <= 0) return {t.a, Feature::VertexA};
  // Dot products with b and c are written through those with a: the same value, fewer roundings.
  const double abab = t.ab.squaredNorm();
  const double abac = t.ab.dot(t.ac);
  const double acac = t.ac.squaredNorm();
  const double area2 = abab * acac - abac * abac;
  if (!(area2 > kNeedle2 * abab * acac)) return closest_on_needle(t, p);
  const double d3 = d1 - abab;
  const double d4 = d2 - abac;
  if (d3 >= 0 && d4 <= d3) return {t.a + t.ab, Feature::VertexB};
  const double d5 = d1 - abac;
  const double d6 = d2 - acac;
  if (d6 >= 0 && d5 <= d6) return {t.a + t.ac, Feature::VertexC};
  const double v = acac * d1 - abac * d2;  // barycentric coordinates times area2
  const double w = abab * d2 - abac * d1;
  if (w <= 0 && d1 >= 0 && d3 <= 0) return {t.a + (d1 / abab) * t.ab, Feature::EdgeAB};
  if (v <= 0 && d2 >= 0 && d6 <= 0) return {t.a + (d2 / acac) * t.ac, Feature::EdgeCA};
  const double along = d4 - d3;
  const double back = d5 - d6;
  if (area2 - v - w <= 0 && along >= 0 && back >= 0) {
    return {t.a + t.ab + (along / (along + back)) * (t.ac - t.ab), Feature::EdgeBC};
  }
  // Along the normal: barycentric coordinates lose as many digits as the angle has, twice.
  const Vec3 normal = t.ab.cross(t.ac);
  return {p - (normal.dot(ap) / normal.squaredNorm()) * normal, Feature::Face};
}

}  // namespace vdb_offset
