// Hyperplane (wavefront) order after Detrixhe, Gibou, Min, A parallel fast sweeping method for the
// eikonal equation, 2013, here over leaf tiles; waking only tiles whose neighbours changed after
// Jeong and Whitaker, A fast iterative method for eikonal equations, 2008.

#include "sweep/tile_schedule.h"

#include <algorithm>
#include <unordered_map>

#include "vdb_offset/rasterize/rasterize.h"

namespace vdb_offset {

namespace {

constexpr int kLog2 = 3;

openvdb::Coord tile_coord(const TileSchedule::Leaf& leaf) { return leaf.origin() >> kLog2; }

}  // namespace

TileSchedule::TileSchedule(openvdb::FloatTree& tree) {
  tiles_.reserve(tree.leafCount());
  for (auto it = tree.beginLeaf(); it; ++it) {
    Tile tile;
    tile.leaf = &*it;
    const float* phi = tile.leaf->buffer().data();
    for (auto on = tile.leaf->cbeginValueOn(); on; ++on) {
      if (std::abs(phi[on.pos()]) >= Band::kUnreached) tile.open.setOn(on.pos());
    }
    tiles_.push_back(tile);
  }
  awake_ = std::make_unique<std::atomic<std::uint8_t>[]>(tiles_.size());
  connect();
  for (std::size_t f = 0; f < orders_.size(); ++f) order(f);
}

void TileSchedule::connect() {
  std::unordered_map<openvdb::Coord, int, std::hash<openvdb::Coord>> index;
  index.reserve(tiles_.size());
  for (std::size_t t = 0; t < tiles_.size(); ++t) {
    index.emplace(tile_coord(*tiles_[t].leaf), static_cast<int>(t));
  }
  const std::array<openvdb::Coord, 6> steps{
      {{-1, 0, 0}, {1, 0, 0}, {0, -1, 0}, {0, 1, 0}, {0, 0, -1}, {0, 0, 1}}};
  for (Tile& tile : tiles_) {
    for (std::size_t s = 0; s < 6; ++s) {
      const auto found = index.find(tile_coord(*tile.leaf) + steps[s]);
      if (found != index.end()) tile.neighbour[s] = found->second;
    }
  }
}

std::size_t TileSchedule::family(const Octant& octant) {
  // The planes of x + sy y + sz z; an octant and its opposite have the same.
  return (octant.x * octant.y < 0 ? 1U : 0U) + (octant.x * octant.z < 0 ? 2U : 0U);
}

void TileSchedule::order(std::size_t family) {
  const int sy = (family & 1U) != 0 ? -1 : 1;
  const int sz = (family & 2U) != 0 ? -1 : 1;
  struct Key {
    std::int64_t plane;
    int tile;
  };
  std::vector<Key> keys;
  keys.reserve(tiles_.size());
  for (std::size_t t = 0; t < tiles_.size(); ++t) {
    const openvdb::Coord c = tile_coord(*tiles_[t].leaf);
    keys.push_back({static_cast<std::int64_t>(c.x()) + sy * static_cast<std::int64_t>(c.y()) +
                        sz * static_cast<std::int64_t>(c.z()),
                    static_cast<int>(t)});
  }
  std::sort(keys.begin(), keys.end(), [](const Key& a, const Key& b) {
    return a.plane != b.plane ? a.plane < b.plane : a.tile < b.tile;
  });
  Order& order = orders_[family];
  for (std::size_t k = 0; k < keys.size(); ++k) {
    if (k == 0 || keys[k].plane != keys[k - 1].plane) order.first.push_back(k);
    order.tiles.push_back(keys[k].tile);
  }
  order.first.push_back(keys.size());
}

std::size_t TileSchedule::planes(const Octant& octant) const {
  return orders_[family(octant)].first.size() - 1;
}

TileSchedule::Plane TileSchedule::plane(const Octant& octant, std::size_t number) const {
  const Order& order = orders_[family(octant)];
  const std::size_t p = octant.x > 0 ? number : order.first.size() - 2 - number;
  return {order.tiles.data() + order.first[p], order.tiles.data() + order.first[p + 1]};
}

void TileSchedule::wake(int tile, std::uint8_t mask) {
  awake_[static_cast<std::size_t>(tile)].fetch_or(mask, std::memory_order_relaxed);
}

bool TileSchedule::take(int tile, int octant) {
  const auto bit = static_cast<std::uint8_t>(1U << static_cast<unsigned>(octant));
  auto& awake = awake_[static_cast<std::size_t>(tile)];
  if ((awake.load(std::memory_order_relaxed) & bit) == 0) return false;
  awake.fetch_and(static_cast<std::uint8_t>(~bit), std::memory_order_relaxed);
  return true;
}

bool TileSchedule::any_awake() const {
  return std::any_of(awake_.get(), awake_.get() + tiles_.size(),
                     [](const std::atomic<std::uint8_t>& a) { return a.load() != 0; });
}

}  // namespace vdb_offset
