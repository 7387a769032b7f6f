#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "surface/cut_faces.h"
#include "surface/plane_finder.h"

namespace vdb_offset {

/// Free edges in one plane that belong together: a loop around the flow with those of bodies in it
/// (a casing and its hub), two walls that the flow passes between, or else a chain of edges.
struct PlanePart {
  std::vector<std::size_t> edges;  ///< of the finder's
  bool is_opening = false;         ///< they close around the flow
  double length_world = 0;
  Vec3 centre_world = Vec3::Zero();  ///< of its box
  /// Lines that close an opening where other planes cut it.
  std::vector<std::array<Vec3, 2>> closing_world = {};
};

/// The parts of some edges in a plane, the longest first, of those as long the one of lower x, then
/// y, then z. `cut`: faces of the plane that other planes cut, where these are known.
std::vector<PlanePart> parts_in(const PlaneFinder& finder, const Plane& plane,
                                const std::vector<std::size_t>& edges, const CutFaces& cut = {});

/// What gets a name of its own when nobody says more, of such parts: openings apart by a quarter of
/// their size or more (nearer ones are the bays of one, as between piers), and all that is no
/// opening together, last.
std::vector<PlanePart> boundaries_in(const PlaneFinder& finder, const Plane& plane,
                                     std::vector<PlanePart> parts);

/// How far a point is from a part, seen along the plane's normal: 0 within its edges.
double distance_to(const PlaneFinder& finder, const Plane& plane, const PlanePart& part,
                   const Vec3& point_world);

/// Whether `a` comes before `b` by lengths, or by places where those are the same.
bool comes_before(const PlanePart& a, const PlanePart& b);

}  // namespace vdb_offset
