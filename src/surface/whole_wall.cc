// The same wall ends on the same boundaries, by the same names, whichever parts of it have layers.

#include "surface/whole_wall.h"

#include <cstddef>
#include <utility>

#include "surface/polygon_patch.h"
#include "surface/topology.h"
#include "surface/weld.h"
#include "vdb_offset/core/error.h"

namespace vdb_offset {

namespace {

/// A part without layers as those with layers are: scaled, curves as strips.
Patch as_wall(Patch patch, double scale, double width_world) {
  for (Vec3& p : patch.points_world) p *= scale;
  if (patch.nj != 1) return patch;
  for (Vec3& p : patch.points_world) p.z() = 0;
  const Vec3List front = patch.points_world;
  for (const Vec3& p : front) patch.points_world.emplace_back(p.x(), p.y(), width_world);
  patch.nj = 2;
  return patch;
}

WholeWall join(const OpenSurface& surface, Patches patches, double weld_part) {
  WholeWall whole;
  whole.patches = std::move(patches);
  Welding welding = weld(whole.patches, weld_part, {});
  whole.nodes_world = std::move(welding.nodes_world);
  whole.nodes = std::move(welding.patch_nodes);
  whole.node_of.assign(surface.nodes_world.size(), -1);
  for (std::size_t p = 0; p < surface.grids.patches.size(); ++p) {
    const std::vector<int>& own = surface.grids.nodes[p];
    for (std::size_t n = 0; n < own.size(); ++n) {
      whole.node_of[static_cast<std::size_t>(own[n])] = whole.nodes[p][n];
    }
  }
  for (std::size_t p = 0; p < whole.patches.size(); ++p) {
    if (!whole.patches[p].is_grid()) settle_polygons(whole.patches[p], whole.nodes[p]);
    for (std::size_t n = 0; n < whole.nodes[p].size(); ++n) {
      whole.patches[p].points_world[n] =
          whole.nodes_world[static_cast<std::size_t>(whole.nodes[p][n])];
    }
  }
  orient({whole.patches, whole.nodes});
  whole.topology = build_topology(whole.patches, whole.nodes);
  return whole;
}

}  // namespace

std::optional<WholeWall> whole_wall(const OpenSurface& surface, const SurfaceOptions& options,
                                    double width_world) {
  Patches patches = surface.grids.patches;
  const std::size_t own = patches.size();
  for (const NamedShape& shape : options.shapes) {
    if (!shape.is_bare_wall) continue;
    for (const Patch& patch : shape.patches) {
      patches.push_back(as_wall(patch, options.scale, width_world));
    }
  }
  if (patches.size() == own) return {};
  try {
    return join(surface, std::move(patches), options.weld);
  } catch (const InputError&) {
    // As where three walls meet, and one of them is to have no layers for that.
    return {};
  }
}

}  // namespace vdb_offset
