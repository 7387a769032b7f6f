// Untangling trades heights against shapes, each by its weight; where cells are good enough it need
// not have: what levels miss is made good along the columns, which hardly changes shapes.

#include "blocks/meet_heights.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "blocks/improve.h"
#include "blocks/keep_sides.h"
#include "blocks/nearest_image.h"
#include "core/parallel.h"

namespace vdb_offset {
namespace {

constexpr std::size_t kGrain = 16;        // columns
constexpr double kMet = 1e-9;             // of a height: near enough
constexpr double kLeastRise = 0.05;       // of the distance along a column
constexpr double kFarthest = 0.45;        // of the thinner layer beside a level
constexpr double kMostLoss = 0.1;         // of a face's quality
constexpr double kMostLossOfFirst = 0.2;  // for a first cell as high as was asked
constexpr int kSearches = 4;
constexpr int kRounds = 16;

std::size_t at(int index) { return static_cast<std::size_t>(index); }

/// Levels of one column, each where its distance is met along the column.
class Meeting {
 public:
  Meeting(const Surface& surface, const WindowShape& shape, std::size_t slot)
      : surface_(surface),
        shape_(shape),
        slot_(slot),
        on_(surface.boundaries_of(at(shape.window.nodes[slot]))) {}

  Vec3 find(std::size_t level) {
    // The first cell keeps its direction.
    const std::size_t top = std::min(level + (level > 1 ? 1 : 0), shape_.points_world.levels() - 1);
    const Vec3 start = point(level);
    const Vec3 along = (point(top) - point(level - 1)).normalized();
    const double height = heights()[level];
    const double most = kFarthest * thinner_layer(level);
    double way = 0;
    Vec3 place = start;
    Vec3 best = start;
    double least_off = std::numeric_limits<double>::infinity();
    for (int n = 0; n < kSearches; ++n) {
      const WallPoint near = nearest_image(surface_, place, guess_);
      const double off = height - near.distance_world;
      if (std::abs(off) < least_off) {
        least_off = std::abs(off);
        best = place;
      }
      const double rise = (place - near.point_world).dot(along) / near.distance_world;
      if (least_off <= kMet * height || !(rise > kLeastRise)) break;
      way = std::clamp(way + off / rise, -most, most);
      place = moved_inside(surface_, on_, start, start + way * along);
    }
    return best;
  }

 private:
  const std::vector<double>& heights() const { return shape_.heights_world[slot_]; }
  Vec3 point(std::size_t level) const { return shape_.points_world.get(slot_, level); }
  double thinner_layer(std::size_t level) const {
    const double below = (point(level) - point(level - 1)).norm();
    if (level + 1 == shape_.points_world.levels()) return below;
    return std::min(below, (point(level + 1) - point(level)).norm());
  }

  const Surface& surface_;
  const WindowShape& shape_;
  std::size_t slot_;
  BoundarySet on_;
  int guess_ = -1;
};

/// What is put where it should be, and what that may cost.
struct Care {
  std::size_t levels = 0;    // the lowest, the wall's among them
  double most_loss = 0;      // of a face's quality
  bool keeps_worst = false;  // of the window: none becomes worse than that
};

/// All columns as they would be.
ColumnVector meet_all(const Surface& surface, const WindowShape& shape, const Care& care) {
  ColumnVector met = shape.points_world;
  const std::size_t levels = met.levels();
  parallel::for_ranges(shape.window.free, kGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t s = begin; s < end; ++s) {
      if (!(shape.heights_world[s].back() > 0)) continue;
      Meeting meeting(surface, shape, s);
      const std::size_t stop = std::min(care.levels, shape.ends_on[s] < 0 ? levels : levels - 1);
      for (std::size_t k = shape.first_free[s]; k < stop; ++k) met.set(s, k, meeting.find(k));
    }
  });
  return met;
}

void blend(const ColumnVector& from, const ColumnVector& to, double part, std::size_t slot,
           ColumnVector& points) {
  for (std::size_t k = 1; k < points.levels(); ++k) {
    const Vec3 a = from.get(slot, k);
    const Vec3 b = to.get(slot, k);
    points.set(slot, k, part < 1 ? Vec3(a + part * (b - a)) : b);
  }
}

/// Less of the way for the free columns of faces that got worse than they may.
bool take_back(const WindowShape& shape, const std::vector<FaceState>& before, const Care& care,
               std::vector<double>& part) {
  double worst = care.keeps_worst ? std::numeric_limits<double>::infinity() : 0;
  for (std::size_t f = 0; f < before.size(); ++f) {
    worst = std::min(worst, merit(before[f], shape.goals[f]));
  }
  const std::vector<FaceState> now = judge_all(shape);
  std::vector<bool> fails(part.size(), false);
  for (std::size_t f = 0; f < now.size(); ++f) {
    const double was = merit(before[f], shape.goals[f]);
    const double least = std::min(was, std::max(worst, (1 - care.most_loss) * was));
    if (now[f].positive && merit(now[f], shape.goals[f]) >= least) continue;
    const ColumnFace& face = shape.window.faces[f];
    for (std::size_t c = 0; c < face.count; ++c) {
      if (at(face.column[c]) < part.size()) fails[at(face.column[c])] = true;
    }
  }
  bool any = false;
  for (std::size_t s = 0; s < part.size(); ++s) {
    if (!fails[s] || part[s] == 0) continue;
    part[s] = part[s] > 0.25 ? 0.5 * part[s] : 0;
    any = true;
  }
  return any;
}

void meet(const Surface& surface, const Care& care, WindowShape& shape) {
  const std::vector<FaceState> before = judge_all(shape);
  const ColumnVector start = shape.points_world;
  const ColumnVector met = meet_all(surface, shape, care);
  std::vector<double> part(shape.window.free, 1.0);
  std::vector<double> put(shape.window.free, 0.0);
  for (int round = 0; round < kRounds; ++round) {
    parallel::for_ranges(part.size(), kGrain, [&](std::size_t begin, std::size_t end) {
      for (std::size_t s = begin; s < end; ++s) {
        if (put[s] == part[s]) continue;
        blend(start, met, part[s], s, shape.points_world);
        if (!keeps_side(surface, shape, s)) blend(start, met, part[s] = 0, s, shape.points_world);
        put[s] = part[s];
      }
    });
    if (!take_back(shape, before, care, part)) return;
  }
  shape.points_world = start;
}

}  // namespace

void meet_heights(const Surface& surface, WindowShape& shape) {
  meet(surface, {shape.points_world.levels(), kMostLoss, true}, shape);
  meet(surface, {2, kMostLossOfFirst, false}, shape);
}

}  // namespace vdb_offset
