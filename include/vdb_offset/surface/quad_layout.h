#pragma once

#include <numbers>

#include "vdb_offset/surface/patch.h"
#include "vdb_offset/surface/polygons.h"

namespace vdb_offset {

struct QuadLayoutOptions {
  /// Edges over which the normal turns by more are features, unless the surface goes on turning at
  /// least half as much over the next edge on both sides: that is a curved wall of large cells.
  /// Radians.  Range: (0, pi]; pi: none.  Features end patches, so that a smaller value gives more.
  double feature_turn = std::numbers::pi / 6;
  /// Whether neighbours that make up a rectangle become one patch.
  bool merge = true;

  void validate() const;
};

/// What the layout found, and what it did.
struct QuadLayoutReport {
  int irregular_vertices = 0;   ///< inside the surface: of other than four quads
  int boundary_corners = 0;     ///< on free edges: of other than two quads
  int feature_edges = 0;        ///< edges of the mesh that are patch borders because they are sharp
  int loose_feature_edges = 0;  ///< sharp, but their line ends within the surface: no borders
  int family_edges = 0;         ///< edges of the mesh between families
  int seams = 0;                ///< cuts through tubes and tori
  int traced_patches = 0;       ///< before merging
};

/// Structured patches that a mesh of quads falls into.
struct QuadLayout {
  Patches patches;
  QuadLayoutReport report;
};

/// Part a mesh of quads into structured patches, few and large.
///
/// Grid lines run from irregular vertices (inside, of other than four quads; on the boundary, of
/// three or more) straight on until they meet a border or another line; what lies between is
/// rectangular. Then neighbours are merged where a patch's whole side is made up of whole sides.
/// Sides of patches meet parts of sides, or several: T-junctions, as in `Topology`. Patches end at
/// families, and at features where these run along grid lines from one border, corner or irregular
/// vertex to another, or round. Other features lie within patches. A tube becomes one patch whose
/// first and last column are the same points, a torus one that meets itself both ways.
///
/// In      quads alone, welded, each edge of one or two of them, oriented alike, no two fans at a
///         point; any numbering: the layout depends on the coordinates alone.
/// Out     every quad once; points bit for bit; normals (d/di x d/dj) those of the quads; one
///         family a patch. Named "<family> 1" ..., without families "block 1" ...
/// Cost    near linear: 1e6 quads take about a second.
/// Throws  InputError naming file, face and place for any other mesh.
QuadLayout quad_layout(const PolygonMesh& mesh, const QuadLayoutOptions& options = {});

}  // namespace vdb_offset
