#pragma once

#include <memory>
#include <string>
#include <vector>

#include "vdb_offset/core/progress.h"
#include "vdb_offset/core/vec.h"
#include "vdb_offset/surface/patch.h"
#include "vdb_offset/surface/topology.h"
#include "vdb_offset/surface/wall.h"

namespace vdb_offset {

/// Which way the blocks grow from the patches' normals.
enum class MarchSide { Along, Against, Both };

struct SurfaceOptions {
  /// Marching side, relative to the normals of each component's first patch.
  MarchSide side = MarchSide::Along;
  /// Factor applied to every coordinate on reading.  Range: > 0.
  double scale = 1.0;
  /// Points closer than this part of the shorter of their local spacings become one node.
  /// Range: [0, 0.5).  Local spacing: shortest edge of non-zero length at the point.
  double weld = 0.01;

  void validate() const;
};

/// What happened on the way from patches to nodes.
struct SurfaceReport {
  std::vector<int> flipped;  ///< patches turned round (i reversed) to agree with their neighbours
  double weld_distance_max_world = 0;  ///< farthest that a point moved to its node
  double median_edge_world = 0;
  double shortest_edge_world = 0;  ///< of the edges that are not collapsed
};

/// Welded, oriented, with its topology: what every later stage starts from.
struct Surface {
  Patches patches;  ///< oriented; with MarchSide::Both, the first half along, the second against
  Vec3List nodes_world;                       ///< one for each welded point
  std::vector<std::vector<int>> patch_nodes;  ///< for each patch, the node of each of its points
  Topology topology;
  std::shared_ptr<const Wall> wall;  ///< each quad is four triangles about its corners' mean;
                                     ///< vertex n < wall_nodes is node n
  int wall_nodes =
      0;  ///< nodes of the wall proper: all nodes, or half of them with MarchSide::Both
  bool closed = false;  ///< no free edge
  bool both_sides = false;
  SurfaceReport report;

  int points() const;      ///< sum of ni * nj
  int faces() const;       ///< grid cells with at least three nodes, over all patches
  int free_edges() const;  ///< grid edges used once
  int node(int patch, int i, int j) const {
    const auto p = static_cast<std::size_t>(patch);
    return patch_nodes[p][static_cast<std::size_t>(j) * static_cast<std::size_t>(patches[p].ni) +
                          static_cast<std::size_t>(i)];
  }
};

/// Weld patches into one oriented surface with its topology and its exact wall geometry.
///
/// In      patches: world units, any order, any orientation.
/// Cost    O(n log n) in the number of points.
/// Throws  InputError naming the patch and the place: a patch under 2 x 2 or with a coordinate that
///         is not finite, no area at all, three cells on one edge, a node whose cells do not form
///         one fan, a surface that cannot be oriented.
Surface build_surface(Patches patches, const SurfaceOptions& options = {},
                      const Progress& progress = {});

}  // namespace vdb_offset
