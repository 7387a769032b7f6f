#pragma once

// Surfaces, layers and meshes put together by hand, so that a stage is tested without those before
// it.

#include <cmath>
#include <cstddef>
#include <string>
#include <utility>
#include <vector>

#include "vdb_offset/blocks/multi_block.h"
#include "vdb_offset/march/spacing.h"

namespace vdb_offset::test {

/// Layers whose points are `point(node, level)`; everything reached.
template <typename Point>
Layers make_layers(int nodes, int cells, const Point& point) {
  Layers layers;
  SpacingOptions spacing;
  spacing.layers = cells;
  layers.spacing = solve_spacing(1, spacing);
  layers.distance_world = 1;
  for (int n = 0; n < nodes; ++n) {
    for (int k = 0; k <= cells; ++k) layers.points_world.push_back(point(n, k));
    layers.stop.push_back(Stop::Reached);
    layers.height_world.push_back(1);
    layers.room_world.push_back(1);
    layers.asked_world.push_back(1);
    layers.first_asked_world.push_back(layers.spacing.first_cell_world);
    layers.first_cell_world.push_back((layers.at(n, 1) - layers.at(n, 0)).norm());
  }
  return layers;
}

/// Points of no meaning, no two alike: where only the connections matter.
inline Layers any_layers(int nodes, int cells) {
  return make_layers(nodes, cells, [](int n, int k) -> Vec3 {
    return {static_cast<double>(n), static_cast<double>(k), 0.5};
  });
}

/// Adds a patch with given nodes; its points follow from them.
inline void add_patch(Surface& surface, std::string name, int ni, int nj, std::vector<int> nodes) {
  Patch patch;
  patch.name = std::move(name);
  patch.ni = ni;
  patch.nj = nj;
  patch.points_world.resize(nodes.size());
  surface.patches.push_back(std::move(patch));
  for (const int node : nodes) {
    if (static_cast<std::size_t>(node) >= surface.nodes_world.size()) {
      surface.nodes_world.resize(static_cast<std::size_t>(node) + 1, Vec3::Zero());
    }
  }
  surface.patch_nodes.push_back(std::move(nodes));
}

inline Edge free_edge(int patch, Side side, int begin, int end) {
  return {EdgeKind::Free, {patch, side, begin, end}, {}, {}};
}

/// One block over a wavy plate of `ni x nj` columns that lean and grow: no two cells alike.
inline MultiBlock wavy_plate(int ni, int nj, int cells) {
  const auto point = [ni](int n, int k) -> Vec3 {
    const double x = n % ni;
    const double y = n / ni;
    const double z = 0.05 * (std::pow(1.1 + 0.01 * std::sin(x), k) - 1);
    return {x + z * std::sin(y), y + 0.3 * z * std::cos(2 * x), z + 0.1 * std::sin(x * y)};
  };
  Surface surface;
  std::vector<int> nodes;
  for (int n = 0; n < ni * nj; ++n) nodes.push_back(n);
  add_patch(surface, "plate", ni, nj, nodes);
  surface.topology.edges = {
      free_edge(0, Side::IMin, 0, nj - 1), free_edge(0, Side::IMax, 0, nj - 1),
      free_edge(0, Side::JMin, 0, ni - 1), free_edge(0, Side::JMax, 0, ni - 1)};
  return build_blocks(surface, make_layers(ni * nj, cells, point));
}

}  // namespace vdb_offset::test
