// Scaled Jacobian, skew and edge ratio as the Verdict library computes them (Stimpson, Ernst,
// Knupp, Pebay, Thompson, The Verdict Geometric Quality Library, 2007); collapsed cells are judged
// at the corners of the prism or pyramid that is left.

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "blocks/hexahedron.h"
#include "vdb_offset/blocks/quality.h"

namespace vdb_offset {

using hexahedron::Measures;
using hexahedron::Triple;

namespace {

using Point = Triple<double>;
using Corners = std::array<Point, 8>;

constexpr double kInfinity = std::numeric_limits<double>::infinity();

bool same(const Point& a, const Point& b) { return a.x == b.x && a.y == b.y && a.z == b.z; }

/// The corners that an edge from `b` along `axis` may lead to: its neighbour, or, where that
/// coincides, the next vertices of the two faces.
struct Steps {
  std::array<std::size_t, 2> to{};
  std::size_t count = 0;
};

Steps steps_along(const Corners& q, std::size_t b, std::size_t axis) {
  Steps steps;
  const std::size_t next = b ^ (std::size_t{1} << axis);
  if (!same(q[next], q[b])) {
    steps.to[steps.count++] = next;
    return steps;
  }
  for (std::size_t other = 0; other < 3; ++other) {
    const std::size_t bit = std::size_t{1} << other;
    if (other == axis || same(q[next ^ bit], q[b])) continue;
    steps.to[steps.count++] = next ^ bit;
  }
  return steps;
}

/// Takes one corner's three edges into account; where two lead to one point (a face collapsed to a
/// line) there is no corner.
void judge_triad(const Corners& q, std::size_t b, const std::array<std::size_t, 3>& to,
                 Measures<double>& m) {
  if (same(q[to[0]], q[to[1]]) || same(q[to[1]], q[to[2]]) || same(q[to[2]], q[to[0]])) return;
  const std::array<Point, 3> e{q[to[0]] - q[b], q[to[1]] - q[b], q[to[2]] - q[b]};
  const bool mirrored = ((b ^ (b >> 1U) ^ (b >> 2U)) & 1U) != 0;
  const double jacobian = mirrored ? -det(e[0], e[1], e[2]) : det(e[0], e[1], e[2]);
  const double lengths =
      std::sqrt(dot(e[0], e[0])) * std::sqrt(dot(e[1], e[1])) * std::sqrt(dot(e[2], e[2]));
  m.min_jacobian = std::min(m.min_jacobian, jacobian);
  m.scaled_jacobian = std::min(m.scaled_jacobian, lengths > 0 ? jacobian / lengths : 0.0);
}

void judge_corner(const Corners& q, std::size_t b, Measures<double>& m) {
  const std::array<Steps, 3> steps{steps_along(q, b, 0), steps_along(q, b, 1),
                                   steps_along(q, b, 2)};
  const std::size_t triads = steps[0].count * steps[1].count * steps[2].count;
  for (std::size_t t = 0; t < triads; ++t) {
    const std::size_t x = t % steps[0].count;
    const std::size_t y = t / steps[0].count % steps[1].count;
    const std::size_t z = t / (steps[0].count * steps[1].count);
    judge_triad(q, b, {steps[0].to[x], steps[1].to[y], steps[2].to[z]}, m);
  }
}

/// Longest over shortest of the edges that are left; 1 if there is none.
double aspect2_of_edges_left(const Corners& q) {
  double shortest2 = kInfinity;
  double longest2 = 0;
  for (std::size_t b = 0; b < 8; ++b) {
    for (const std::size_t bit : {1U, 2U, 4U}) {
      const Point along = q[b | bit] - q[b];
      const double length2 = dot(along, along);
      if ((b & bit) != 0 || !(length2 > 0)) continue;
      shortest2 = std::min(shortest2, length2);
      longest2 = std::max(longest2, length2);
    }
  }
  return longest2 > 0 ? longest2 / shortest2 : 1.0;
}

/// Of the columns that are left against the wall-side face; 1 if there is no such column or face.
double orthogonality_left(const Corners& q) {
  const Point normal = cross((q[1] - q[0]) + (q[3] - q[2]), (q[2] - q[0]) + (q[3] - q[1]));
  const double normal_length = std::sqrt(dot(normal, normal));
  double worst = 1;
  for (std::size_t n = 0; n < 4; ++n) {
    const Point up = q[n + 4] - q[n];
    const double lengths = std::sqrt(dot(up, up)) * normal_length;
    if (lengths > 0) worst = std::min(worst, dot(normal, up) / lengths);
  }
  return worst;
}

/// Pairs of edges along `along`, at the side `side` of `across`: bits of corners.
struct PrismShape {
  std::size_t along, across;
  std::size_t side;  ///< 0, or the bit of `across`
};

std::size_t collapsed_edges(const Corners& q) {
  std::size_t count = 0;
  for (std::size_t b = 0; b < 8; ++b) {
    for (const std::size_t bit : {1U, 2U, 4U}) {
      if ((b & bit) == 0 && same(q[b], q[b | bit])) ++count;
    }
  }
  return count;
}

/// Two edges opposite each other in one face are collapsed, and no other.
std::optional<PrismShape> prism_shape(const Corners& q) {
  if (collapsed_edges(q) != 2) return {};
  for (const std::size_t along : {1U, 2U, 4U}) {
    for (const std::size_t across : {1U, 2U, 4U}) {
      for (const std::size_t side : {std::size_t{0}, across}) {
        const std::size_t up = 7U ^ along ^ across;
        if (along == across || !same(q[side], q[side | along])) continue;
        if (same(q[side | up], q[side | up | along])) return PrismShape{along, across, side};
      }
    }
  }
  return {};
}

bool is_pyramid(const Corners& q) {
  if (collapsed_edges(q) != 4) return false;
  for (const std::size_t normal : {1U, 2U, 4U}) {
    for (const std::size_t side : {std::size_t{0}, normal}) {
      const std::size_t u = normal == 1 ? 2 : 1;
      const std::size_t v = 7U ^ normal ^ u;
      const Point& apex = q[side];
      if (same(apex, q[side | u]) && same(apex, q[side | v]) && same(apex, q[side | u | v])) {
        return true;
      }
    }
  }
  return false;
}

/// The least of a (1 - t)^2 + 2 b t (1 - t) + c t^2 for t in [0, 1].
double least_of_quadratic(double a, double b, double c) {
  const double curvature = a - 2 * b + c;
  const double ends = std::min(a, c);
  if (!(curvature > 0) || b >= ends) return ends;
  return (a * c - b * b) / curvature;
}

/// The least Jacobian of the prism's map (r, s, t) -> (1 - t) bottom(r, s) + t top(r, s).
///
/// With the triangles' edges a, b at the bottom and a', b' at the top the map's derivatives along r
/// and s are (1 - t) a + t a' and (1 - t) b + t b'; that along t is linear in r and s, so the
/// Jacobian is, too: its least is on a column, and quadratic in t there.
double least_of_prism(const Corners& q, const PrismShape& shape) {
  const std::size_t up = 7U ^ shape.along ^ shape.across;
  const std::size_t other = shape.side ^ shape.across;
  const std::array<std::size_t, 3> ring{other, other | shape.along, shape.side};
  // Along, against across, and up are turned as the axes are, or the other way round.
  const bool even = shape.across == (shape.along << 1U) || shape.along == (shape.across << 2U);
  const bool mirrored = even == (shape.side == 0);
  double least = kInfinity;
  for (std::size_t n = 0; n < 3; ++n) {
    const std::size_t p0 = ring[n];
    const std::size_t p1 = ring[(n + 1) % 3];
    const std::size_t p2 = ring[(n + 2) % 3];
    const Point column = q[p0 | up] - q[p0];
    const std::array<Point, 2> a{q[p1] - q[p0], q[p1 | up] - q[p0 | up]};
    const std::array<Point, 2> b{q[p2] - q[p0], q[p2 | up] - q[p0 | up]};
    const double sign = mirrored ? -1 : 1;
    const double middle = 0.5 * (det(a[0], b[1], column) + det(a[1], b[0], column));
    least = std::min(least, least_of_quadratic(sign * det(a[0], b[0], column), sign * middle,
                                               sign * det(a[1], b[1], column)));
  }
  return least;
}

/// What has to be above zero. Of prisms and pyramids that is exact, whichever edges are collapsed:
/// the Jacobian of a pyramid's map is bilinear over its base, so the corners there decide. What
/// is left otherwise is judged by its corners and tetrahedra.
double least_part(const Corners& q, double corners, double tetrahedra) {
  if (const auto prism = prism_shape(q)) return least_of_prism(q, *prism);
  return is_pyramid(q) ? corners : std::min(corners, tetrahedra);
}

void judge_collapsed(const Corners& q, Measures<double>& m) {
  m.min_jacobian = kInfinity;
  m.scaled_jacobian = kInfinity;
  for (std::size_t b = 0; b < 8; ++b) judge_corner(q, b, m);
  double least = kInfinity;
  for (std::size_t t = 0; t < 6; ++t) {
    const Point& a = q[hexahedron::kRing[t]];
    const Point& c = q[hexahedron::kRing[t + 1]];
    const bool flat = same(q[0], q[7]) || same(a, q[0]) || same(a, q[7]) || same(c, q[0]) ||
                      same(c, q[7]) || same(a, c);
    if (flat) continue;
    least = std::min(least, det(a - q[0], c - q[0], q[7] - q[0]));
  }
  m.volume = volume_of(q);
  m.least_part = least_part(q, m.min_jacobian, least);
  m.aspect2 = aspect2_of_edges_left(q);
  m.orthogonality = orthogonality_left(q);
  const bool nothing_left = m.min_jacobian == kInfinity || least == kInfinity;
  if (nothing_left && std::isfinite(m.volume)) {
    m.scaled_jacobian = m.min_jacobian = m.least_part = m.volume = 0;
  }
}

}  // namespace

Measures<double> hexahedron::measure_cell(const Corners& q) {
  Measures<double> m = measure(q);
  if (m.sound > 0) return m;
  judge_collapsed(q, m);
  if (std::isfinite(m.volume + m.scaled_jacobian)) return m;
  m = {};
  m.scaled_jacobian = m.orthogonality = -1;
  m.skewness = 1;
  m.aspect2 = kInfinity;
  return m;
}

namespace {

Measures<double> measure_vtk(const std::array<Vec3, 8>& c) {
  constexpr std::array<std::size_t, 8> kFromVtk{0, 1, 3, 2, 4, 5, 7, 6};
  Corners q;
  for (std::size_t n = 0; n < 8; ++n) {
    const Vec3& p = c[kFromVtk[n]];
    q[n] = {p.x(), p.y(), p.z()};
  }
  return hexahedron::measure_cell(q);
}

}  // namespace

CellQuality cell_quality(const std::array<Vec3, 8>& corners_world) {
  const Measures<double> m = measure_vtk(corners_world);
  return {m.scaled_jacobian, m.min_jacobian, m.volume,
          m.least_part > 0 && m.scaled_jacobian >= kFlat};
}

CellShape cell_shape(const std::array<Vec3, 8>& corners_world) {
  const Measures<double> m = measure_vtk(corners_world);
  return {m.skewness, std::sqrt(m.aspect2), m.orthogonality};
}

}  // namespace vdb_offset
