// Internal surfaces bound what is on either side of them, so columns that the repair moves must not
// get through. A column hangs together from its foot on, which does not move: it is on its side as
// long as it goes through nowhere.

#include "blocks/keep_sides.h"

#include <algorithm>

#include "core/parallel.h"

namespace vdb_offset {
namespace {

constexpr std::size_t kGrain = 16;  // columns
constexpr double kBefore = 0.9;     // of the way to a surface

/// Of some internal surfaces, those that a column goes through.
BoundarySet goes_through(const Surface& surface, const WindowShape& shape, std::size_t slot,
                         BoundarySet internals) {
  BoundarySet found = 0;
  if (internals == 0) return found;
  const std::vector<Boundary>& list = surface.boundaries->list();
  for (std::size_t b = 0; b < list.size(); ++b) {
    if ((internals >> b & 1U) == 0) continue;
    for (std::size_t k = 1; k < shape.points_world.levels(); ++k) {
      const Vec3 from = shape.points_world.get(slot, k - 1);
      if (!list[b].parts(from, shape.points_world.get(slot, k))) continue;
      found |= BoundarySet{1} << b;
      break;
    }
  }
  return found;
}

}  // namespace

void find_kept_from(const Surface& surface, WindowShape& shape) {
  if (!surface.boundaries || !surface.boundaries->has_internal()) return;
  const std::vector<Boundary>& list = surface.boundaries->list();
  BoundarySet internals = 0;
  for (std::size_t b = 0; b < list.size(); ++b) {
    if (list[b].is_internal()) internals |= BoundarySet{1} << b;
  }
  parallel::for_ranges(shape.window.free, kGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t s = begin; s < end; ++s) {
      const auto node = static_cast<std::size_t>(shape.window.nodes[s]);
      const BoundarySet others = internals & ~surface.boundaries_of(node);
      shape.kept_from[s] = others & ~goes_through(surface, shape, s, others);
    }
  });
}

bool keeps_side(const Surface& surface, const WindowShape& shape, std::size_t slot) {
  return goes_through(surface, shape, slot, shape.kept_from[slot]) == 0;
}

double free_part(const Surface& surface, const WindowShape& shape, std::size_t slot,
                 const Vec3& end_world) {
  const Vec3 foot = shape.points_world.get(slot, 0);
  const BoundarySet internals = shape.kept_from[slot];
  double part = 1;
  if (internals == 0) return part;
  const std::vector<Boundary>& list = surface.boundaries->list();
  for (std::size_t b = 0; b < list.size(); ++b) {
    if ((internals >> b & 1U) == 0 || !list[b].parts(foot, end_world)) continue;
    const auto at = list[b].crossing(foot, end_world);
    if (at) part = std::min(part, kBefore * *at);
  }
  return part;
}

}  // namespace vdb_offset
