#pragma once

#include <openvdb/openvdb.h>

#include <array>
#include <atomic>
#include <cstdint>
#include <memory>
#include <vector>

#include "sweep/tile_sweep.h"

namespace vdb_offset {

/// The leaf tiles of a band as a graph, and the order in which octants visit them.
class TileSchedule {
 public:
  using Leaf = openvdb::FloatTree::LeafNodeType;

  struct Tile {
    Leaf* leaf = nullptr;
    std::array<int, 6> neighbour{-1, -1, -1, -1, -1, -1};  ///< -x, +x, -y, +y, -z, +z
    openvdb::util::NodeMask<3> open;  ///< voxels that sweeping may change: active and no seed
  };

  explicit TileSchedule(openvdb::FloatTree& tree);

  std::vector<Tile>& tiles() { return tiles_; }
  const std::vector<Tile>& tiles() const { return tiles_; }

  /// Tile indices of hyperplane `plane` of an octant; tiles of one plane share no face.
  struct Plane {
    const int* begin;
    const int* end;
  };
  std::size_t planes(const Octant& octant) const;
  Plane plane(const Octant& octant, std::size_t number) const;

  /// Ask for a visit of `tile` in the octants of `mask` (bit o is octant o). Any thread.
  void wake(int tile, std::uint8_t mask);
  /// Take the request for one octant back; true if there was one.
  bool take(int tile, int octant);
  bool any_awake() const;

 private:
  struct Order {
    std::vector<int> tiles;
    std::vector<std::size_t> first;  // of each plane, and the end
  };
  static std::size_t family(const Octant& octant);
  void connect();
  void order(std::size_t family);

  std::vector<Tile> tiles_;
  std::array<Order, 4> orders_;  // octants that are opposite share one, read backwards
  std::unique_ptr<std::atomic<std::uint8_t>[]> awake_;
};

}  // namespace vdb_offset
