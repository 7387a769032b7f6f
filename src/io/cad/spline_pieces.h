#pragma once

#include <vector>

#include "vdb_offset/surface/patch.h"

namespace vdb_offset::cad {

/// A grid that a smooth spline surface goes through, and the parameters of its points, from 0 to 1,
/// along i and j.
struct SplinePiece {
  Patch patch;
  std::vector<double> u, v;
};

/// Structured patches as pieces without creases, whose whole sides are whole sides of others where
/// that takes few pieces. Sides of the same points have the same parameters: splines through them
/// are the same curve.
std::vector<SplinePiece> spline_pieces(const Patches& patches);

}  // namespace vdb_offset::cad
