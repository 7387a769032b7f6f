// A row of eight voxels against one triangle at a time, without branches, so that the compiler
// makes vectors of it. With q = p - a, u = q . ab and v = q . ac, the squared distance is
//   (q . n)^2          if both barycentric coordinates, made of u and v, and their sum allow it
//   |q - t e|^2        else, to the nearest edge e, with t = min(1, max(0, q . e / |e|^2))
// Coordinates are in voxels about the tile's centre, so that single precision has the digits. An
// error of barycentric coordinates moves the value by no more than the error over the sine of the
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

/// A place about the tile's centre.
template <typename Real>
VDB_OFFSET_INLINE std::array<Real, 3> about(const Vec3& centre, const Vec3& p) {
  return {static_cast<Real>(p[0] - centre[0]), static_cast<Real>(p[1] - centre[1]),
          static_cast<Real>(p[2] - centre[2])};
}

template <typename Real>
VDB_OFFSET_INLINE Real row_x(int row) {
  return static_cast<Real>(row / kTile) - Real(kTileCentre);
}

template <typename Real>
VDB_OFFSET_INLINE Real row_y(int row) {
  return static_cast<Real>(row % kTile) - Real(kTileCentre);
}

/// What of a triangle's edge is the same for all rows: from its start, along z.
template <typename Real>
struct SeenEdge {
  using Row = typename Lanes<Real>::Row;
  std::array<Real, 3> edge;
  std::array<Real, 2> start;
  Real inverse;
  Row z;      // q_z
  Row along;  // q_z e_z

  VDB_OFFSET_INLINE SeenEdge(const std::array<Real, 3>& e, const std::array<Real, 3>& from, Real i)
      : edge(e), start{from[0], from[1]}, inverse(i) {
    z = __builtin_convertvector(kHeights, Row) - from[2];
    along = z * e[2];
  }
  /// q . e
  VDB_OFFSET_INLINE Row dot(Real px, Real py) const {
    return along + ((px - start[0]) * edge[0] + (py - start[1]) * edge[1]);
  }
  /// |q - t e|^2, with q . e.
  VDB_OFFSET_INLINE Row distance2(Real px, Real py, const Row& q_e) const {
    const Row one = Row{} + Real(1);
    Row t = q_e * inverse;
    t = t > Real(0) ? t : Row{};
    t = t < one ? t : one;
    const Row x = (px - start[0]) - t * edge[0];
    const Row y = (py - start[1]) - t * edge[1];
    const Row rest = z - t * edge[2];
    return x * x + y * y + rest * rest;
  }
};

/// One triangle as seen from one tile.
template <typename Real>
struct Seen {
  using Row = typename Lanes<Real>::Row;
  SeenEdge<Real> ab, ac, bc;
  std::array<Real, 3> normal, gram;
  Row height;  // q_z n_z

  VDB_OFFSET_INLINE Seen(const TriangleShape<Real>& shape, const std::array<Real, 3>& a)
      : ab(shape.edge[0], a, shape.inverse[0]),
        ac(shape.edge[1], a, shape.inverse[1]),
        bc(shape.edge[2],
           {a[0] + shape.edge[0][0], a[1] + shape.edge[0][1], a[2] + shape.edge[0][2]},
           shape.inverse[2]),
        normal(shape.normal),
        gram(shape.gram),
        height(ab.z * shape.normal[2]) {}
  /// Squared distances of the voxels (px, py, -3.5 ... 3.5).
  VDB_OFFSET_INLINE Floats distances2(Real px, Real py) const {
    const Row u = ab.dot(px, py);
    const Row v = ac.dot(px, py);
    const Row to_ab = ab.distance2(px, py, u);
    const Row to_ac = ac.distance2(px, py, v);
    const Row to_bc = bc.distance2(px, py, bc.dot(px, py));
    Row d2 = to_ab < to_ac ? to_ab : to_ac;
    d2 = to_bc < d2 ? to_bc : d2;
    const Row of_b = gram[0] * u - gram[1] * v;
    const Row of_c = gram[2] * v - gram[1] * u;
    const Row of_a = Real(1) - of_b - of_c;
    Row least = of_b < of_c ? of_b : of_c;
    least = of_a < least ? of_a : least;
    const Row h = height + ((px - ab.start[0]) * normal[0] + (py - ab.start[1]) * normal[1]);
    d2 = least > Real(0) ? h * h : d2;
    return __builtin_convertvector(d2, Floats);
  }
};

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
  const Seen<Real> t(shape, a);
  NearFilter::RowEntry* entry = scratch.entries.data() + scratch.entry_count;
  for (; boxed != 0; boxed &= boxed - 1) {
    const int row = std::countr_zero(boxed);
    const Floats d2 = t.distances2(row_x<Real>(row), row_y<Real>(row));
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
