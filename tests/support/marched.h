#pragma once

// A surface and its columns: the stages up to the march in one call.

#include <utility>

#include "vdb_offset/march/march.h"
#include "vdb_offset/rasterize/rasterize.h"
#include "vdb_offset/surface/surface.h"
#include "vdb_offset/sweep/sweep.h"

namespace vdb_offset::test {

struct Case {
  double distance = 1;
  double voxel = 0;
  int layers = 16;
  double first_cell = 1e-3;
  SurfaceOptions surface = {};
  SweepOptions sweep = {};
  MarchOptions march = {};
};

struct Marched {
  Surface surface;
  Layers layers;
  double voxel;

  Vec3 end(int node) const { return layers.at(node, layers.levels() - 1); }
  BoundarySet on(int node) const { return surface.boundaries_of(static_cast<std::size_t>(node)); }
};

inline Marched marched(Patches patches, const Case& c) {
  Surface surface = build_surface(std::move(patches), c.surface);
  const DistanceField field = sweep(rasterize(surface, {.distance_world = c.distance,
                                                        .voxel_world = c.voxel,
                                                        .both_sides = surface.both_sides}),
                                    c.sweep);
  SpacingOptions spacing;
  spacing.layers = c.layers;
  spacing.first_cell_world = c.first_cell;
  spacing.max_growth = 10;
  Layers layers = march(surface, field, solve_spacing(c.distance, spacing), c.march);
  return {std::move(surface), std::move(layers), field.voxel_world};
}

}  // namespace vdb_offset::test
