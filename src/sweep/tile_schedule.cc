// Hyperplane (wavefront) order after Detrixhe, Gibou, Min, A parallel fast sweeping method for the
// eikonal equation, 2013, here over leaf tiles.

#include "sweep/tile_schedule.h"

#include <algorithm>
#include <bit>
#include <map>
#include <numeric>
#include <utility>

#include "core/parallel.h"

namespace vdb_offset {

namespace {

constexpr int kLog2 = 3;
constexpr int kSide = 16;  // leaves along the edge of a node
constexpr std::size_t kSlots = std::size_t{kSide} * kSide * kSide;
constexpr openvdb::Int32 kSpan = kSide << kLog2;  // voxels along it

}  // namespace

/// Leaves of a node at one x.
struct TileSchedule::Slab {
  const Lower* node;
  std::size_t number;  // of the node
  int x;               // in the node
  std::size_t first;

  std::uint64_t word(std::size_t n) const {
    constexpr std::size_t kWords = kSide * kSide / 64;
    const std::size_t at = static_cast<std::size_t>(x) * kWords + n;
    return node->getChildMask().getWord<std::uint64_t>(static_cast<openvdb::Index>(at));
  }
  /// body(slot in the node, tile)
  template <typename Body>
  void for_tiles(const Body& body) const {
    std::size_t t = first;
    for (std::size_t n = 0; n < 4; ++n) {
      for (std::uint64_t bits = word(n); bits != 0; bits &= bits - 1) {
        body(x * kSide * kSide + static_cast<int>(64 * n) + std::countr_zero(bits), t++);
      }
    }
  }
};

TileSchedule::TileSchedule(openvdb::FloatTree& tree) {
  tree.getNodes(nodes_);
  std::sort(nodes_.begin(), nodes_.end(),
            [](const Lower* a, const Lower* b) { return a->origin() < b->origin(); });
  collect();
  connect();
  awake_.resize(size());
  ordered_.resize(kFamilies * size());
}

TileSchedule::~TileSchedule() = default;

/// Tiles in the order of x: each thread's part of a hyperplane then lies at the same end of all of
/// them, more or less, and what is far apart in it has no neighbours in common.
void TileSchedule::collect() {
  std::size_t count = 0;
  for (std::size_t begin = 0, end = 0; begin < nodes_.size(); begin = end) {
    while (end < nodes_.size() && nodes_[end]->origin().x() == nodes_[begin]->origin().x()) ++end;
    for (int x = 0; x < kSide; ++x) {
      layers_.push_back(static_cast<int>(count));
      for (std::size_t n = begin; n < end; ++n) {
        const Slab& slab = slabs_.emplace_back(Slab{nodes_[n], n, x, count});
        for (std::size_t w = 0; w < 4; ++w) {
          count += static_cast<std::size_t>(std::popcount(slab.word(w)));
        }
      }
    }
  }
  layers_.push_back(static_cast<int>(count));
  tiles_.resize(count);
  parallel::for_ranges(slabs_.size(), 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t n = begin; n < end; ++n) {
      slabs_[n].for_tiles([&](int slot, std::size_t t) {
        tiles_[t].leaf = const_cast<Leaf*>(slabs_[n].node->getTable()[slot].getChild());
      });
    }
  });
}

void TileSchedule::connect() {
  // A dense table of each node's leaves (half the size of the node itself): a neighbour is a step
  // in the table, and a search only for the node next door.
  std::map<openvdb::Coord, std::size_t> node_at;
  for (std::size_t n = 0; n < nodes_.size(); ++n) node_at.emplace(nodes_[n]->origin(), n);
  WholeLargeVector<int> table(nodes_.size() * kSlots, -1);
  const auto for_slabs = [&](const auto& body) {
    parallel::for_ranges(slabs_.size(), 1, [&](std::size_t begin, std::size_t end) {
      for (std::size_t n = begin; n < end; ++n) {
        slabs_[n].for_tiles([&](int slot, std::size_t t) { body(slabs_[n].number, slot, t); });
      }
    });
  };
  for_slabs([&](std::size_t n, int slot, std::size_t t) {
    table[n * kSlots + static_cast<std::size_t>(slot)] = static_cast<int>(t);
  });
  for_slabs([&](std::size_t n, int slot, std::size_t t) {
    const std::array<int, 3> place{slot >> 8, slot >> 4 & 15, slot & 15};
    for (std::size_t face = 0; face < kFaces; ++face) {
      const std::size_t axis = face / 2;
      const int step = face % 2 == 0 ? -1 : 1;
      const int stride = 1 << (4 * (2 - axis));
      const int next = place[axis] + step;
      std::size_t there = n;
      int beside = slot + step * stride;
      tiles_[t].neighbour[face] = -1;
      if (next < 0 || next >= kSide) {
        openvdb::Coord origin = nodes_[n]->origin();
        origin[static_cast<int>(axis)] += step * kSpan;
        const auto found = node_at.find(origin);
        if (found == node_at.end()) continue;
        there = found->second;
        beside -= step * stride * kSide;
      }
      tiles_[t].neighbour[face] = table[there * kSlots + static_cast<std::size_t>(beside)];
    }
  });
}

std::size_t TileSchedule::family(unsigned octant) {
  // The planes of x + sy y + sz z; an octant and its opposite have the same.
  return ((octant ^ (octant >> 1U)) & 1U) | ((octant ^ (octant >> 2U)) & 1U) << 1U;
}

void TileSchedule::order(std::size_t family) {
  // A node's leaves lie in a run of planes; runs that overlap are joined, so that the numbers of
  // planes are dense even where bodies are far apart.
  const int sy = (family & 1U) != 0 ? -1 : 1;
  const int sz = (family & 2U) != 0 ? -1 : 1;
  constexpr std::int64_t kRun = 3 * (kSide - 1) + 1;
  std::vector<std::pair<std::int64_t, std::size_t>> runs;
  for (std::size_t n = 0; n < nodes_.size(); ++n) {
    const openvdb::Coord c = nodes_[n]->origin() >> kLog2;
    runs.emplace_back(std::int64_t{c.x()} + (sy > 0 ? c.y() : -std::int64_t{c.y()} - (kSide - 1)) +
                          (sz > 0 ? c.z() : -std::int64_t{c.z()} - (kSide - 1)),
                      n);
  }
  std::sort(runs.begin(), runs.end());
  std::vector<std::size_t> start(nodes_.size());  // number of the first plane of each node's run
  std::size_t number = 0;
  for (std::size_t r = 0; r < runs.size(); ++r) {
    if (r > 0)
      number += static_cast<std::size_t>(std::min(kRun, runs[r].first - runs[r - 1].first));
    start[runs[r].second] = number;
  }
  std::vector<std::size_t> first(number + kRun + 1, 0);
  const auto for_tiles = [&](const auto& body) {
    for (const Slab& slab : slabs_) {
      slab.for_tiles([&](int slot, std::size_t t) {
        const int y = slot >> 4 & 15;
        const int z = slot & 15;
        const int plane = slab.x + (sy > 0 ? y : 15 - y) + (sz > 0 ? z : 15 - z);
        body(static_cast<int>(t), start[slab.number] + static_cast<std::size_t>(plane));
      });
    }
  };
  for_tiles([&](int, std::size_t plane) { ++first[plane + 1]; });
  std::partial_sum(first.begin(), first.end(), first.begin());
  first_[family] = first;
  int* const tiles = ordered_.data() + family * size();
  for_tiles([&](int t, std::size_t plane) { tiles[first[plane]++] = t; });
}

std::size_t TileSchedule::planes(unsigned octant) const {
  return first_[family(octant)].size() - 1;
}

TileSchedule::Plane TileSchedule::plane(unsigned octant, std::size_t number) const {
  const std::size_t f = family(octant);
  const std::size_t p = octant_step(octant, 0) > 0 ? number : planes(octant) - 1 - number;
  const int* const tiles = ordered_.data() + f * size();
  return {tiles + first_[f][p], tiles + first_[f][p + 1]};
}

TileSchedule::Span TileSchedule::beside(int least, int most) const {
  const auto after = [&](int tile) {
    return std::upper_bound(layers_.begin(), layers_.end(), tile);
  };
  const auto first = after(least) - layers_.begin();
  const auto last = after(most);
  return {layers_[static_cast<std::size_t>(std::max(first - 2, std::ptrdiff_t{0}))],
          last + 1 < layers_.end() ? last[1] : layers_.back()};
}

bool TileSchedule::any_awake(OctantSet octants) const {
  unsigned all = 0;  // of all of them: that goes sixty-four at a time
  for (const std::uint8_t awake : awake_) all |= awake;
  return (all & octants) != 0;
}

}  // namespace vdb_offset
