// Section 4.4 of Wang, Guibault, Camarero, Automatic near-body domain decomposition using the
// eikonal equation. Layers are read off the traced columns at true distances from the wall.

#include "vdb_offset/march/march.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/parallel.h"
#include "march/column.h"
#include "march/height_profile.h"
#include "march/node_directions.h"
#include "vdb_offset/core/error.h"

namespace vdb_offset {

namespace {

/// Everything one thread needs to march one node after the other.
struct Marcher {
  const Surface& surface;
  const NodeDirections& directions;
  ColumnTracer tracer;
  ColumnPath path;
  HeightProfile profile;

  void march(std::size_t node, Layers& layers);
};

void Marcher::march(std::size_t node, Layers& layers) {
  const std::size_t wall_node = node % static_cast<std::size_t>(surface.wall_nodes);
  const double side = node == wall_node ? 1.0 : -1.0;
  const ColumnStart start{surface.nodes_world[node], side * directions.direction[wall_node],
                          directions.spacing_world[wall_node], side,
                          directions.triangles(wall_node)};
  const ColumnEnd end = tracer.trace(start, path);
  layers.stop[node] = end.stop;
  layers.height_world[node] = end.height_world;
  profile.build(tracer, path, end);

  // A column that cannot leave the wall still gets levels, in order, a hair apart.
  const double height = std::max(end.height_world, 1e-12 * layers.distance_world);
  const bool full = end.stop == Stop::Reached;
  std::vector<double> squeezed;
  if (!full) squeezed = squeeze(layers.spacing, std::min(height, layers.distance_world));
  const std::vector<double>& heights = full ? layers.spacing.heights_world : squeezed;
  const std::size_t levels = heights.size();
  Vec3* points = layers.points_world.data() + node * levels;
  points[0] = start.point_world;
  double s = 0;
  for (std::size_t k = 1; k + 1 < levels; ++k) {
    s = profile.length_at(heights[k], s);
    points[k] = path.point(s);
  }
  points[levels - 1] = path.point(end.s_world);
  const double reach = 1.001 * (points[1] - points[0]).norm();
  layers.first_cell_world[node] = surface.wall->closest(points[1], reach).distance_world;
}

MarchReport summarise(const Layers& layers) {
  MarchReport report;
  report.nodes = static_cast<int>(layers.stop.size());
  for (std::size_t n = 0; n < layers.stop.size(); ++n) {
    if (layers.stop[n] == Stop::Collided) ++report.collided;
    if (layers.stop[n] == Stop::LeftBand) ++report.left_band;
    if (layers.stop[n] != Stop::Reached) continue;
    ++report.reached;
    const double error = std::abs(layers.height_world[n] / layers.distance_world - 1);
    report.distance_error_max = std::max(report.distance_error_max, error);
  }
  return report;
}

}  // namespace

void MarchOptions::validate() const {
  if (!(step_voxels >= 0.01 && step_voxels <= 2)) {
    throw InputError(fmt::format("step = {}, but must be in [0.01, 2] voxels", step_voxels));
  }
}

Layers march(const Surface& surface, const DistanceField& field, const LayerSpacing& spacing,
             const MarchOptions& options, const Progress& progress) {
  options.validate();
  if (spacing.heights_world.size() < 2) throw InputError("the layer spacing has no layers");
  const std::size_t nodes = surface.nodes_world.size();
  Layers layers;
  layers.spacing = spacing;
  layers.distance_world = field.distance_world;
  layers.points_world.resize(nodes * spacing.heights_world.size());
  layers.stop.resize(nodes);
  layers.height_world.resize(nodes);
  layers.first_cell_world.resize(nodes);
  const NodeDirections directions = node_directions(*surface.wall, surface.wall_nodes);
  parallel::for_ranges({progress, "march"}, nodes, 32, [&](std::size_t begin, std::size_t end) {
    Marcher marcher{surface, directions, ColumnTracer(*surface.wall, field, options), {}, {}};
    for (std::size_t n = begin; n < end; ++n) marcher.march(n, layers);
  });
  layers.report = summarise(layers);
  return layers;
}

}  // namespace vdb_offset
