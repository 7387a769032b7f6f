#pragma once

#include <memory>
#include <vector>

#include "surface/plane_finder.h"
#include "vdb_offset/surface/surface_options.h"
#include "vdb_offset/surface/wall.h"

namespace vdb_offset {

/// A boundary shape as a wall, its normals as those of the first patch of each sheet.
std::shared_ptr<const Wall> shape_wall(const NamedShape& named, double scale);

/// Free edges of the surface on a shape.
struct ShapeRim {
  const PlaneFinder& finder;
  std::vector<const FreeEdge*> edges;
};

/// The same, with each sheet of it turned so that the cells at the free edges on it are before it;
/// those without edges as most are.
std::shared_ptr<const Wall> turned_shape(const NamedShape& named, double scale,
                                         const ShapeRim& rim);

}  // namespace vdb_offset
