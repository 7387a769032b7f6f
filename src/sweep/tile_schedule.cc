// Hyperplane (wavefront) order after Detrixhe, Gibou, Min, A parallel fast sweeping method for the
// eikonal equation, 2013, here over leaf tiles.

#include "sweep/tile_schedule.h"

#include <algorithm>
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

TileSchedule::TileSchedule(openvdb::FloatTree& tree) {
  std::vector<Lower*> nodes;
  tree.getNodes(nodes);
  collect(nodes);
  connect(nodes);
  awake_ = std::make_unique<std::atomic<std::uint8_t>[]>(tiles_.size());
  parallel::for_ranges(orders_.size(), 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t f = begin; f < end; ++f) order(nodes, f);
  });
}

void TileSchedule::collect(const std::vector<Lower*>& nodes) {
  std::size_t count = 0;
  for (const Lower* node : nodes) {
    first_.push_back(count);
    count += node->getChildMask().countOn();
  }
  tiles_.resize(count);
  leaves_.resize(count);
  parallel::for_ranges(nodes.size(), 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t n = begin; n < end; ++n) {
      std::size_t t = first_[n];
      for (auto child = nodes[n]->beginChildOn(); child; ++child, ++t) {
        leaves_[t] = &*child;
        tiles_[t].phi = child->buffer().data();
      }
    }
  });
}

void TileSchedule::connect(const std::vector<Lower*>& nodes) {
  // A dense table of each node's leaves (half the size of the node itself): a neighbour is a step
  // in the table, and a search only for the node next door.
  std::map<openvdb::Coord, std::size_t> node_at;
  for (std::size_t n = 0; n < nodes.size(); ++n) node_at.emplace(nodes[n]->origin(), n);
  std::vector<int> table(nodes.size() * kSlots, -1);
  const auto for_nodes = [&](const auto& body) {
    parallel::for_ranges(nodes.size(), 1, [&](std::size_t begin, std::size_t end) {
      for (std::size_t n = begin; n < end; ++n) {
        auto t = static_cast<int>(first_[n]);
        for (auto child = nodes[n]->cbeginChildOn(); child; ++child) body(n, child.pos(), t++);
      }
    });
  };
  for_nodes([&](std::size_t n, std::size_t at, int t) { table[n * kSlots + at] = t; });
  for_nodes([&](std::size_t n, std::size_t at, int t) {
    const auto c = static_cast<int>(at);
    const std::array<int, 3> place{c >> 8, c >> 4 & 15, c & 15};
    for (std::size_t face = 0; face < kFaces; ++face) {
      const std::size_t axis = face / 2;
      const int step = face % 2 == 0 ? -1 : 1;
      const int stride = 1 << (4 * (2 - axis));
      const int next = place[axis] + step;
      std::size_t there = n;
      int slot = c + step * stride;
      if (next < 0 || next >= kSide) {
        openvdb::Coord origin = nodes[n]->origin();
        origin[static_cast<int>(axis)] += step * kSpan;
        const auto found = node_at.find(origin);
        if (found == node_at.end()) continue;
        there = found->second;
        slot -= step * stride * kSide;
      }
      tiles_[static_cast<std::size_t>(t)].neighbour[face] =
          table[there * kSlots + static_cast<std::size_t>(slot)];
    }
  });
}

std::size_t TileSchedule::family(unsigned octant) {
  // The planes of x + sy y + sz z; an octant and its opposite have the same.
  return ((octant ^ (octant >> 1U)) & 1U) | ((octant ^ (octant >> 2U)) & 1U) << 1U;
}

void TileSchedule::order(const std::vector<Lower*>& nodes, std::size_t family) {
  // A node's leaves lie in a run of planes; runs that overlap are joined, so that the numbers of
  // planes are dense even where bodies are far apart.
  const int sy = (family & 1U) != 0 ? -1 : 1;
  const int sz = (family & 2U) != 0 ? -1 : 1;
  constexpr std::int64_t kRun = 3 * (kSide - 1) + 1;
  std::vector<std::pair<std::int64_t, std::size_t>> runs;
  for (std::size_t n = 0; n < nodes.size(); ++n) {
    const openvdb::Coord c = nodes[n]->origin() >> kLog2;
    runs.emplace_back(std::int64_t{c.x()} + (sy > 0 ? c.y() : -std::int64_t{c.y()} - (kSide - 1)) +
                          (sz > 0 ? c.z() : -std::int64_t{c.z()} - (kSide - 1)),
                      n);
  }
  std::sort(runs.begin(), runs.end());
  std::vector<std::size_t> start(nodes.size());  // number of the first plane of each node's run
  std::size_t number = 0;
  for (std::size_t r = 0; r < runs.size(); ++r) {
    if (r > 0)
      number += static_cast<std::size_t>(std::min(kRun, runs[r].first - runs[r - 1].first));
    start[runs[r].second] = number;
  }
  std::vector<std::size_t> first(number + kRun + 1, 0);
  const auto for_tiles = [&](const auto& body) {
    int t = 0;
    for (std::size_t n = 0; n < nodes.size(); ++n) {
      for (auto child = nodes[n]->cbeginChildOn(); child; ++child) {
        const auto at = static_cast<int>(child.pos());
        const int y = at >> 4 & 15;
        const int z = at & 15;
        const int plane = (at >> 8) + (sy > 0 ? y : 15 - y) + (sz > 0 ? z : 15 - z);
        body(t++, start[n] + static_cast<std::size_t>(plane));
      }
    }
  };
  for_tiles([&](int, std::size_t plane) { ++first[plane + 1]; });
  std::partial_sum(first.begin(), first.end(), first.begin());
  Order& order = orders_[family];
  order.first = first;
  order.tiles.resize(tiles_.size());
  for_tiles([&](int t, std::size_t plane) { order.tiles[first[plane]++] = t; });
}

std::size_t TileSchedule::planes(unsigned octant) const {
  return orders_[family(octant)].first.size() - 1;
}

TileSchedule::Plane TileSchedule::plane(unsigned octant, std::size_t number) const {
  const Order& order = orders_[family(octant)];
  const std::size_t p = octant_step(octant, 0) > 0 ? number : order.first.size() - 2 - number;
  return {order.tiles.data() + order.first[p], order.tiles.data() + order.first[p + 1]};
}

bool TileSchedule::any_awake(OctantSet octants) const {
  return std::any_of(awake_.get(), awake_.get() + tiles_.size(),
                     [&](const std::atomic<std::uint8_t>& a) {
                       return (a.load(std::memory_order_relaxed) & octants) != 0;
                     });
}

}  // namespace vdb_offset
