#pragma once

#include <array>

#include "io/cad/face_plan.h"
#include "vdb_offset/surface/patch.h"

namespace vdb_offset::cad {

/// Sides of a grid: bottom and top run along i, left and right along j.
struct Borders {
  Border bottom, right, top, left;
};

/// Where a transfinite interpolation between four lines of points lies in the plane, for the parts
/// of the way along i and j.
Vec2 blend(const Borders& borders, double along_i, double along_j);

/// The patches that a plan makes of a face, without names; nothing where cells are turned over.
/// Ordered so that d/di x d/dj is the face's normal.
std::vector<Patch> grids_of(const Face& face, const Plan& plan, const SharedEdges& edges);

}  // namespace vdb_offset::cad
