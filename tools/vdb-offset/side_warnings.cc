#include "side_warnings.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <map>
#include <string>
#include <vector>

#include "command.h"

namespace vdb_offset::command {
namespace {

/// Whether a column ends on a boundary, or marches within it.
bool is_met(const MeshResult& result, std::size_t boundary) {
  for (std::size_t n = 0; n < result.surface.nodes_world.size(); ++n) {
    if ((result.surface.boundaries_of(n) >> boundary & 1U) != 0) return true;
    if (result.mesh.layers.ended_on(static_cast<int>(n)) == static_cast<int>(boundary)) return true;
  }
  return false;
}

/// Why no column meets a surface, by where its points lie.
std::string why_idle(const MeshResult& result, const NamedShape& shape, double scale) {
  bool is_near = false;
  bool is_before = false;
  const double reach = result.mesh.layers.distance_world;
  for (const Patch& patch : shape.patches) {
    for (const Vec3& point : patch.points_world) {
      const WallPoint nearest = result.surface.wall->closest(scale * point);
      if (nearest.distance_world > reach) continue;
      is_near = true;
      is_before = is_before || nearest.side(scale * point) > 0;
    }
  }
  if (!is_near) return "its points lie beyond the layers";
  return is_before ? "it lies between columns, or where they end before it"
                   : "what of it is near lies behind the wall";
}

void warn_of_idle(const Console& console, const MeshResult& result, const SurfaceOptions& options) {
  const std::vector<Boundary>& list = result.surface.boundaries->list();
  for (std::size_t b = 0; b < list.size(); ++b) {
    const auto given = std::ranges::find(options.internals, list[b].name(), &NamedShape::name);
    if (given == options.internals.end() || is_met(result, b)) continue;
    if (std::ranges::count(result.sides.cut, list[b].name(), &Astray::name) > 0) continue;
    console.warning(
        fmt::format("no column ends on the internal surface '{}', or marches within it: {}",
                    list[b].name(), why_idle(result, *given, options.scale)));
  }
}

/// Edges within a patch whose columns march within a surface.
struct Within {
  std::size_t edges = 0;
  Vec3 place_world = Vec3::Zero();  // of the first
};

Within edges_within(const Surface& surface, std::size_t patch, std::size_t boundary) {
  std::map<std::array<int, 2>, int> cells;  // beside each edge
  const auto is_on = [&](int node) {
    return (surface.boundaries_of(static_cast<std::size_t>(node)) >> boundary & 1U) != 0;
  };
  for_cells(surface.patches[patch], [&](std::array<int, 4> c) {
    for (int& corner : c) corner = surface.patch_nodes[patch][static_cast<std::size_t>(corner)];
    for (std::size_t n = 0; n < 4; ++n) {
      const auto [a, b] = std::minmax(c[n], c[(n + 1) % 4]);
      if (a != b && is_on(a) && is_on(b)) ++cells[{a, b}];
    }
  });
  Within within;
  for (const auto& [edge, count] : cells) {
    if (count < 2 || within.edges++ > 0) continue;
    within.place_world = 0.5 * (surface.nodes_world[static_cast<std::size_t>(edge[0])] +
                                surface.nodes_world[static_cast<std::size_t>(edge[1])]);
    if (surface.flat) within.place_world.z() = 0;
  }
  return within;
}

/// Faces between the cells of one block have no names.
void warn_of_nameless(const Console& console, const Surface& surface) {
  const std::vector<Boundary>& list = surface.boundaries->list();
  for (std::size_t b = 0; b < list.size(); ++b) {
    for (std::size_t p = 0; list[b].is_internal() && p < surface.patches.size(); ++p) {
      const Within within = edges_within(surface, p, b);
      if (within.edges == 0) continue;
      console.warning(fmt::format(
          "the surface '{}' stands on '{}' within that patch ({} {}, the first at {}): columns "
          "march within it, but its faces there lie inside a block, without its name; part the "
          "patch along it",
          list[b].name(), surface.patches[p].name, within.edges, surface.flat ? "points" : "edges",
          in_words(within.place_world, surface.flat)));
    }
  }
}

}  // namespace

void warn_of_sides(const Console& console, const MeshResult& result,
                   const SurfaceOptions& options) {
  if (!result.surface.boundaries) return;
  for (const Astray& cut : result.sides.cut) {
    console.warning(fmt::format(
        "the surface '{}' goes through {} of {} cells, the first at {}: no face of the blocks lies "
        "on it there; let it meet the wall along grid lines, or end off the layers",
        cut.name, cut.count, result.mesh.cells(), in_words(cut.place_world, result.surface.flat)));
  }
  for (const Astray& beyond : result.sides.beyond) {
    console.warning(
        fmt::format("{} points lie beyond the boundary '{}', by up to {:.3g}, the "
                    "first at {}; ask for a smaller distance there",
                    beyond.count, beyond.name, beyond.farthest_world,
                    in_words(beyond.place_world, result.surface.flat)));
  }
  for (const Astray& past : result.sides.past) {
    console.warning(fmt::format(
        "{} points on the boundary '{}' lie past its rim, by up to {:.3g}, the first at {}: it "
        "goes on there as a plane; give a surface that reaches beyond the layers",
        past.count, past.name, past.farthest_world,
        in_words(past.place_world, result.surface.flat)));
  }
  warn_of_nameless(console, result.surface);
  warn_of_idle(console, result, options);
}

void warn_of_crossings(const Console& console, const MeshResult& result) {
  const CrossingsReport& found = result.crossings;
  if (found.cells == 0) return;
  console.warning(fmt::format(
      "{} of {} cells lie in cells over other faces, and {} points of the wall in cells, the first "
      "above {}: see whether walls cross there; if not, ask for a smaller distance, or divide the "
      "wall more finely",
      found.cells, result.mesh.cells(), found.wall_points,
      in_words(found.place_world, result.surface.flat)));
}

}  // namespace vdb_offset::command
