#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include "core/parallel.h"
#include "sweep/kernel.h"
#include "sweep/tile_schedule.h"

namespace vdb_offset {

/// One octant's way through the tiles. Hyperplane after hyperplane is given out to the members of a
/// crew, in batches, without a halt between them: a tile goes out as soon as its upwind tiles are
/// done. What is visited, and what each visit sees, does not depend on the members.
///
/// Members take from both ends of a hyperplane, even ones from the first and odd ones from the
/// last: tiles are in the order of x, so that each end stays in the cache of one core.
class Wavefront {
 public:
  Wavefront(TileSchedule& schedule, std::size_t members) : schedule_(schedule), members_(members) {}

  /// The next octant; the last one has to be over.
  void begin(unsigned octant);
  /// Gives back what the member took before, done, and takes up to TileBatch::kMost tiles that are
  /// awake, no two of them neighbours, nor of one that is out. Their number; 0: none, at present.
  /// Any thread.
  std::size_t take(std::size_t member, std::array<int, TileBatch::kMost>& tiles);
  /// Whether every tile was seen, and those taken are given back. Any thread.
  bool is_over();
  /// Tiles given out, of all octants. Any thread.
  std::size_t visits();

 private:
  /// Tiles of one hyperplane that are out: no others than [begin, end) have one as a neighbour.
  struct Part {
    static constexpr int kNone = -2;
    int plane = kNone;
    TileSchedule::Span beside{};
  };
  /// Of one hyperplane, and of one after it.
  struct alignas(64) Member {
    std::array<Part, 2> parts;
  };
  bool next_plane();
  TileSchedule::Span blocked() const;
  std::size_t cut(bool from_end, std::span<int> tiles);

  TileSchedule& schedule_;
  std::vector<Member> members_;
  // What all members write, in one line of cache.
  alignas(64) parallel::SpinLock lock_;
  unsigned octant_ = 0;
  int planes_ = 0;
  int plane_ = 0;
  TileSchedule::Plane rest_{nullptr, nullptr};  // of the hyperplane at hand
  std::size_t visits_ = 0;
};

}  // namespace vdb_offset
