#include "boundary_lines.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <vector>

#include "command.h"
#include "vdb_offset/surface/pierced.h"

namespace vdb_offset::command {
namespace {

std::string describe(const Boundary& boundary, bool is_flat) {
  if (boundary.is_plane()) {
    return (is_flat ? "line " : "plane ") + describe(boundary.plane(), is_flat);
  }
  if (boundary.is_bare_wall()) return "wall without layers";
  return boundary.is_internal() ? "internal surface" : "its surface";
}

/// "off it by 1e-05, and 3e-06 would do, 1e-06 of the size"
std::string in_words(const MissedEdges& missed) {
  return fmt::format("off it by {:.3g}{}, and {:.3g} would do, {:g} of the size", missed.off_world,
                     missed.off_max_world > 1.01 * missed.off_world
                         ? fmt::format(" to {:.3g}", missed.off_max_world)
                         : "",
                     missed.tolerance_world, kOnPlane);
}

/// Planes that were given, and free edges that nearly lie on them.
void warn_of_missed(const Console& console, const Surface& surface) {
  const std::string what = surface.flat ? "end of a curve" : "free edge";
  const std::string all = surface.flat ? "ends of curves" : "free edges";
  for (const MissedEdges& missed : surface.report.missed) {
    console.warning(
        missed.edges == 0
            ? fmt::format("no {} lies on '{}': it only mirrors the {}; the nearest is {}", what,
                          missed.plane, surface.flat ? "curves" : "surface", in_words(missed))
            : fmt::format("{} {} along '{}' {} {}", missed.edges, missed.edges == 1 ? what : all,
                          missed.plane, missed.edges == 1 ? "is" : "are", in_words(missed)));
  }
}

/// Openings of the flow that bodies stick out of.
void warn_of_pierced(const Console& console, const Surface& surface) {
  for (const PiercedOpening& pierced : find_pierced(surface)) {
    const auto b = static_cast<std::size_t>(pierced.boundary);
    console.warning(fmt::format(
        "the wall goes through '{}', at {}: its layers go on beyond; cut it off along the plane, "
        "or leave out what is beyond",
        surface.boundaries->list()[b].name(), command::in_words(pierced.place_world, false)));
  }
}

/// Cells of the wall that lie in a plane which was named: columns there have no height.
void warn_of_bare(const Console& console, const Surface& surface, const Boundary& boundary) {
  if (!boundary.is_plane() || boundary.is_internal()) return;
  const double near = 1e-6 * surface.wall->bounds().size();
  std::size_t count = 0;
  Vec3 first = Vec3::Zero();
  for (std::size_t p = 0; p < surface.patches.size(); ++p) {
    const Patch& patch = surface.patches[p];
    for_cells(patch, [&](const std::array<int, 4>& c) {
      Vec3 middle = Vec3::Zero();
      for (const int corner : c) {
        const Vec3& point = patch.points_world[static_cast<std::size_t>(corner)];
        if (std::abs(boundary.side(point)) > near) return;
        middle += 0.25 * point;
      }
      if (count++ == 0) first = middle;
    });
  }
  if (count == 0) return;
  console.warning(
      fmt::format("{} faces of the wall lie in '{}', the first at {}: they get no layers; leave "
                  "them out, or do not name that plane",
                  count, boundary.name(), command::in_words(first, surface.flat)));
}

}  // namespace

void print_boundaries(const Console& console, const Surface& surface) {
  const int tapers = surface.report.taper_edges;
  if (tapers > 0) console.remark(fmt::format("layers taper to nothing at {} edges", tapers));
  if (!surface.boundaries) return;
  const std::vector<Boundary>& list = surface.boundaries->list();
  std::vector<std::string> parts;
  std::vector<std::string> idle;
  const std::string what = surface.flat ? "end" : "edge";
  for (std::size_t b = surface.flat ? 2 : 0; b < list.size(); ++b) {
    const int edges = surface.free_edges_on(static_cast<int>(b));
    parts.push_back(fmt::format("'{}' ({}, {} {})", list[b].name(), describe(list[b], surface.flat),
                                edges, edges == 1 ? what : what + "s"));
    const bool is_missed =
        std::ranges::count(surface.report.missed, list[b].name(), &MissedEdges::plane) > 0;
    warn_of_bare(console, surface, list[b]);
    if (edges == 0 && !list[b].is_internal() && !is_missed) {
      idle.push_back("'" + list[b].name() + "'");
    }
  }
  const double moved = surface.report.boundary_distance_max_world;
  if (!parts.empty() && moved > 1e-6 * surface.wall->bounds().size())
    parts.back() += fmt::format("; nodes there move by up to {:.3g} onto them", moved);
  if (!parts.empty()) console.remark(fmt::format("ends on {}", fmt::join(parts, ", ")));
  warn_of_missed(console, surface);
  warn_of_pierced(console, surface);
  if (!idle.empty()) {
    console.warning(fmt::format("no {} lies on {}: it only mirrors the {}",
                                surface.flat ? "end of a curve" : "free edge",
                                fmt::join(idle, ", "), surface.flat ? "curves" : "surface"));
  }
}

}  // namespace vdb_offset::command
