// Two rows of eight voxels against one triangle at a time, without branches, so that the compiler
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
constexpr std::size_t kPairs = kRow / 2;  // of rows in a slab
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

/// Where two rows stand: x and y of each voxel about the tile's centre.
template <typename Real>
struct RowPair {
  using Pair = typename Lanes<Real>::Pair;
  Pair x, y;

  VDB_OFFSET_INLINE RowPair(int first, int second)
      : x(__builtin_convertvector(both(first / kTile, second / kTile), Pair)),
        y(__builtin_convertvector(both(first % kTile, second % kTile), Pair)) {}

 private:
  static VDB_OFFSET_INLINE FloatPair both(int first, int second) {
    constexpr auto kMiddle = static_cast<float>(kTileCentre);
    return join(Floats{} + (static_cast<float>(first) - kMiddle),
                Floats{} + (static_cast<float>(second) - kMiddle));
  }
};

/// What of a triangle's edge is the same for all rows: from its start, along z.
template <typename Real>
struct SeenEdge {
  using Pair = typename Lanes<Real>::Pair;
  std::array<Real, 3> edge;
  std::array<Real, 2> start;
  Real inverse;
  Pair z;      // q_z
  Pair along;  // q_z e_z

  VDB_OFFSET_INLINE SeenEdge(const std::array<Real, 3>& e, const std::array<Real, 3>& from, Real i)
      : edge(e), start{from[0], from[1]}, inverse(i) {
    z = __builtin_convertvector(join(kHeights, kHeights), Pair) - from[2];
    along = z * e[2];
  }
  /// q . e
  VDB_OFFSET_INLINE Pair dot(const RowPair<Real>& p) const {
    return along + ((p.x - start[0]) * edge[0] + (p.y - start[1]) * edge[1]);
  }
  /// |q - t e|^2, with q . e.
  VDB_OFFSET_INLINE Pair distance2(const RowPair<Real>& p, const Pair& q_e) const {
    const Pair one = Pair{} + Real(1);
    Pair t = q_e * inverse;
    t = t > Real(0) ? t : Pair{};
    t = t < one ? t : one;
    const Pair x = (p.x - start[0]) - t * edge[0];
    const Pair y = (p.y - start[1]) - t * edge[1];
    const Pair rest = z - t * edge[2];
    return x * x + y * y + rest * rest;
  }
};

/// One triangle as seen from one tile.
template <typename Real>
struct Seen {
  using Pair = typename Lanes<Real>::Pair;
  SeenEdge<Real> ab, ac, bc;
  std::array<Real, 3> normal, gram;
  Pair height;  // q_z n_z

  VDB_OFFSET_INLINE Seen(const TriangleShape<Real>& shape, const std::array<Real, 3>& a)
      : ab(shape.edge[0], a, shape.inverse[0]),
        ac(shape.edge[1], a, shape.inverse[1]),
        bc(shape.edge[2],
           {a[0] + shape.edge[0][0], a[1] + shape.edge[0][1], a[2] + shape.edge[0][2]},
           shape.inverse[2]),
        normal(shape.normal),
        gram(shape.gram),
        height(ab.z * shape.normal[2]) {}
  /// Squared distances of the voxels of two rows.
  VDB_OFFSET_INLINE FloatPair distances2(const RowPair<Real>& p) const {
    const Pair u = ab.dot(p);
    const Pair v = ac.dot(p);
    const Pair to_ab = ab.distance2(p, u);
    const Pair to_ac = ac.distance2(p, v);
    const Pair to_bc = bc.distance2(p, bc.dot(p));
    Pair d2 = to_ab < to_ac ? to_ab : to_ac;
    d2 = to_bc < d2 ? to_bc : d2;
    const Pair of_b = gram[0] * u - gram[1] * v;
    const Pair of_c = gram[2] * v - gram[1] * u;
    const Pair of_a = Real(1) - of_b - of_c;
    Pair least = of_b < of_c ? of_b : of_c;
    least = of_a < least ? of_a : least;
    const Pair h = height + ((p.x - ab.start[0]) * normal[0] + (p.y - ab.start[1]) * normal[1]);
    d2 = least > Real(0) ? h * h : d2;
    return __builtin_convertvector(d2, FloatPair);
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
  std::array<FloatPair, kPairs> yz2;
  for (std::size_t n = 0; n < kPairs; ++n) yz2[n] = join(z2 + y2[2 * n], z2 + y2[2 * n + 1]);
  for (unsigned xs = bits(x2 <= place.reach2); xs != 0; xs &= xs - 1) {
    const int x = std::countr_zero(xs);
    float* const stored = scratch.nearest.data() + x * kTile * kTile;
    for (std::size_t n = 0; n < kPairs; ++n) {
      const FloatPair nearest = load_pair(stored + 2 * n * kRow);
      const FloatPair upper = yz2[n] + x2[x];
      store_pair(stored + 2 * n * kRow, upper < nearest ? upper : nearest);
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
  std::array<FloatPair, kPairs> gap_yz;
  for (std::size_t n = 0; n < kPairs; ++n) {
    gap_yz[n] = join(gap_y + gap_z[2 * n], gap_y + gap_z[2 * n + 1]);
  }
  std::uint64_t rows = 0;
  for (unsigned xs = bits(gap_x <= reach2); xs != 0; xs &= xs - 1) {
    const int x = std::countr_zero(xs);
    const float* const across = scratch.across.data() + x * kTile * kTile;
    FloatPair least = gap_yz[0] + gap_x[x] - load_pair(across);
    for (std::size_t n = 1; n < kPairs; ++n) {
      const FloatPair beyond = gap_yz[n] + gap_x[x] - load_pair(across + 2 * n * kRow);
      least = beyond < least ? beyond : least;
    }
    const Floats first = first_of(least);
    const Floats second = second_of(least);
    const Floats both = first < second ? first : second;
    rows |= std::uint64_t{bits(both <= 0.0F)} << (8 * x);
  }
  return rows;
}

VDB_OFFSET_INLINE void set(NearFilter::RowEntry& entry, const Floats& lower,
                           const std::array<std::int32_t, 2>& row_and_triangle) {
  store(entry.lower.data(), lower);
  entry.row = row_and_triangle[0];
  entry.triangle = row_and_triangle[1];
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
  if (scratch.entries.size() < scratch.entry_count + kRow * kRow + 2) {
    scratch.entries.resize(2 * scratch.entry_count + kTileVoxels);
  }
  const Seen<Real> t(shape, a);
  NearFilter::RowEntry* entry = scratch.entries.data() + scratch.entry_count;
  while (boxed != 0) {
    const int first = std::countr_zero(boxed);
    boxed &= boxed - 1;
    const std::size_t has_second = boxed != 0 ? 1 : 0;
    const int second = boxed != 0 ? std::countr_zero(boxed) : first;
    boxed &= boxed - 1;
    const FloatPair d2 = t.distances2(RowPair<Real>(first, second));
    float* const at_first = scratch.nearest.data() + first * kTile;
    float* const at_second = scratch.nearest.data() + second * kTile;
    const FloatPair nearest = join(load(at_first), load(at_second));
    const FloatPair lower = d2 - shape.slack;
    FloatPair upper = d2 + shape.slack;
    upper = upper < nearest ? upper : nearest;
    store(at_first, first_of(upper));
    store(at_second, second_of(upper));
    // Written in any case, kept where of use: no branch to guess.
    set(*entry, first_of(lower), {first, triangle});
    entry += any(first_of(lower) <= first_of(nearest));
    set(*entry, second_of(lower), {second, triangle});
    entry += any(second_of(lower) <= second_of(nearest)) & has_second;
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
    // The first is written in any case, kept where of use: mostly there is one, or none.
    NearFilter::Candidate* next = scratch.candidates.data() + scratch.candidate_count;
    *next = {entry.row * kTile + std::countr_zero(hits), entry.triangle};
    next += hits != 0 ? 1 : 0;
    for (hits &= hits - 1; hits != 0; hits &= hits - 1) {
      *next++ = {entry.row * kTile + std::countr_zero(hits), entry.triangle};
    }
    scratch.candidate_count = static_cast<std::size_t>(next - scratch.candidates.data());
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
