#pragma once

#include <array>
#include <memory>
#include <string>
#include <vector>

#include "vdb_offset/core/progress.h"
#include "vdb_offset/core/vec.h"
#include "vdb_offset/surface/boundary.h"
#include "vdb_offset/surface/fans.h"
#include "vdb_offset/surface/patch.h"
#include "vdb_offset/surface/surface_options.h"
#include "vdb_offset/surface/topology.h"
#include "vdb_offset/surface/wall.h"

namespace vdb_offset {

class Winding;

/// Free edges that run along a plane which was given, but do not lie on it.
struct MissedEdges {
  std::string plane;  ///< its name
  int edges = 0;      ///< of a plane that has none at all those nearest to it
  double off_world = 0, off_max_world = 0;
  double tolerance_world = 0;  ///< as near they would lie on it
};

/// What happened on the way from patches to nodes.
struct SurfaceReport {
  std::vector<int> flipped;  ///< patches turned round (i reversed) to agree with their neighbours
  int turned_parts = 0;  ///< closed ones of loose patches turned outward; their patches count above
  double weld_distance_max_world = 0;      ///< farthest that a point moved to its node
  double boundary_distance_max_world = 0;  ///< farthest that a node moved onto its boundary
  int taper_edges = 0;  ///< free edges where the wall goes on smoothly without layers
  /// Ends of one curve around the body, nearer to each other than a fifth of its size: an open
  /// trailing edge. No boundary is found there.
  std::vector<std::array<Vec3, 2>> open_tails;
  std::vector<MissedEdges> missed;
  double median_edge_world = 0;
  double shortest_edge_world = 0;  ///< of the edges that are not collapsed
  int split_patches = 0;           ///< pieces more, of patches that sharp edges run through
  int fans = 0;                    ///< patches that open an edge
  int fan_corners = 0;             ///< corners opened, by three patches each
};

/// Welded, oriented, with its topology: what every later stage starts from.
struct Surface {
  Patches patches;  ///< oriented; with MarchSide::Both those along, then those against; then fans
  Vec3List nodes_world;                       ///< one for each welded point
  std::vector<std::vector<int>> patch_nodes;  ///< for each patch, the node of each of its points
  Topology topology;
  std::shared_ptr<const Wall> wall;  ///< each quad is four triangles about its corners' mean;
                                     ///< vertex n < wall_nodes is node n
  int wall_nodes = 0;  ///< nodes of the wall proper: all nodes but the fans' own, or half of them
                       ///< with MarchSide::Both
  Fans fans;
  std::shared_ptr<const Boundaries> boundaries;  ///< null: none
  std::vector<BoundarySet> node_boundaries;      ///< those that each node lies on
  std::vector<int> taper_nodes;                  ///< where the wall goes on smoothly without layers
  bool closed = false;                           ///< no free edge; or it has a winding number
  std::shared_ptr<const Winding> winding;        ///< null but for SideRule::Winding
  bool both_sides = false;
  /// Made of curves in the plane z = 0: each patch is its curve (j = 0) and the same, moved along z
  /// (j = 1); the first boundaries are those planes, "front" and "back".
  bool flat = false;
  static constexpr std::size_t kFlatPlanes = 2;
  SurfaceReport report;

  int points() const;  ///< sum of ni * nj
  int faces() const;   ///< grid cells with at least three nodes, over all patches
  /// Nodes, each of a flat surface once.
  std::size_t nodes() const { return nodes_world.size() / (flat ? 2 : 1); }
  /// Grid edges used once, those on boundaries too; of a flat surface the ends of curves.
  int free_edges() const;
  int free_edges_on(int boundary) const;
  /// The boundaries of a node, 0 for none.
  BoundarySet boundaries_of(std::size_t node) const {
    return node_boundaries.empty() ? 0 : node_boundaries[node];
  }
  /// Whether a node is the copy of another, on the back plane of a flat surface.
  bool is_copy(std::size_t node) const { return flat && (boundaries_of(node) >> 1U & 1U) != 0; }
  /// A node that stands where this one does, for a fan's own; else the node itself.
  std::size_t stands_at(std::size_t node) const {
    const std::size_t first = nodes_world.size() - fans.node_at.size();
    return node < first ? node : static_cast<std::size_t>(fans.node_at[node - first]);
  }
  bool is_fan(std::size_t patch) const {
    return patch + static_cast<std::size_t>(fans.patches) >= patches.size();
  }
  int node(int patch, int i, int j) const {
    const auto p = static_cast<std::size_t>(patch);
    return patch_nodes[p][static_cast<std::size_t>(j) * static_cast<std::size_t>(patches[p].ni) +
                          static_cast<std::size_t>(i)];
  }
};

/// Weld patches into one oriented surface with its topology and its exact wall geometry.
///
/// In      patches: world units, any order, any orientation; or curves alone (nj = 1) in one plane
///         z = const, which make a flat surface, whose columns all stay in that plane.
/// Cost    O(n log n) in the number of points.
/// Throws  InputError naming the patch and the place: a patch under 2 x 2 or with a coordinate that
///         is not finite, no area at all, three cells on one edge, a node whose cells do not form
///         one fan, a surface that cannot be oriented; a named boundary that no free edge lies on
///         or that cuts the surface; with OpenEdges::Refuse the free edges that are left.
Surface build_surface(Patches patches, const SurfaceOptions& options = {},
                      const Progress& progress = {});

/// Throws InputError naming the first of its cells, and how many there are, that cross themselves
/// as a bow tie does: a column over one can have no positive cell, whatever is done to it. Of
/// curves the first place where one crosses itself or touches itself: layers would lie in the body
/// there.
void refuse_crossed_cells(const Surface& surface);

}  // namespace vdb_offset
