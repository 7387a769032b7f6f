// A row of eight voxels against one triangle at a time, without branches, so that the compiler
// makes vectors of it. The squared distance is that to the plane if the voxel lies above the
// triangle, else that to the nearest edge:
//   inside      m_i . (p - s_i) >= 0 for the three edges, m_i in the plane and across edge i
//   edge i      |q - t e_i|^2 with q = p - s_i and t = min(1, max(0, q . e_i / |e_i|^2))
// Coordinates are in voxels about the tile's centre, so that single precision has the digits. An
// error of the inside test moves the value by no more than the error over the sine of the
// triangle's smallest angle, which `blur` counts.

#include "rasterize/near_filter.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

#include "core/parallel.h"
#include "rasterize/row_vector.h"

namespace vdb_offset {

namespace {

// Triangles beyond these, in voxels and sines of angles, are filtered in double precision.
constexpr double kLargest = 24;
constexpr double kSmallest = 1e-9;
constexpr double kThinnest = 0.01;
// Below this sine a triangle is no more than its edges.
constexpr double kFlat = 1e-6;
// Roundings that add up in one distance.
constexpr double kRoundings = 32;
constexpr int kStride = 8;

/// One triangle as seen from one tile.
template <typename Real>
struct Seen {
  using Vec = std::array<Real, 3>;
  const TriangleShape<Real>* shape;
  Vec a, b;                    // corners, about the tile's centre
  std::array<Real, 3> inside;  // m_i . (p) + inside_i >= 0
  Real plane;                  // n . p + plane: height above the plane
  std::array<Real, 3> lo, hi;  // bounding box, a little enlarged
  float slack;
  std::int32_t triangle;
};

template <typename Real>
Real dot(const std::array<Real, 3>& u, const std::array<Real, 3>& v) {
  return u[0] * v[0] + u[1] * v[1] + u[2] * v[2];
}

template <typename Real>
std::array<Real, 3> cast(const Vec3& v) {
  return {static_cast<Real>(v[0]), static_cast<Real>(v[1]), static_cast<Real>(v[2])};
}

/// A triangle in voxels.
TriangleGeometry in_voxels(const Wall& wall, std::size_t triangle, double voxel_world) {
  const TriangleGeometry& world = wall.geometry()[triangle];
  const double scale = 1 / voxel_world;
  return {scale * world.a, scale * world.ab, scale * world.ac};
}

struct Search {
  double reach;  // voxels
  int triangle;
};

struct Measures {
  double size;  // longest edge
  double sine;  // of the smallest angle, 0 if an edge has no length
  Vec3 normal;  // not of unit length
};

Measures measure(const TriangleGeometry& corners) {
  const Vec3& ab = corners.ab;
  const Vec3& ac = corners.ac;
  const Vec3 normal = ab.cross(ac);
  std::array<double, 3> length2{ab.squaredNorm(), ac.squaredNorm(), (ac - ab).squaredNorm()};
  std::sort(length2.begin(), length2.end());
  const double longest = std::sqrt(length2[2] * length2[1]);
  const double area = normal.norm();
  return {std::sqrt(length2[2]), longest > 0 && length2[0] > 0 ? area / longest : 0.0, normal};
}

template <typename Real>
TriangleShape<Real> shape_of(const TriangleGeometry& corners, const Measures& m) {
  TriangleShape<Real> shape;
  shape.a = corners.a;
  const std::array<Vec3, 3> edges{corners.ab, corners.ac, corners.ac - corners.ab};
  const bool flat = m.sine < kFlat;
  const Vec3 normal = flat ? Vec3(Vec3::Zero()) : Vec3(m.normal.normalized());
  for (std::size_t e = 0; e < 3; ++e) {
    const double length2 = edges[e].squaredNorm();
    shape.edge[e] = cast<Real>(edges[e]);
    shape.inverse[e] = static_cast<Real>(length2 > 1e-280 ? 1 / length2 : 0.0);
    const Vec3 across = normal.cross(edges[e]) / std::sqrt(std::max(length2, 1e-300));
    shape.inward[e] = cast<Real>(e == 1 ? Vec3(-across) : across);
  }
  shape.normal = cast<Real>(normal);
  shape.size = static_cast<Real>(m.size);
  constexpr double kEpsilon = std::numeric_limits<Real>::epsilon();
  shape.blur = static_cast<Real>(kRoundings * kEpsilon / (flat ? 1.0 : m.sine));
  shape.thin = static_cast<Real>(flat ? 2 * kFlat * m.size : 0.0);
  shape.outside = flat ? Real(-1e-30) : Real(0);
  return shape;
}

template <typename Real>
Seen<Real> see(const TriangleShape<Real>& shape, const Vec3& centre, const Search& search) {
  const double reach = search.reach;
  const Vec3 a = shape.a - centre;
  Seen<Real> t;
  t.triangle = search.triangle;
  t.shape = &shape;
  t.a = cast<Real>(a);
  for (std::size_t x = 0; x < 3; ++x) {
    t.b[x] = t.a[x] + shape.edge[0][x];
    const Real c = t.a[x] + shape.edge[1][x];
    t.lo[x] = std::min({t.a[x], t.b[x], c});
    t.hi[x] = std::max({t.a[x], t.b[x], c});
  }
  t.inside = {shape.outside - dot(shape.inward[0], t.a), shape.outside - dot(shape.inward[1], t.a),
              shape.outside - dot(shape.inward[2], t.b)};
  t.plane = -dot(shape.normal, t.a);
  const double scale = kTileCentre + reach + static_cast<double>(shape.size);
  const double error =
      scale * static_cast<double>(shape.blur) + static_cast<double>(shape.thin) + 1e-6;
  for (std::size_t x = 0; x < 3; ++x) {
    t.lo[x] -= static_cast<Real>(error);
    t.hi[x] += static_cast<Real>(error);
  }
  // (d + e)^2 - d^2 for d within reach; the last term covers the rounding of bounds to float.
  const double slack = 2 * reach * error + error * error + 1e-6 * reach * reach;
  t.slack = static_cast<float>(slack);
  return t;
}

/// Lowers `d2` to the squared distance to edge e that starts at p - q.
template <typename Real, typename Row = typename Lanes<Real>::Row>
VDB_OFFSET_INLINE Row edge_distance2(const std::array<Real, 2>& q, const Row& qz,
                                     const std::array<Real, 3>& e, Real inverse) {
  Row t = (qz * e[2] + (q[0] * e[0] + q[1] * e[1])) * inverse;
  t = t > Real(0) ? t : Row{};
  const Row one = Row{} + Real(1);
  t = t < one ? t : one;
  const Row x = q[0] - t * e[0];
  const Row y = q[1] - t * e[1];
  const Row z = qz - t * e[2];
  return x * x + y * y + z * z;
}

template <typename Real>
VDB_OFFSET_INLINE Real row_x(int row) {
  return static_cast<Real>(row / kTile) - Real(kTileCentre);
}

template <typename Real>
VDB_OFFSET_INLINE Real row_y(int row) {
  return static_cast<Real>(row % kTile) - Real(kTileCentre);
}

/// v . p + c along a row.
template <typename Real, typename Row = typename Lanes<Real>::Row>
VDB_OFFSET_INLINE Row linear(const std::array<Real, 3>& v, Real c, Real px, Real py) {
  return __builtin_convertvector(kHeights, Row) * v[2] + (v[0] * px + v[1] * py + c);
}

/// The part of the work on a row that bounds all distances from below: heights above the plane, and
/// how far each voxel lies outside the triangle, seen along the normal (negative: inside).
template <typename Real>
struct RowPlane {
  typename Lanes<Real>::Row height2, outside;
};

template <typename Real>
VDB_OFFSET_INLINE void find_plane(const Seen<Real>& t, Real px, Real py, RowPlane<Real>& plane) {
  using Row = typename Lanes<Real>::Row;
  const TriangleShape<Real>& s = *t.shape;
  const Row i0 = linear(s.inward[0], t.inside[0], px, py);
  const Row i1 = linear(s.inward[1], t.inside[1], px, py);
  const Row i2 = linear(s.inward[2], t.inside[2], px, py);
  Row least = i0 < i1 ? i0 : i1;
  least = i2 < least ? i2 : least;
  plane.outside = -least;
  const Row height = linear(s.normal, t.plane, px, py);
  plane.height2 = height * height;
}

template <typename Real>
VDB_OFFSET_INLINE Floats least_distances2(const RowPlane<Real>& plane) {
  using Row = typename Lanes<Real>::Row;
  const Row gap = plane.outside > Real(0) ? plane.outside : Row{};
  return __builtin_convertvector(plane.height2 + gap * gap, Floats);
}

/// Squared distances of the voxels (px, py, -3.5 ... 3.5) to a triangle.
template <typename Real>
VDB_OFFSET_INLINE Floats distances2(const Seen<Real>& t, Real px, Real py,
                                    const RowPlane<Real>& plane) {
  using Row = typename Lanes<Real>::Row;
  const TriangleShape<Real>& s = *t.shape;
  const Row pz = __builtin_convertvector(kHeights, Row);
  const std::array<Real, 2> qa{px - t.a[0], py - t.a[1]};
  const std::array<Real, 2> qb{px - t.b[0], py - t.b[1]};
  const Row ab = edge_distance2(qa, pz - t.a[2], s.edge[0], s.inverse[0]);
  const Row ac = edge_distance2(qa, pz - t.a[2], s.edge[1], s.inverse[1]);
  const Row bc = edge_distance2(qb, pz - t.b[2], s.edge[2], s.inverse[2]);
  Row d2 = ab < ac ? ab : ac;
  d2 = bc < d2 ? bc : d2;
  d2 = plane.outside <= Real(0) ? plane.height2 : d2;
  return __builtin_convertvector(d2, Floats);
}

template <typename Real>
VDB_OFFSET_INLINE void visit_rows(const Seen<Real>& t, float reach2, NearFilter::Scratch& scratch) {
  const Floats gap_x = gaps2(static_cast<float>(t.lo[0]), static_cast<float>(t.hi[0]));
  const Floats gap_y = gaps2(static_cast<float>(t.lo[1]), static_cast<float>(t.hi[1]));
  const Floats gap_z = gaps2(static_cast<float>(t.lo[2]), static_cast<float>(t.hi[2]));
  // Three passes over ever fewer rows, without branches that depend on the numbers: those would
  // be guessed wrong every other time.
  std::array<int, kRow * kRow> rows;
  std::size_t boxed = 0;
  const unsigned ys = bits(gap_y <= reach2);
  for (unsigned xs = bits(gap_x <= reach2); xs != 0; xs &= xs - 1) {
    const int x = std::countr_zero(xs);
    const Floats gap_xz = gap_z + gap_x[x];
    for (unsigned left = ys; left != 0; left &= left - 1) {
      const int y = std::countr_zero(left);
      const int row = x * kTile + y;
      const Floats nearest = load(scratch.nearest.data() + row * kTile);
      rows[boxed] = row;
      boxed += any(gap_xz + gap_y[y] <= nearest);
    }
  }
  std::array<RowPlane<Real>, kRow * kRow> planes;
  std::size_t above = 0;
  for (std::size_t r = 0; r < boxed; ++r) {
    const int row = rows[r];
    find_plane(t, row_x<Real>(row), row_y<Real>(row), planes[above]);
    const Floats nearest = load(scratch.nearest.data() + row * kTile);
    rows[above] = row;
    above += any(least_distances2(planes[above]) - t.slack <= nearest);
  }
  NearFilter::RowEntry* entry = scratch.entries.data() + scratch.entry_count;
  for (std::size_t r = 0; r < above; ++r) {
    const int row = rows[r];
    const Floats d2 = distances2(t, row_x<Real>(row), row_y<Real>(row), planes[r]);
    float* const stored = scratch.nearest.data() + row * kTile;
    const Floats nearest = load(stored);
    const Floats lower = d2 - t.slack;
    const Floats upper = d2 + t.slack;
    store(entry->lower.data(), lower);
    entry->row = row;
    entry->triangle = t.triangle;
    store(stored, upper < nearest ? upper : nearest);
    entry += any(lower <= nearest);
  }
  scratch.entry_count = static_cast<std::size_t>(entry - scratch.entries.data());
}

/// What is left of the entries once all triangles were seen.
VDB_OFFSET_CLONES void sift(NearFilter::Scratch& scratch) {
  scratch.candidate_count = 0;
  for (std::size_t e = 0; e < scratch.entry_count; ++e) {
    const NearFilter::RowEntry& entry = scratch.entries[e];
    const Floats nearest = load(scratch.nearest.data() + entry.row * kTile);
    unsigned hits = bits(load(entry.lower.data()) <= nearest);
    if (scratch.candidates.size() < scratch.candidate_count + kRow) {
      scratch.candidates.resize(2 * scratch.candidate_count + kTileVoxels);
    }
    for (; hits != 0; hits &= hits - 1) {
      scratch.candidates[scratch.candidate_count++] = {entry.row * kTile + std::countr_zero(hits),
                                                       entry.triangle};
    }
  }
}

VDB_OFFSET_CLONES void visit(const Seen<float>& t, float reach2, NearFilter::Scratch& scratch) {
  visit_rows(t, reach2, scratch);
}

VDB_OFFSET_CLONES void visit(const Seen<double>& t, float reach2, NearFilter::Scratch& scratch) {
  visit_rows(t, reach2, scratch);
}

}  // namespace

NearFilter::NearFilter(const Wall& wall, double voxel_world)
    : wall_(wall), voxel_world_(voxel_world), shapes_(wall.triangles().size()) {
  parallel::for_ranges(wall.triangles().size(), 4096, [&](std::size_t begin, std::size_t end) {
    for (std::size_t t = begin; t < end; ++t) {
      const TriangleGeometry c = in_voxels(wall, t, voxel_world);
      const Measures m = measure(c);
      const bool usual = m.size < kLargest && m.size > kSmallest && m.sine > kThinnest;
      shapes_[t] = usual ? shape_of<float>(c, m) : TriangleShape<float>{};
    }
  });
}

void NearFilter::run(const TileCube& tile, double reach_voxels, Scratch& scratch) const {
  // The reach itself is judged by exact distances: bounds leave room for their rounding.
  const auto limit = static_cast<float>(reach_voxels * reach_voxels * (1 + 1e-5));
  scratch.nearest.fill(limit);
  scratch.triangles.clear();
  scratch.entry_count = 0;
  const Vec3 lo = voxel_world_ * (kTile * Vec3(tile.x, tile.y, tile.z));
  Box box;
  box.add(lo);
  box.add(Vec3(lo.array() + (kTile - 1) * voxel_world_));
  wall_.near_box(box, reach_voxels * voxel_world_ * (1 + 1e-9), scratch.triangles);
  const double reach = reach_voxels * (1 + 1e-5);
  const Vec3 centre = kTile * Vec3(tile.x, tile.y, tile.z).array() + kTileCentre;
  // Every eighth triangle first: their bounds spare most rows of the others.
  for (std::size_t first = 0; first < kStride; ++first) {
    for (std::size_t c = first; c < scratch.triangles.size(); c += kStride) {
      if (scratch.entries.size() < scratch.entry_count + kRow * kRow + 1) {
        scratch.entries.resize(2 * scratch.entry_count + kTileVoxels);
      }
      const int triangle = scratch.triangles[c];
      const TriangleShape<float>& shape = shapes_[static_cast<std::size_t>(triangle)];
      if (shape.size > 0) {
        visit(see(shape, centre, {reach, triangle}), limit, scratch);
      } else {
        const TriangleGeometry corners =
            in_voxels(wall_, static_cast<std::size_t>(triangle), voxel_world_);
        const auto exact = shape_of<double>(corners, measure(corners));
        visit(see(exact, centre, {reach, triangle}), limit, scratch);
      }
    }
  }
  sift(scratch);
}

}  // namespace vdb_offset
