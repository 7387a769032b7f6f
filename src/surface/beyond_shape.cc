#include "surface/beyond_shape.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/parallel.h"
#include "surface/facet_size.h"
#include "surface/orient.h"
#include "vdb_offset/core/error.h"

namespace vdb_offset {

namespace {

constexpr std::size_t kGrain = 256;

/// How far nodes lie beyond a shape; those that are near enough to it 0.
std::vector<double> beyond(const Vec3List& nodes, const Wall& shape, double near_world) {
  std::vector<double> off(nodes.size(), 0);
  parallel::for_ranges(nodes.size(), kGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t n = begin; n < end; ++n) {
      const WallPoint nearest = shape.closest(nodes[n]);
      if (nearest.on_free_edge || nearest.side(nodes[n]) > 0) continue;
      const double near = std::max(near_world, kSagitta * facet_size(shape, nearest.triangle));
      if (nearest.distance_world > near) off[n] = nearest.distance_world;
    }
  });
  return off;
}

}  // namespace

void refuse_beyond(const OpenSurface& surface, const std::string& name, const Wall& shape,
                   double near_world) {
  const std::vector<double> off = beyond(surface.nodes_world, shape, near_world);
  const auto farthest = std::ranges::max_element(off) - off.begin();
  if (off.empty() || !(off[static_cast<std::size_t>(farthest)] > 0)) return;
  const NodeGrids& grids = surface.grids;
  const auto holds = [&](const std::vector<int>& nodes) {
    return std::ranges::count(nodes, static_cast<int>(farthest)) > 0;
  };
  const auto p = std::ranges::find_if(grids.nodes, holds) - grids.nodes.begin();
  const Patch& patch = grids.patches[static_cast<std::size_t>(p)];
  const std::vector<int>& nodes = grids.nodes[static_cast<std::size_t>(p)];
  const auto point =
      static_cast<int>(std::ranges::find(nodes, static_cast<int>(farthest)) - nodes.begin());
  const auto i = point % patch.ni;
  const auto j = point / patch.ni;
  const std::size_t copies = surface.is_flat ? 2 : 1;
  const auto count =
      static_cast<std::size_t>(std::ranges::count_if(off, [](double far) { return far > 0; }));
  throw InputError(
      fmt::format(
          "{} of {} points of the wall lie beyond the boundary '{}', where the domain ends: "
          "the farthest, by {:.3g}, is {}; cut the wall off along the boundary, or leave "
          "out what is beyond",
          count / copies, off.size() / copies, name, off[static_cast<std::size_t>(farthest)],
          surface.is_flat ? curve_place(patch, static_cast<int>(p), i)
                          : place(patch, static_cast<int>(p), i, j)),
      {p, i, j});
}

}  // namespace vdb_offset
