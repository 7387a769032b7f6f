#pragma once

#include <ShapeBuild_ReShape.hxx>
#include <TopoDS_Face.hxx>
#include <TopoDS_Shape.hxx>

namespace vdb_offset::cad {

/// Whether a face has a line of equal parameters within it, as at knots of B-splines, along which
/// its surface turns by more than edges do on smooth ones.
bool has_kink(const TopoDS_Face& face);

/// Splits faces along such lines. What became of the shape's parts; null: it has none, or
/// OpenCASCADE makes no valid shape of it.
Handle(ShapeBuild_ReShape) split_kinks(const TopoDS_Shape& shape);

}  // namespace vdb_offset::cad
