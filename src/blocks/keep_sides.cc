// Internal surfaces bound what is on either side of them, so columns that the repair moves must not
// get through. A column hangs together from its foot on, which does not move: it is on its side as
// long as it goes through nowhere. The boundaries that the domain ends on have a signed distance,
// so points beside them are kept from them one by one.

#include "blocks/keep_sides.h"

#include <algorithm>

#include "core/parallel.h"

namespace vdb_offset {
namespace {

constexpr std::size_t kGrain = 16;  // columns
constexpr double kBefore = 0.9;     // of the way to a surface

constexpr double kBeside = 0.1;      // of a point's distance from a boundary, left by one move
constexpr double kRounding = 1e-12;  // of the coordinates

std::size_t at(int index) { return static_cast<std::size_t>(index); }

double rounding(const Vec3& point) { return kRounding * (1 + point.cwiseAbs().maxCoeff()); }

/// Whether a column goes through an internal surface, or has points beyond a boundary.
bool goes_through(const Boundary& boundary, const WindowShape& shape, std::size_t slot) {
  for (std::size_t k = 1; k < shape.points_world.levels(); ++k) {
    const Vec3 from = shape.points_world.get(slot, k - 1);
    const Vec3 to = shape.points_world.get(slot, k);
    if (boundary.is_internal() ? boundary.parts(from, to) : boundary.side(to) < -rounding(to)) {
      return true;
    }
  }
  return false;
}

/// The part of a way from a point in the domain that stays there: by steps as long as the distance
/// from the boundary is.
double part_inside(const Boundary& boundary, const Vec3& from, const Vec3& to) {
  constexpr int kSteps = 60;
  constexpr double kNear = 1e-4;  // of the way
  const double length = (to - from).norm();
  double part = 0;
  for (int n = 0; n < kSteps && part < 1; ++n) {
    const double step = boundary.side(from + part * (to - from)) / length;
    if (!(step > kNear)) return kBefore * part;
    part += step;
  }
  return part < 1 ? kBefore * part : 1;
}

/// The least signed distance that a move leaves to a point: none is put beyond.
double floor_of(const Boundary& boundary, const Vec3& from) {
  const double side = boundary.side(from);
  return side > 0 ? kBeside * side : side;
}

}  // namespace

void find_kept_from(const Surface& surface, WindowShape& shape) {
  if (!surface.boundaries) return;
  const std::vector<Boundary>& list = surface.boundaries->list();
  parallel::for_ranges(shape.window.free, kGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t s = begin; s < end; ++s) {
      const BoundarySet on = surface.boundaries_of(at(shape.window.nodes[s]));
      for (std::size_t b = 0; b < list.size(); ++b) {
        if ((on >> b & 1U) != 0 || goes_through(list[b], shape, s)) continue;
        shape.kept_from[s] |= BoundarySet{1} << b;
      }
    }
  });
}

bool keeps_side(const Surface& surface, const WindowShape& shape, std::size_t slot) {
  for (std::size_t b = 0; shape.kept_from[slot] >> b != 0; ++b) {
    if ((shape.kept_from[slot] >> b & 1U) == 0) continue;
    if (goes_through(surface.boundaries->list()[b], shape, slot)) return false;
  }
  return true;
}

double free_part(const Surface& surface, const WindowShape& shape, std::size_t slot,
                 const Vec3& end_world) {
  const Vec3 foot = shape.points_world.get(slot, 0);
  const BoundarySet kept = shape.kept_from[slot];
  double part = 1;
  for (std::size_t b = 0; kept >> b != 0; ++b) {
    if ((kept >> b & 1U) == 0) continue;
    const Boundary& boundary = surface.boundaries->list()[b];
    if (!boundary.is_internal()) {
      part = std::min(part, part_inside(boundary, foot, end_world));
    } else if (boundary.parts(foot, end_world)) {
      const auto through = boundary.crossing(foot, end_world);
      if (through) part = std::min(part, kBefore * *through);
    }
  }
  return part;
}

Vec3 moved_inside(const Surface& surface, BoundarySet on, const Vec3& from_world,
                  const Vec3& to_world) {
  constexpr int kRounds = 4;
  if (!surface.boundaries) return to_world;
  Vec3 point = surface.boundaries->hold(on, to_world);
  for (int n = 0; n < kRounds; ++n) {
    bool is_inside = true;
    for (std::size_t b = 0; b < surface.boundaries->list().size(); ++b) {
      const Boundary& boundary = surface.boundaries->list()[b];
      if (boundary.is_internal() || (on >> b & 1U) != 0) continue;
      const double side = boundary.side(point);
      const double short_of = floor_of(boundary, from_world) - side;
      if (short_of <= rounding(point)) continue;
      is_inside = false;
      point += short_of * boundary.tangent(point).normal;
    }
    if (is_inside) return point;
    point = surface.boundaries->hold(on, point);
  }
  return from_world;
}

}  // namespace vdb_offset
