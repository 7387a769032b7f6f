#pragma once

#include <openvdb/openvdb.h>

#include <array>
#include <atomic>
#include <cstdint>
#include <vector>

#include "core/large_vector.h"
#include "sweep/kernel.h"

namespace vdb_offset {

/// The leaf tiles of a band as a graph, and the order in which octants visit them.
class TileSchedule {
 public:
  using Leaf = openvdb::FloatTree::LeafNodeType;

  struct Tile {
    Leaf* leaf;
    float* phi;                         ///< its buffer, once `find_buffer` was called
    std::array<int, kFaces> neighbour;  ///< -x, +x, -y, +y, -z, +z; -1: none
  };

  /// Who is next to whom. The octants' orders are still to be made, before `plane` is asked for.
  explicit TileSchedule(openvdb::FloatTree& tree);
  ~TileSchedule();
  TileSchedule(const TileSchedule&) = delete;
  TileSchedule& operator=(const TileSchedule&) = delete;

  /// Octants that are opposite share an order: number `family` of kFamilies. Each once; side by
  /// side, and beside whatever is done to the leaves.
  static constexpr std::size_t kFamilies = 4;
  void order(std::size_t family);

  std::size_t size() const { return tiles_.size(); }
  const Tile& tile(std::size_t t) const { return tiles_[t]; }
  /// Left to the caller, who is the first to look at the leaves.
  void find_buffer(std::size_t t) { tiles_[t].phi = tiles_[t].leaf->buffer().data(); }

  /// Tile indices of hyperplane `plane` of an octant, in order; tiles of one plane share no face.
  struct Plane {
    const int* begin;
    const int* end;
  };
  std::size_t planes(unsigned octant) const;
  Plane plane(unsigned octant, std::size_t number) const;

  /// Tile indices are in the order of x. Those of the layers of one x from before that of `least`
  /// to after that of `most`: no others have a neighbour between the two.
  struct Span {
    int begin;
    int end;
  };
  Span beside(int least, int most) const;

  /// Ask for visits of a tile in some octants. Any thread.
  void wake(std::size_t tile, OctantSet octants) {
    requests(tile).fetch_or(static_cast<std::uint8_t>(octants), std::memory_order_relaxed);
  }
  bool awake(std::size_t tile, unsigned octant) {
    return (requests(tile).load(std::memory_order_relaxed) >> octant & 1U) != 0;
  }
  /// Take all requests back.
  void calm(std::size_t tile) { requests(tile).store(0, std::memory_order_relaxed); }
  /// Whether a tile waits for a visit in one of the octants. While nobody wakes or calms one.
  bool any_awake(OctantSet octants) const;

 private:
  using Lower = openvdb::FloatTree::RootNodeType::ChildNodeType::ChildNodeType;
  static std::size_t family(unsigned octant);
  struct Slab;
  void collect();
  void connect();
  std::atomic_ref<std::uint8_t> requests(std::size_t tile) {
    return std::atomic_ref<std::uint8_t>(awake_[tile]);
  }

  std::vector<const Lower*> nodes_;
  std::vector<Slab> slabs_;
  WholeLargeVector<Tile> tiles_;
  std::vector<int> layers_;  // first tile of each x, and the end
  // An octant reads the order of its opposite backwards; orders stand one after the other.
  WholeLargeVector<int> ordered_;
  // Of each plane in its order, and the end.
  std::array<std::vector<std::size_t>, kFamilies> first_;
  std::vector<std::uint8_t> awake_;  // octants that are asked for
};

}  // namespace vdb_offset
