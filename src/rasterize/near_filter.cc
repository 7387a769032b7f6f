// A row of eight voxels against one triangle at a time, without branches, so that the compiler
// makes vectors of it. The squared distance is that to the plane if the voxel lies above the
// triangle, else that to the nearest edge:
//   inside      m_i . (p - s_i) >= 0 for the three edges, m_i in the plane and across edge i
//   edge i      |q - t e_i|^2 with q = p - s_i and t = min(1, max(0, q . e_i / |e_i|^2))
// Coordinates are in voxels about the tile's centre, so that single precision has the digits. An
// error of the inside test moves the value by no more than the error over the sine of the
// triangle's smallest angle, which `blur` counts.

#include "rasterize/near_filter.h"

#include <algorithm>
#include <bit>

#include "core/parallel.h"
#include "rasterize/row_vector.h"

namespace vdb_offset {

namespace {

constexpr std::size_t kStride = 8;
// A triangle smaller than this, in voxels, bounds distances by its middle: one of two does, which
// spares nearly as many rows as all of them would.
constexpr float kSmall = 4;
constexpr std::uint32_t kBoundStride = 2;
// Runs that are fetched before their turn.
constexpr std::size_t kAhead = 3;
constexpr std::ptrdiff_t kCacheLine = 64;
// Added to the boxes of runs, in voxels, for their rounding to float.
constexpr double kBoxRounding = 1e-5;

/// What does not depend on the triangle.
struct Place {
  Vec3 centre;   // of the tile, in the lattice's voxels
  float reach2;  // voxels squared
};

template <typename Real>
struct BoxAbout {
  std::array<Real, 3> lo, hi;
};

/// One triangle as seen from one tile.
template <typename Real>
struct Seen {
  using Vec = std::array<Real, 3>;
  const TriangleShape<Real>& shape;
  Vec a, b;                    // corners, about the tile's centre
  std::array<Real, 3> inside;  // m_i . (p) + inside_i >= 0
  Real plane;                  // n . p + plane: height above the plane
};

template <typename Real>
VDB_OFFSET_INLINE Real dot(const std::array<Real, 3>& u, const std::array<Real, 3>& v) {
  return u[0] * v[0] + u[1] * v[1] + u[2] * v[2];
}

/// A place about the tile's centre.
template <typename Real>
VDB_OFFSET_INLINE std::array<Real, 3> about(const Vec3& centre, const Vec3& p) {
  return {static_cast<Real>(p[0] - centre[0]), static_cast<Real>(p[1] - centre[1]),
          static_cast<Real>(p[2] - centre[2])};
}

template <typename Real>
VDB_OFFSET_INLINE Seen<Real> see(const TriangleShape<Real>& shape, const std::array<Real, 3>& a) {
  Seen<Real> t{shape, a, {}, {}, 0};
  for (std::size_t x = 0; x < 3; ++x) t.b[x] = a[x] + shape.edge[0][x];
  t.inside = {shape.outside - dot(shape.inward[0], t.a), shape.outside - dot(shape.inward[1], t.a),
              shape.outside - dot(shape.inward[2], t.b)};
  t.plane = -dot(shape.normal, t.a);
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
  const TriangleShape<Real>& s = t.shape;
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
  const TriangleShape<Real>& s = t.shape;
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

/// The eight rows as columns: lane k of row n goes to lane n of row k.
VDB_OFFSET_INLINE void transpose(const float* rows, float* columns) {
  std::array<Floats, kRow> from;
  for (std::size_t n = 0; n < kRow; ++n) from[n] = load(rows + n * kRow);
  for (int step = 0; step < 3; ++step) {
    std::array<Floats, kRow> to;
    for (std::size_t n = 0; n < kRow / 2; ++n) {
      const Floats& a = from[n];
      const Floats& b = from[n + kRow / 2];
      to[2 * n] = __builtin_shufflevector(a, b, 0, 8, 1, 9, 2, 10, 3, 11);
      to[2 * n + 1] = __builtin_shufflevector(a, b, 4, 12, 5, 13, 6, 14, 7, 15);
    }
    from = to;
  }
  for (std::size_t n = 0; n < kRow; ++n) store(columns + n * kRow, from[n]);
}

/// Makes `across` of `nearest`. Bounds that have been lowered since are judged by the older ones.
VDB_OFFSET_CLONES void turn(NearFilter::Scratch& scratch) {
  for (std::size_t x = 0; x < kRow; ++x) {
    transpose(scratch.nearest.data() + x * kRow * kRow, scratch.across.data() + x * kRow * kRow);
  }
}

/// Lowers the bounds to the distances to a triangle's middle.
VDB_OFFSET_INLINE void bound(const TriangleShape<float>& shape, const Place& place,
                             NearFilter::Scratch& scratch) {
  std::array<float, 3> middle = about<float>(place.centre, shape.a);
  for (std::size_t x = 0; x < 3; ++x) middle[x] += (shape.edge[0][x] + shape.edge[1][x]) / 3;
  const Floats x2 = (kHeights - middle[0]) * (kHeights - middle[0]);
  const Floats y2 = (kHeights - middle[1]) * (kHeights - middle[1]);
  const Floats z2 = (kHeights - middle[2]) * (kHeights - middle[2]) + shape.slack;
  // All of y without asking which are within reach: the loop's end would be guessed wrong.
  std::array<Floats, kRow> yz2;
  for (std::size_t y = 0; y < kRow; ++y) yz2[y] = z2 + y2[y];
  for (unsigned xs = bits(x2 <= place.reach2); xs != 0; xs &= xs - 1) {
    const int x = std::countr_zero(xs);
    float* const stored = scratch.nearest.data() + x * kTile * kTile;
    for (std::size_t y = 0; y < kRow; ++y) {
      const Floats nearest = load(stored + y * kRow);
      const Floats upper = yz2[y] + x2[x];
      store(stored + y * kRow, upper < nearest ? upper : nearest);
    }
  }
}

VDB_OFFSET_CLONES void bound_all(const TriangleShape<float>* shapes, const Place& place,
                                 NearFilter::Scratch& scratch) {
  for (std::size_t r = 0; r < scratch.runs.size(); ++r) {
    const TriangleRun& run = scratch.runs[r];
    // Shapes stand anywhere in memory: fetched some runs ahead, they are not waited for.
    const TriangleRun& ahead = scratch.runs[std::min(r + kAhead, scratch.runs.size() - 1)];
    const auto* const end = reinterpret_cast<const char*>(shapes + ahead.last);
    for (const auto* line = reinterpret_cast<const char*>(shapes + ahead.first); line < end;
         line += kCacheLine) {
      __builtin_prefetch(line);
    }
    for (std::uint32_t t = run.first; t < run.last; t += kBoundStride) {
      if (shapes[t].size > 0 && shapes[t].size < kSmall) bound(shapes[t], place, scratch);
    }
  }
}

/// Rows, a bit each, with a voxel whose bound is not below the distance to the box.
VDB_OFFSET_INLINE std::uint64_t rows_near(const BoxAbout<float>& box, float reach2,
                                          const NearFilter::Scratch& scratch) {
  const Floats gap_x = gaps2(box.lo[0], box.hi[0]);
  const Floats gap_y = gaps2(box.lo[1], box.hi[1]);
  const Floats gap_z = gaps2(box.lo[2], box.hi[2]);
  std::array<Floats, kRow> gap_yz;
  for (std::size_t z = 0; z < kRow; ++z) gap_yz[z] = gap_y + gap_z[z];
  std::uint64_t rows = 0;
  for (unsigned xs = bits(gap_x <= reach2); xs != 0; xs &= xs - 1) {
    const int x = std::countr_zero(xs);
    const float* const across = scratch.across.data() + x * kTile * kTile;
    Truths near{};
    for (std::size_t z = 0; z < kRow; ++z) near |= gap_yz[z] + gap_x[x] <= load(across + z * kRow);
    rows |= std::uint64_t{bits(near)} << (8 * x);
  }
  return rows;
}

template <typename Real>
VDB_OFFSET_INLINE void visit(const TriangleShape<Real>& shape, std::int32_t triangle,
                             const Place& place, NearFilter::Scratch& scratch) {
  const std::array<Real, 3> a = about<Real>(place.centre, shape.a);
  BoxAbout<float> box;
  for (std::size_t x = 0; x < 3; ++x) {
    box.lo[x] = static_cast<float>(a[x] + shape.lo[x]);
    box.hi[x] = static_cast<float>(a[x] + shape.hi[x]);
  }
  std::uint64_t boxed = rows_near(box, place.reach2, scratch);
  if (boxed == 0) return;
  if (scratch.entries.size() < scratch.entry_count + kRow * kRow + 1) {
    scratch.entries.resize(2 * scratch.entry_count + kTileVoxels);
  }
  const Seen<Real> t = see(shape, a);
  std::array<int, kRow * kRow> rows;
  std::array<RowPlane<Real>, kRow * kRow> planes;
  std::size_t above = 0;
  for (; boxed != 0; boxed &= boxed - 1) {
    const int row = std::countr_zero(boxed);
    find_plane(t, row_x<Real>(row), row_y<Real>(row), planes[above]);
    const Floats nearest = load(scratch.nearest.data() + row * kTile);
    rows[above] = row;
    above += any(least_distances2(planes[above]) - shape.slack <= nearest);
  }
  NearFilter::RowEntry* entry = scratch.entries.data() + scratch.entry_count;
  for (std::size_t r = 0; r < above; ++r) {
    const int row = rows[r];
    const Floats d2 = distances2(t, row_x<Real>(row), row_y<Real>(row), planes[r]);
    float* const stored = scratch.nearest.data() + row * kTile;
    const Floats nearest = load(stored);
    const Floats lower = d2 - shape.slack;
    const Floats upper = d2 + shape.slack;
    store(entry->lower.data(), lower);
    entry->row = row;
    entry->triangle = triangle;
    store(stored, upper < nearest ? upper : nearest);
    entry += any(lower <= nearest);
  }
  scratch.entry_count = static_cast<std::size_t>(entry - scratch.entries.data());
}

VDB_OFFSET_CLONES void visit_run(const TriangleShape<float>* shapes, const TriangleRun& run,
                                 const Place& place, NearFilter::Scratch& scratch) {
  const BoxAbout<float> box{about<float>(place.centre, run.box.lo),
                            about<float>(place.centre, run.box.hi)};
  if (rows_near(box, place.reach2, scratch) == 0) return;
  for (std::uint32_t t = run.first; t < run.last; ++t) {
    if (shapes[t].size > 0) {
      visit(shapes[t], static_cast<std::int32_t>(t), place, scratch);
    } else {
      scratch.unusual.push_back(static_cast<std::int32_t>(t));
    }
  }
}

VDB_OFFSET_CLONES void visit_unusual(const TriangleShape<double>& shape, std::int32_t triangle,
                                     const Place& place, NearFilter::Scratch& scratch) {
  visit(shape, triangle, place, scratch);
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

}  // namespace

NearFilter::NearFilter(const Wall& wall, double voxel_world, double reach_voxels)
    : wall_(wall),
      voxel_world_(voxel_world),
      reach_voxels_(reach_voxels),
      shapes_(wall.triangles().size()) {
  parallel::for_ranges(shapes_.size(), 4096, [&](std::size_t begin, std::size_t end) {
    for (std::size_t t = begin; t < end; ++t) shapes_[t] = small_shape(task_of(t));
  });
}

ShapeTask NearFilter::task_of(std::size_t triangle) const {
  return {wall_.geometry()[triangle], voxel_world_, reach_voxels_ * (1 + 1e-5)};
}

void NearFilter::run(const TileCube& tile, Scratch& scratch) const {
  // The reach itself is judged by exact distances: bounds leave room for their rounding.
  const auto limit = static_cast<float>(reach_voxels_ * reach_voxels_ * (1 + 1e-5));
  scratch.nearest.fill(limit);
  scratch.runs.clear();
  scratch.unusual.clear();
  scratch.entry_count = 0;
  const Vec3 lo = voxel_world_ * (kTile * Vec3(tile.x, tile.y, tile.z));
  Box box;
  box.add(lo);
  box.add(Vec3(lo.array() + (kTile - 1) * voxel_world_));
  wall_.near_box(box, reach_voxels_ * voxel_world_ * (1 + 1e-9), scratch.runs);
  const Place place{kTile * Vec3(tile.x, tile.y, tile.z).array() + kTileCentre, limit};
  for (TriangleRun& run : scratch.runs) {
    run.box.lo = run.box.lo.array() / voxel_world_ - kBoxRounding;
    run.box.hi = run.box.hi.array() / voxel_world_ + kBoxRounding;
  }
  bound_all(shapes_.data(), place, scratch);
  // Every eighth run first: their bounds spare most rows of the others.
  for (std::size_t first = 0; first < kStride; ++first) {
    if ((first & (first - 1)) == 0) turn(scratch);  // more often does not pay
    for (std::size_t r = first; r < scratch.runs.size(); r += kStride) {
      visit_run(shapes_.data(), scratch.runs[r], place, scratch);
    }
  }
  for (const int t : scratch.unusual) {
    visit_unusual(any_shape(task_of(static_cast<std::size_t>(t))), t, place, scratch);
  }
  sift(scratch);
}

}  // namespace vdb_offset
