#include <fmt/format.h>

#include <Eigen/Geometry>
#include <array>
#include <cstddef>
#include <string>

#include "surface/crossed_curves.h"
#include "surface/orient.h"
#include "surface/split_polygon.h"
#include "vdb_offset/core/error.h"
#include "vdb_offset/surface/surface.h"

namespace vdb_offset {
namespace {

/// "at patch 2 'tip', point (3, 4) at (0, 1, 2)": of polygons with the number of the face.
std::string cell_name(const Surface& surface, int number, int cell, int corner) {
  const Patch& patch = surface.patches[static_cast<std::size_t>(number)];
  const std::string at = place(patch, number, corner % patch.ni, corner / patch.ni);
  return patch.is_grid() ? "at " + at : fmt::format("face {} at {}", cell, at);
}

/// What nearly all are, told without any room.
bool is_convex(const Patch& patch, const std::array<int, 4>& corners) {
  const auto at = [&](std::size_t n) -> const Vec3& {
    return patch.points_world[static_cast<std::size_t>(corners[n % 4])];
  };
  const Vec3 area = (at(2) - at(0)).cross(at(3) - at(1));
  for (std::size_t n = 0; n < 4; ++n) {
    if (!((at(n + 1) - at(n)).cross(at(n + 2) - at(n + 1)).dot(area) > 0)) return false;
  }
  return true;
}

bool is_crossed(const Patch& patch, const std::array<int, 4>& corners) {
  return corners[2] != corners[3] && !is_convex(patch, corners) &&
         crossed_edge(patch.points_world, corners).has_value();
}

}  // namespace

void refuse_crossed_cells(const Surface& surface) {
  if (surface.flat) return refuse_crossed_curves(surface);
  std::size_t count = 0;
  std::string first;
  // The other side's patches are copies.
  const std::size_t patches = surface.patches.size() / (surface.both_sides ? 2 : 1);
  for (std::size_t p = 0; p < patches; ++p) {
    if (surface.is_fan(p)) continue;
    const Patch& patch = surface.patches[p];
    int cell = 0;
    for_cells(patch, [&](const std::array<int, 4>& corners) {
      ++cell;
      if (!is_crossed(patch, corners)) return;
      if (++count == 1) first = cell_name(surface, static_cast<int>(p), cell, corners[0]);
    });
  }
  if (count == 0) return;
  const std::string what =
      count == 1
          ? "a quad of the surface crosses itself, as a bow tie does, "
          : fmt::format("{} quads of the surface cross themselves, as a bow tie does, the first ",
                        count);
  throw InputError(what + first +
                   ": no cell on it can be positive; put its points in the order that they have "
                   "around it, or mend lines that fold over there; 'field' takes it as it is");
}

}  // namespace vdb_offset
