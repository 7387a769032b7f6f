#pragma once

#include <memory>
#include <string>
#include <vector>

#include "vdb_offset/core/progress.h"
#include "vdb_offset/core/vec.h"
#include "vdb_offset/surface/boundary.h"
#include "vdb_offset/surface/fans.h"
#include "vdb_offset/surface/patch.h"
#include "vdb_offset/surface/topology.h"
#include "vdb_offset/surface/wall.h"

namespace vdb_offset {

/// Which way the blocks grow from the patches' normals.
enum class MarchSide { Along, Against, Both };

/// What becomes of free edges.
enum class OpenEdges {
  Auto,    ///< planes are looked for; on edges that lie on none columns lean outward
  Splay,   ///< columns lean outward, but for those on a boundary that was named
  Refuse,  ///< as Auto, but an edge that is left is an error
};

/// A boundary plane that the user names; its normal may point to either side.
struct NamedPlane {
  std::string name;
  Plane plane;
};

/// A boundary surface of any shape, as patches of any orientation.
struct NamedShape {
  std::string name;
  Patches patches;
  /// Part of the wall, but without layers: free edges where the wall goes on into it smoothly are
  /// left to taper, and touching none at an angle it is an internal surface, no error.
  bool is_bare_wall = false;
};

struct SurfaceOptions {
  /// Marching side, relative to the normals of each component's first patch.
  MarchSide side = MarchSide::Along;
  /// Factor applied to every coordinate on reading.  Range: > 0.
  double scale = 1.0;
  /// Points closer than this part of the shorter of their local spacings become one node.
  /// Range: [0, 0.5).  Local spacing: shortest edge of non-zero length at the point.
  double weld = 0.01;
  /// What becomes of free edges. Planes are found where all of the surface lies on one side, at an
  /// angle of 45 degrees or more to it, and free edges lie within kOnPlane of the surface's size;
  /// and at openings of the flow, closed loops of such edges, whose plane the surface passes
  /// elsewhere.
  OpenEdges open_edges = OpenEdges::Auto;
  /// Boundaries that are known: planes with the whole surface on one side, or with openings of the
  /// flow in them; and shapes that free edges lie on to kOnShape of the spacing there. They come
  /// before those that are found.
  std::vector<NamedPlane> planes;
  std::vector<NamedShape> shapes;
  /// Internal, permeable surfaces, two-sided: columns of wall nodes on them (to kOnShape) march
  /// within them, others end on them.
  std::vector<NamedShape> internals;
  /// Extra columns of cells at sharp convex edges (see Fans).  Range: [0, 64]; 0: none.
  int fans = 0;

  void validate() const;
};

/// What happened on the way from patches to nodes.
struct SurfaceReport {
  std::vector<int> flipped;  ///< patches turned round (i reversed) to agree with their neighbours
  double weld_distance_max_world = 0;      ///< farthest that a point moved to its node
  double boundary_distance_max_world = 0;  ///< farthest that a node moved onto its boundary
  int taper_edges = 0;  ///< free edges where the wall goes on smoothly without layers
  double median_edge_world = 0;
  double shortest_edge_world = 0;  ///< of the edges that are not collapsed
  int split_patches = 0;           ///< pieces more, of patches that sharp edges run through
  int fans = 0;                    ///< patches that open an edge
  int fan_corners = 0;             ///< corners opened, by three patches each
};

/// Free edges within this part of the surface's size of a plane lie on it.
inline constexpr double kOnPlane = 1e-6;
/// Nodes within this part of the spacing there of a boundary shape lie on it, or within 0.03 of its
/// facets' size.
inline constexpr double kOnShape = 0.05;

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
  bool closed = false;                           ///< no free edge
  bool both_sides = false;
  /// Made of curves in the plane z = 0: each patch is its curve (j = 0) and the same, moved along z
  /// (j = 1); the first boundaries are those planes, "front" and "back".
  bool flat = false;
  static constexpr std::size_t kFlatPlanes = 2;
  SurfaceReport report;

  int points() const;      ///< sum of ni * nj
  int faces() const;       ///< grid cells with at least three nodes, over all patches
  int free_edges() const;  ///< grid edges used once, those on boundaries too
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

}  // namespace vdb_offset
