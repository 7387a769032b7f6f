#include "sweep/wavefront.h"

#include <algorithm>
#include <limits>
#include <mutex>

namespace vdb_offset {

void Wavefront::begin(unsigned octant) {
  const std::lock_guard guard(lock_);
  octant_ = octant;
  planes_ = static_cast<int>(schedule_.planes(octant));
  plane_ = -1;
  rest_ = {nullptr, nullptr};
}

bool Wavefront::is_over() {
  const std::lock_guard guard(lock_);
  return rest_.begin == rest_.end && plane_ + 1 >= planes_ &&
         std::all_of(members_.begin(), members_.end(),
                     [](const Member& m) { return m.parts[0].plane == Part::kNone; });
}

std::size_t Wavefront::visits() {
  const std::lock_guard guard(lock_);
  return visits_;
}

std::size_t Wavefront::take(std::size_t member, std::array<int, TileBatch::kMost>& tiles) {
  const std::lock_guard guard(lock_);
  Member& own = members_[member];
  own = {};
  const bool from_end = member % 2 != 0;
  std::size_t count = 0;
  for (Part& part : own.parts) {
    std::size_t more = 0;
    while (more == 0 && (rest_.begin != rest_.end || next_plane())) {
      const std::span<int> room = std::span(tiles).subspan(count);
      more = cut(from_end, room);
      if (more == 0 && count == 0) more = cut(!from_end, room);
      if (rest_.begin != rest_.end) break;  // what is left has to wait
    }
    if (more == 0) break;
    const auto [least, most] = std::minmax(tiles[count], tiles[count + more - 1]);
    part = {plane_, schedule_.beside(least, most)};
    count += more;
    if (count == tiles.size() || rest_.begin != rest_.end) break;
  }
  visits_ += count;
  return count;
}

bool Wavefront::next_plane() {
  if (plane_ + 1 >= planes_) return false;
  rest_ = schedule_.plane(octant_, static_cast<std::size_t>(++plane_));
  return true;
}

/// Where tiles of the hyperplane at hand may have a neighbour that is out.
TileSchedule::Span Wavefront::blocked() const {
  TileSchedule::Span all{std::numeric_limits<int>::max(), 0};
  for (const Member& member : members_) {
    for (const Part& part : member.parts) {
      if (part.plane != plane_ - 1) continue;
      all.begin = std::min(all.begin, part.beside.begin);
      all.end = std::max(all.end, part.beside.end);
    }
  }
  return all;
}

/// Tiles that are awake, from one end of the hyperplane at hand, as far as it is not blocked.
std::size_t Wavefront::cut(bool from_end, std::span<int> tiles) {
  const TileSchedule::Span blocked = this->blocked();
  std::size_t count = 0;
  while (count < tiles.size() && rest_.begin != rest_.end) {
    const int tile = from_end ? rest_.end[-1] : *rest_.begin;
    if (from_end ? tile < blocked.end : tile >= blocked.begin) break;
    if (schedule_.awake(static_cast<std::size_t>(tile), octant_)) tiles[count++] = tile;
    if (from_end) {
      --rest_.end;
    } else {
      ++rest_.begin;
    }
  }
  return count;
}

}  // namespace vdb_offset
