#pragma once

#include <cstddef>
#include <vector>

#include "vdb_offset/surface/polygons.h"

namespace vdb_offset {

/// A mesh of quads by its half-edges: half-edge h = 4 * face + s runs along the face's side from
/// corner s to the next, counter-clockwise.
struct QuadEdges {
  const PolygonMesh& mesh;
  std::vector<int> twin;      ///< the half-edge that runs the other way, -1 on the boundary
  std::vector<int> start;     ///< of each point a half-edge that leaves it: the first,
                              ///< counter-clockwise, on the boundary; -1: the point is unused
  std::vector<char> regular;  ///< of each point: inside, with four quads

  static int next(int h) { return (h & ~3) | ((h + 1) & 3); }
  static int previous(int h) { return (h & ~3) | ((h + 3) & 3); }
  static int opposite(int h) { return h ^ 2; }

  int size() const { return static_cast<int>(twin.size()); }
  int twin_of(int h) const { return twin[static_cast<std::size_t>(h)]; }
  int from(int h) const { return mesh.corners[static_cast<std::size_t>(h)]; }
  int to(int h) const { return from(next(h)); }
  bool is_regular(int point) const { return regular[static_cast<std::size_t>(point)] != 0; }
  const Vec3& place(int point) const { return mesh.points_world[static_cast<std::size_t>(point)]; }
  /// The half-edge that goes straight on where h ends, across a twin of next(h).
  int straight_on(int h) const { return next(twin_of(next(h))); }
  /// The next half-edge that leaves the same point, counter-clockwise; -1 at the boundary.
  int turn_left(int h) const { return twin_of(previous(h)); }
  /// Order that no numbering changes, as long as no two points are equal bit for bit.
  bool before(int a, int b) const;
};

/// Throws InputError for a mesh that quad_layout() does not take.
QuadEdges build_quad_edges(const PolygonMesh& mesh);

/// What a half-edge is to the layout; both halves of an edge are the same.
enum class Cut : char {
  None,   ///< inside a patch
  Trace,  ///< a patch border that may be given up
  Kept,   ///< one that stays: the boundary, between families, a feature
};

/// The borders of patches.
struct QuadCuts {
  std::vector<Cut> of;  ///< of each half-edge

  bool is_cut(int h) const { return of[static_cast<std::size_t>(h)] != Cut::None; }
  bool is_kept(int h) const { return of[static_cast<std::size_t>(h)] == Cut::Kept; }
  void set(const QuadEdges& edges, int h, Cut cut) {
    of[static_cast<std::size_t>(h)] = cut;
    if (edges.twin_of(h) >= 0) of[static_cast<std::size_t>(edges.twin_of(h))] = cut;
  }
  /// Whether h begins a side of its patch, at a corner.
  bool is_corner(int h) const { return is_cut(h) && is_cut(QuadEdges::previous(h)); }
};

}  // namespace vdb_offset
