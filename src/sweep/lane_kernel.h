#pragma once

// The kernels, written once over "lanes": a type L of one instruction set with L::kWidth floats
// side by side. For the kernel_*.cc alone, each compiled for its instruction set; everything is in
// an anonymous namespace (and the standard library all but left out) so that the linker cannot pick
// one set's code for another.
//
// Zhao, A fast sweeping method for eikonal equations, 2005; the upwind scheme is Rouy and Tourin's,
// A viscosity solutions approach to shape-from-shading, 1992; which tiles to see again is after
// Jeong and Whitaker, A fast iterative method for eikonal equations, 2008.
//
// The scheme. With a <= b <= c the least neighbours along the axes, sorted, p = b - a, q = c - a,
// t = phi - a:
//   one axis    t = h                                                          while t <= p
//   two axes    t^2 + (t - p)^2 = h^2              t = (p + sqrt(2 h^2 - p^2)) / 2      while t <=
//   q three axes  t^2 + (t - p)^2 + (t - q)^2 = h^2  t = (p + q + sqrt(3 h^2 - p^2 - E)) / 3,
//               E = q^2 + (q - p)^2
// t <= q of two axes is E >= h^2, so the roots differ by max(0, h^2 - E) and one square root does;
// with p cut off at h the formula for two axes gives t = h, the one for one axis, exactly.
// Differences to the least neighbour keep the digits that the paper's form loses far from the wall.
//
// Whom to see again. A voxel v may fall when a neighbour w < v has fallen since v was last solved.
// In the octant's order that concerns v behind w (its upwind side) and v in tiles next door. The
// octant that carries w's news is the running one, turned round along every axis on which the voxel
// behind w is open and higher: there the front runs the other way.

#include "sweep/kernel.h"

namespace vdb_offset {
namespace {

constexpr int kEdge = 10;  // a tile with a halo of one voxel on its faces
constexpr int kStep[3] = {kEdge * kEdge, kEdge, 1};

constexpr int cell_of(int x, int y, int z) { return ((x + 1) * kEdge + y + 1) * kEdge + z + 1; }

/// The voxels of a tile by planes x + y + z = const: what is in one plane does not depend on each
/// other, which hides the latency of the square root. The outcome is that of any order in which
/// upwind voxels come first.
struct Order {
  struct Visit {
    std::uint16_t cell;
    std::uint8_t first;  // bit a: in the first layer along axis a
    std::uint8_t last;
  };
  Visit visits[512];

  constexpr Order() : visits{} {
    int n = 0;
    for (int plane = 0; plane <= 21; ++plane) {
      for (int x = 0; x < 8; ++x) {
        for (int y = 0; y < 8; ++y) {
          const int z = plane - x - y;
          if (z >= 0 && z < 8) visits[n++] = visit(x, y, z);
        }
      }
    }
  }
  static constexpr Visit visit(int x, int y, int z) {
    const int first = (x == 0 ? 1 : 0) | (y == 0 ? 2 : 0) | (z == 0 ? 4 : 0);
    const int last = (x == 7 ? 1 : 0) | (y == 7 ? 2 : 0) | (z == 7 ? 4 : 0);
    return {static_cast<std::uint16_t>(cell_of(x, y, z)), static_cast<std::uint8_t>(first),
            static_cast<std::uint8_t>(last)};
  }
};
constexpr Order kOrder;

/// Octants, relative to the running one, that turn round some axis outside `axes`.
constexpr unsigned beyond(unsigned axes) {
  unsigned set = 0;
  for (unsigned o = 0; o < 8; ++o) set |= (o & ~axes) != 0 ? 1U << o : 0U;
  return set;
}

/// Octants that turn round axis a, and those octants as they were before.
constexpr unsigned kTurned[3] = {0xaa, 0xcc, 0xf0};
constexpr unsigned without_turn(unsigned set, unsigned axis) {
  return (set & ~kTurned[axis]) | (set & kTurned[axis]) >> (1U << axis);
}

template <typename L>
class LaneSweep {
  using V = typename L::V;
  using I = typename L::I;
  using M = typename L::M;
  static constexpr std::size_t kWidth = L::kWidth;

 public:
  LaneSweep(TileBatch& batch, std::size_t begin) : batch_(batch), begin_(begin) {
    for (std::size_t n = 0; n < 512; ++n) nothing_[n] = -kFarAway;
  }

  void run() {
    load_tiles();
    for (unsigned face = 0; face < kFaces; ++face) load_face(face);
    solve();
    report();
  }

 private:
  bool used(std::size_t lane) const { return begin_ + lane < batch_.count; }
  float* at(int cell) { return cells_ + static_cast<std::size_t>(cell) * kWidth; }
  int place(unsigned axis, int i) const { return (batch_.octant >> axis & 1U) != 0 ? 7 - i : i; }

  /// Eight codes of each lane's tile or layer, `row` after its begin, to the cells from `cell` on,
  /// turned round if `back`.
  void spread(const float* const* from, int row, int cell, int step, bool back) {
    V codes[8];
    L::transpose(from, row, codes);
    for (int k = 0; k < 8; ++k) L::store(at(cell + step * (back ? 7 - k : k)), codes[k]);
  }

  void load_tiles() {
    const float* tiles[kWidth];
    for (std::size_t l = 0; l < kWidth; ++l) {
      tiles[l] = used(l) ? batch_.tile[begin_ + l] : nothing_;
    }
    const bool back = (batch_.octant & 4U) != 0;
    for (int n = 0; n < 64; ++n) {
      spread(tiles, 8 * n, cell_of(place(0, n / 8), place(1, n % 8), 0), 1, back);
    }
  }

  /// The layer of the neighbours' voxels that touches the tiles across `face`.
  void load_face(unsigned face) {
    const unsigned axis = face / 2;
    const unsigned u = axis == 0 ? 1 : 0;  // the layer's axes, v the faster
    const unsigned v = axis == 2 ? 1 : 2;
    const int corner =
        cell_of(0, 0, 0) + kStep[axis] * ((face % 2 == 0) == (place(axis, 0) == 0) ? -1 : 8);
    const float* layers[kWidth];
    for (std::size_t l = 0; l < kWidth; ++l) {
      const float* const layer = used(l) ? batch_.beside[face][begin_ + l] : nullptr;
      layers[l] = layer == nullptr ? nothing_ : layer;
    }
    float columns[kWidth][64];
    for (std::size_t l = 0; axis == 2 && l < kWidth; ++l) {  // codes along y lie apart
      for (int n = 0; n < 64; ++n) columns[l][n] = layers[l][8 * n];
      layers[l] = columns[l];
    }
    const int row = axis == 1 ? 64 : 8;
    for (int n = 0; n < 8; ++n) {
      spread(layers, n * row, corner + kStep[u] * place(u, n), kStep[v], place(v, 0) != 0);
    }
  }

  V godunov(V x, V y, V z) const {
    const V low = L::min(x, y);
    const V high = L::max(x, y);
    const V a = L::min(low, z);
    const V rest = L::max(low, z);
    const V p = L::min(L::sub(L::min(rest, high), a), h_);
    const V q = L::sub(L::max(rest, high), a);
    const V d = L::sub(q, p);
    const V gap = L::sub(hh_, L::add(L::mul(q, q), L::mul(d, d)));
    const M three = L::less(zero_, gap);
    const V root = L::sqrt(L::add(L::sub(twice_hh_, L::mul(p, p)), L::max(gap, zero_)));
    const V sum = L::add(L::add(p, L::select(three, q, zero_)), root);
    return L::add(a, L::mul(sum, L::select(three, third_, half_)));
  }

  void solve() {
    V fall = zero_;
    for (const Order::Visit& visit : kOrder.visits) {
      float* const cell = at(visit.cell);
      V behind[3];
      V least[3];
      for (int a = 0; a < 3; ++a) {
        const std::size_t step = static_cast<std::size_t>(kStep[a]) * kWidth;
        behind[a] = L::load(cell - step);
        least[a] = L::min_magnitude(behind[a], L::load(cell + step));
      }
      const V old = L::load(cell);
      const V fresh = L::min(old, godunov(least[0], least[1], least[2]));
      L::store(cell, fresh);
      const V fell = L::sub(old, fresh);
      fall = L::max(fall, fell);
      const M moved = L::less(tolerance_, fell);
      const I turns = L::one_hot(moved, L::less(fresh, behind[0]), L::less(fresh, behind[1]),
                                 L::less(fresh, behind[2]));
      again_[visit.first] = L::either(again_[visit.first], turns);
      if (visit.last != 0) tell_ahead(cell, visit.last, turns);
    }
    L::store(fall_, fall);
  }

  /// For a voxel in a last layer: the octants in which the tiles ahead should hear of its fall.
  /// Where it is the least of three along an axis the front runs both ways.
  void tell_ahead(const float* cell, unsigned last, I turns) {
    const V fresh = L::load(cell);
    M higher[3];
    for (unsigned a = 0; a < 3; ++a) {
      higher[a] = L::less(fresh, L::load(cell + static_cast<std::size_t>(kStep[a]) * kWidth));
      turns = L::either(turns, L::where(higher[a], L::unturned(turns, a)));
    }
    for (unsigned a = 0; a < 3; ++a) {
      if ((last >> a & 1U) != 0) ahead_[a] = L::either(ahead_[a], L::where(higher[a], turns));
    }
  }

  void report() {
    bool any = false;
    float* tiles[kWidth];
    for (std::size_t l = 0; l < kWidth; ++l) {
      tiles[l] = nothing_;
      if (!used(l)) continue;
      batch_.fall[begin_ + l] = fall_[l];
      octants(l);
      if (!(fall_[l] > 0)) continue;
      any = true;
      tiles[l] = batch_.tile[begin_ + l];
    }
    if (!any) return;
    const bool back = (batch_.octant & 4U) != 0;
    for (int n = 0; n < 64; ++n) {
      const int cell = cell_of(place(0, n / 8), place(1, n % 8), 0);
      V row[8];
      for (int k = 0; k < 8; ++k) row[k] = L::load(at(cell + (back ? 7 - k : k)));
      L::untranspose(row, tiles, 8 * n);
    }
  }

  /// From the lane's sets, relative to the running octant, to the batch's.
  void octants(std::size_t lane) {
    unsigned again = 0;
    unsigned behind[3] = {0, 0, 0};
    for (unsigned first = 0; first < 8; ++first) {
      const auto set = static_cast<unsigned>(L::lane(again_[first], lane));
      again |= set & beyond(first);
      for (unsigned a = 0; a < 3; ++a) {
        if ((first >> a & 1U) != 0) behind[a] |= set & kTurned[a];
      }
    }
    batch_.again[begin_ + lane] = turned(again, batch_.octant);
    for (unsigned a = 0; a < 3; ++a) {
      const unsigned ahead = without_turn(static_cast<unsigned>(L::lane(ahead_[a], lane)), a);
      const unsigned back = batch_.octant >> a & 1U;
      batch_.wake[2 * a + back][begin_ + lane] = turned(behind[a], batch_.octant);
      batch_.wake[2 * a + 1 - back][begin_ + lane] = turned(ahead, batch_.octant);
    }
  }

  TileBatch& batch_;
  const std::size_t begin_;
  const V zero_ = L::all(0.0F);
  const V half_ = L::all(0.5F);
  const V third_ = L::all(1.0F / 3.0F);
  const V h_ = L::all(batch_.h);
  const V hh_ = L::all(batch_.h * batch_.h);
  const V twice_hh_ = L::all(2 * (batch_.h * batch_.h));
  const V tolerance_ = L::all(batch_.tolerance);
  I again_[8] = {};  // by the layers that the voxels are first in
  I ahead_[3] = {};
  alignas(64) float fall_[kWidth];
  alignas(64) float nothing_[512];  // where there is no tile: nobody's neighbour
  alignas(64) float cells_[kEdge * kEdge * kEdge * kWidth];
};

template <typename L>
void sweep_batch(TileBatch& batch) {
  for (std::size_t begin = 0; begin < batch.count; begin += L::kWidth) {
    LaneSweep<L>(batch, begin).run();
  }
}

template <typename L>
constexpr std::uint64_t kLaneBits = ~std::uint64_t{0} >> (64 - L::kWidth);

template <typename L>
void encode_tile(float* phi, const TileBits& active, TileBits& sign, TileBits& open) {
  const typename L::V unreached = L::all(kFarAway);
  for (std::size_t word = 0; word < 8; ++word) {
    sign[word] = 0;
    open[word] = 0;
    for (std::size_t bit = 0; bit < 64; bit += L::kWidth) {
      float* const voxels = phi + 64 * word + bit;
      const typename L::V value = L::load_any(voxels);
      const typename L::V size = L::magnitude(value);
      const std::uint64_t on = active[word] >> bit & kLaneBits<L>;
      const std::uint64_t unset = on & ~L::bits(L::less(size, unreached)) & kLaneBits<L>;
      const typename L::V known = L::select(L::mask(on), size, unreached);
      L::store_any(voxels, L::negative_where(L::mask(~unset & kLaneBits<L>), known));
      sign[word] |= L::signs(value) << bit;
      open[word] |= unset << bit;
    }
  }
}

template <typename L>
void decode_tile(float* phi, TileBits& active, const TileBits& sign, float limit) {
  const typename L::V most = L::all(limit);
  for (std::size_t word = 0; word < 8; ++word) {
    std::uint64_t stay = 0;
    for (std::size_t bit = 0; bit < 64; bit += L::kWidth) {
      float* const voxels = phi + 64 * word + bit;
      const typename L::V size = L::magnitude(L::load_any(voxels));
      const std::uint64_t on = active[word] >> bit & ~L::bits(L::less(most, size)) & kLaneBits<L>;
      const typename L::V known = L::select(L::mask(on), size, most);
      const std::uint64_t negative = sign[word] >> bit & kLaneBits<L>;
      L::store_any(voxels, L::negative_where(L::mask(negative), known));
      stay |= on << bit;
    }
    active[word] = stay;
  }
}

template <typename L>
constexpr Kernels kKernels{L::kWidth, sweep_batch<L>, encode_tile<L>, decode_tile<L>};

}  // namespace
}  // namespace vdb_offset
