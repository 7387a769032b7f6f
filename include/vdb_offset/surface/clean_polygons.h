#pragma once

#include <array>
#include <cstddef>
#include <string>
#include <vector>

#include "vdb_offset/core/progress.h"
#include "vdb_offset/surface/patch.h"
#include "vdb_offset/surface/polygons.h"

namespace vdb_offset {

struct CleanOptions {
  /// Points closer than this part of the shorter of their local edges become one, beside those that
  /// are equal, which always do.  Range: [0, 0.5).
  double weld = 0.01;
  /// Only points on edges of one face become one with others that are near: gaps between parts that
  /// are closed without that stay open, however narrow.
  bool weld_free_alone = false;
  /// Closed parts get normals that point out of the volume that they enclose. One within another
  /// stays to that as the file has it: turned against it, it is the shell of a hollow. Without this
  /// the sense of most of a part's faces stays.
  bool turn_outward = true;
  /// Quads with a corner of 180 degrees or more become triangles, as polygons of five corners do.
  bool split_concave_quads = true;

  void validate() const;
};

/// A place where a surface is no wall, world units.
struct PolygonFlaw {
  Vec3 from_world;
  Vec3 to_world;         ///< other end of an edge; of a point the same
  int count = 0;         ///< faces of an edge; fans of a point
  std::size_t face = 0;  ///< of a face its number in the file, from 1
};

/// What clean_polygons did, and what it cannot mend.
struct CleanReport {
  std::size_t welded_equal = 0;  ///< points, each onto another that is equal
  std::size_t welded_near = 0;   ///< points, each onto another within the tolerance
  double moved_max_world = 0;    ///< farthest of the latter
  std::array<Vec3, 2> moved_farthest_world{Vec3::Zero(), Vec3::Zero()};  ///< from there to here
  std::size_t unused_points = 0;
  std::size_t degenerate_faces = 0;   ///< of fewer than three different points; dropped
  std::size_t duplicate_faces = 0;    ///< of the same points round them, in either sense; dropped
  std::size_t turned_faces = 0;       ///< reversed, for whatever reason
  std::size_t turned_parts = 0;       ///< closed parts whose normals pointed inward
  std::size_t split_polygons = 0;     ///< of five corners or more, and concave quads
  std::size_t crossed_polygons = 0;   ///< of these: cross themselves, or have no area
  std::size_t flipped_triangles = 0;  ///< without area, made one with the face across
  std::size_t flat_triangles = 0;     ///< without area that are left
  PolygonFlaw first_flat;             ///< of these, its longest edge

  int parts = 0;         ///< sets of faces that edges connect
  int closed_parts = 0;  ///< of these: without boundary edges
  std::size_t boundary_edges = 0;
  double area_world = 0;

  std::vector<PolygonFlaw> crossed_faces;     ///< an edge that another one of the face crosses
  std::vector<PolygonFlaw> many_faced_edges;  ///< of more than two faces
  std::vector<PolygonFlaw> many_fan_points;   ///< whose faces form more than one fan
  std::vector<PolygonFlaw> twisted_edges;     ///< whose faces cannot be made to agree; one a part

  /// Whether layers can grow on what is left.
  bool is_meshable() const { return crossed_faces.empty() && is_manifold(); }
  bool is_manifold() const {
    return many_faced_edges.empty() && many_fan_points.empty() && twisted_edges.empty();
  }
};

struct CleanedPolygons {
  PolygonMesh mesh;          ///< triangles and quads alone; every point is used
  std::vector<int> numbers;  ///< of each face that of the one in `mesh` given that it came from
  CleanReport report;
};

/// Make a surface of what a file holds: points welded (but for two sides of something thin, which
/// go opposite ways, unless nearer than a thousandth of the tolerance), faces that are none
/// dropped, neighbours of one sense, large polygons split.
///
/// In       any polygons whose corners are points and whose used points are finite.
/// Out      triangles and quads; those that were so in the order of the file, the pieces of a
///          polygon in its place. A polygon is split by clipping ears in the plane of its vector
///          area. Triangles no higher than 1e-6 of their longest edge are flipped with the face
///          across that, and gone without a change of the surface. Parts are oriented over edges of
///          two faces; with `turn_outward` closed ones get a positive volume. What remains wrong is
///          data in the report, with its places.
/// Cost     O(n log n) of n corners; a polygon of m corners, r of them concave: m * r.
/// Throws   InputError for a polygon of more than kMostCorners corners, or if no face remains.
CleanedPolygons clean_polygons(const PolygonMesh& mesh, const CleanOptions& options = {},
                               const Progress& progress = {});

constexpr std::size_t kMostCorners = 10000;

/// Throws InputError if the report says that no layers can grow on the surface: file, place, how
/// many, the rule and what to do, and `more` of that. A distance field can still be had of it.
void refuse_unmeshable(const PolygonMesh& mesh, const CleanReport& report,
                       const std::string& more = {});

/// What another tolerance would do for a mesh that cleaning with these options leaves as one that
/// `refuse_unmeshable` refuses, in words for that; empty: nothing.
/// Cost  at most ten times that of cleaning it.
std::string weld_advice(const PolygonMesh& mesh, const CleanOptions& options);

/// A patch of faces for each family that has any, its points used once and in the order of its
/// faces. Names and families are those of the mesh; without them, "patch 1". Faces are triangles
/// and quads (see clean_polygons): throws InputError for others.
Patches face_patches(const PolygonMesh& mesh);

}  // namespace vdb_offset
