// In corners too sharp for the columns beside them to be turned along the bisector columns end
// before it.

#include <algorithm>
#include <limits>

#include "blocks/window_repair.h"
#include "vdb_offset/march/room_at.h"

namespace vdb_offset {
namespace {

/// Rise of the distance along the bisector of such a corner: 17 degrees where columns reach the
/// distance, 53 where they do not, or could not be made valid at it.
constexpr double kLeastRise = 0.15;
constexpr double kLeastRiseShort = 0.45;
constexpr double kOfRoom = 0.9;  // of the height where they meet the bisector

std::size_t at(int index) { return static_cast<std::size_t>(index); }

}  // namespace

/// Whether another wall is nearer to a place as high again as a level of a column.
bool WindowRepair::is_between(std::size_t slot, std::size_t level) const {
  constexpr double kNearer = 1.5;  // times the height: it is 2 where there is no other wall
  const Vec3 place = shape_.points_world.get(slot, level);
  const WallPoint wall = surface_.wall->closest_place(place);
  const Vec3 as_high_again = place + (place - wall.point_world);
  return surface_.wall->closest_place(as_high_again).distance_world < kNearer * wall.distance_world;
}

/// The level from which on a column follows the bisector of a sharp corner, for as long as it takes
/// to be several times as high, and there is a wall on its other side (it rises as slowly for a
/// while also where the field bends); the last one if it follows none.
std::size_t WindowRepair::follows_bisector(std::size_t slot) const {
  constexpr double kWhile = 4;
  const std::vector<double>& heights = shape_.heights_world[slot];
  const std::size_t last = heights.size() - 1;
  std::vector<double> along(heights.size(), 0.0);
  for (std::size_t k = 1; k <= last; ++k) {
    along[k] = along[k - 1] +
               (shape_.points_world.get(slot, k) - shape_.points_world.get(slot, k - 1)).norm();
  }
  const auto is_slow = [&](std::size_t from, std::size_t to) {
    return heights[to] - heights[from] < kLeastRiseShort * (along[to] - along[from]);
  };
  std::size_t later = 0;
  std::size_t between = 0;  // the first level that may be
  for (std::size_t k = 0; k < last; ++k) {
    later = std::max(later, k + 1);
    while (later < last && heights[later] < kWhile * heights[k]) ++later;
    if (!is_slow(k, k + 1) || !is_slow(k, later)) continue;
    between = std::max(between, k + 1);
    while (between <= later && !is_between(slot, between)) ++between;
    if (between <= later) return k;
  }
  return last;
}

/// The height at which a column meets the bisector of a sharp corner, 0 where it stands in the
/// corner itself. Over columns that reach the distance that is the wall's, straight over them;
/// others may meet several walls, and do so where they follow a bisector, or, where coarse voxels
/// bend them too soon, straight over that level.
std::optional<double> WindowRepair::meets_bisector(std::size_t slot, Sharp which) const {
  constexpr double kOnIt = 1.01;
  constexpr double kAhead = 7;  // times the height
  const std::vector<double>& heights = shape_.heights_world[slot];
  const double rise = which == Sharp::All ? kLeastRiseShort : kLeastRise;
  const auto place = [&](std::size_t level) { return shape_.points_world.get(slot, level); };
  if (layers_.stop[at(shape_.window.nodes[slot])] == Stop::Reached) {
    const auto met = bisector_at(surface_, place(1), rise, heights.back());
    return met && *met < kOnIt * heights[1] ? 0 : met;
  }
  const std::size_t level = follows_bisector(slot);
  if (level == 0) return 0;
  if (level == heights.size() - 1) return std::nullopt;
  const auto over = bisector_at(surface_, place(level), kLeastRiseShort, kAhead * heights[level]);
  return over.value_or(heights[level]);
}

/// Columns that run into the bisector of a sharp corner end before it. Returns how many.
std::ptrdiff_t WindowRepair::cap_sharp_corners(Sharp which) {
  constexpr double kNone = std::numeric_limits<double>::infinity();
  std::vector<double> height = asked_;
  std::vector<bool> in_corner(shape_.window.free, false);  // from the wall on
  std::ptrdiff_t capped = 0;
  for (std::size_t s = 0; s < shape_.window.free; ++s) {
    const std::optional<double> bisector = meets_bisector(s, which);
    if (!bisector) continue;
    ++capped;
    in_corner[s] = *bisector == 0;
    height[s] = in_corner[s] ? kNone : kOfRoom * *bisector;
  }
  if (capped == 0) return 0;
  // In the corner itself there is as much as its lowest neighbour has, but for those of no height.
  std::vector<double> beside = height;
  std::replace(beside.begin(), beside.end(), 0.0, kNone);
  for (const ColumnFace& face : shape_.window.faces) {
    for (std::size_t c = 0; c < face.count; ++c) {
      const std::size_t s = at(face.column[c]);
      if (s >= shape_.window.free || !in_corner[s]) continue;
      height[s] = std::min({height[s], beside[at(face.next(c))], beside[at(face.previous(c))]});
    }
  }
  for (std::size_t s = 0; s < shape_.window.free; ++s) height[s] = std::min(height[s], asked_[s]);
  sink_to(height);
  return capped;
}

}  // namespace vdb_offset
