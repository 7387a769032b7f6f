#pragma once

#include <string>
#include <vector>

#include "vdb_offset/surface/boundary.h"
#include "vdb_offset/surface/patch.h"

namespace vdb_offset {

/// Which way the blocks grow from the patches' normals.
enum class MarchSide { Along, Against, Both };

/// What becomes of free edges.
enum class OpenEdges {
  Auto,    ///< planes are looked for; on edges that lie on none columns lean outward
  Splay,   ///< columns lean outward, but for those on a boundary that was named
  Refuse,  ///< as Auto, but an edge that is left is an error
};

/// How a field tells the sides of a surface.
enum class SideRule {
  Manifold,  ///< by the normals of a surface that is welded and oriented: what layers need
  Winding,   ///< inside is where the winding number of all faces is above a half: faces may be
             ///< doubled, leave gaps and cross each other, but most have to face the same way
  Unsigned   ///< there are none: any faces will do
};

/// A boundary plane that the user names; its normal may point to either side. One that is given
/// several times is shared: each name is that of the opening of the flow, or of the free edges that
/// hang together, nearest to its point.
struct NamedPlane {
  std::string name;
  Plane plane;
  /// Where the plane is given several times: this name is that of all that no other takes, not of
  /// the part that the plane's point is nearest to.
  bool rest = false;
  bool is_flat = false;  ///< a line in two dimensions, no plane
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
  /// within them, others end on them. They must not lie on the wall. Shapes and internals are
  /// curves where the surface is made of curves, and are not called as a part of it is.
  std::vector<NamedShape> internals;
  /// With another rule than Manifold the surface is for a field alone: points are welded, but faces
  /// are left as they are, without orientation, topology or boundaries.
  SideRule sides = SideRule::Manifold;
  /// Extra columns of cells at sharp convex edges (see Fans).  Range: [0, 64]; 0: none.
  int fans = 0;

  void validate() const;
};

/// Free edges within this part of the surface's size of a plane lie on it.
inline constexpr double kOnPlane = 1e-6;
/// Nodes within this part of the spacing there of a boundary shape lie on it, or within 0.03 of its
/// facets' size.
inline constexpr double kOnShape = 0.05;

}  // namespace vdb_offset
