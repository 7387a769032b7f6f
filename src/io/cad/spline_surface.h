#pragma once

#include <Geom_BSplineSurface.hxx>

#include "io/cad/spline_pieces.h"

namespace vdb_offset::cad {

/// The spline surface through a piece's points times `scale`, at their parameters: cubic, twice
/// continuous, its ends "not a knot"; of three points quadratic, of two straight.
Handle(Geom_BSplineSurface) spline_surface(const SplinePiece& piece, double scale);

}  // namespace vdb_offset::cad
