#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "surface/plane_finder.h"

namespace vdb_offset {

/// A plane that the wall ends on, its normal towards the wall, and the free edges there.
struct CutPlane {
  Plane plane;
  std::vector<std::size_t> edges;  ///< of the finder's
  bool is_symmetry = false;        ///< by its name, or as bodies alone stand on it
};

/// A part of a plane that the flow fills, between chains of free edges and chords: parts of the
/// lines that other planes cut it along.
struct CutFace {
  struct Chord {
    std::size_t plane;  ///< the other, of the list
    std::array<Vec3, 2> ends_world;
  };
  std::vector<std::size_t> edges;
  std::vector<Chord> chords;
  bool is_opening = false;  ///< the flow passes it; else the domain is cut there
};

/// Those of the last plane that walls alone close with their images, whether or not the others'
/// flow passes them; it may cut the wall elsewhere.
std::vector<CutFace> faces_closed_by_images(const PlaneFinder& finder,
                                            const std::vector<CutPlane>& planes);

/// Whether walls that end on a plane are straight over their image in another, one of symmetry:
/// half of a channel. `rim`: of their edges.
bool closes_with_image(const PlaneRim& rim, const CutPlane& other);

/// Of one plane.
struct CutFaces {
  std::vector<CutFace> faces;  ///< those that have a chord
  bool is_mirror = false;      ///< its images close an opening elsewhere
};

/// The faces of each plane that have a chord, and whether the flow passes them.
///
/// What is cut by a plane of symmetry is half of something: with its images in the planes of its
/// chords an inlet is closed by walls alone, all around. That is so where the planes of its chords
/// do not face each other. Of two such faces that share a chord, as the inlet of a bend's half and
/// the plane that the bend is cut by, the flow passes the one of fewer chords; of as many the one
/// whose chords are in fewer planes, or else of the shorter edges; of the same it passes neither.
/// Between two walls that go on across planes that do face each other (a channel) the flow passes
/// where the walls end straight over each other, but not beside a face that is closed by walls; so
/// it does between a wall and a plane of symmetry over it (see closes_with_image).
std::vector<CutFaces> find_cut_faces(const PlaneFinder& finder,
                                     const std::vector<CutPlane>& planes);

}  // namespace vdb_offset
