#include <fmt/format.h>

#include <BRepBuilderAPI_MakeFace.hxx>
#include <BRepBuilderAPI_Sewing.hxx>
#include <Interface_Static.hxx>
#include <STEPControl_Controller.hxx>
#include <STEPControl_Writer.hxx>
#include <Standard_Failure.hxx>
#include <TopoDS_Face.hxx>
#include <algorithm>
#include <vector>

#include "io/cad/cad_file.h"
#include "io/cad/spline_pieces.h"
#include "io/cad/spline_surface.h"
#include "io/cad_module.h"
#include "vdb_offset/core/error.h"
#include "vdb_offset/io/cad.h"

namespace vdb_offset::cad {
namespace {

TopoDS_Face face_of(const SplinePiece& piece, double unit_mm) {
  constexpr double kPole = 1e-7;  // OpenCASCADE's own, in millimetres
  return BRepBuilderAPI_MakeFace(spline_surface(piece, unit_mm), kPole).Face();
}

double side_length(const Patch& patch, int side) {
  const bool along_i = side < 2;
  const int last = along_i ? patch.ni - 1 : patch.nj - 1;
  const int across = side % 2 == 0 ? 0 : (along_i ? patch.nj : patch.ni) - 1;
  double length = 0;
  for (int k = 0; k < last; ++k) {
    length += along_i ? (patch.at(k + 1, across) - patch.at(k, across)).norm()
                      : (patch.at(across, k + 1) - patch.at(across, k)).norm();
  }
  return length;
}

/// Where sides meet parts of sides splines share points, and part a little between them: less than
/// any side is long.
double gap_world(const std::vector<SplinePiece>& pieces) {
  constexpr double kOfSize = 1e-4;
  constexpr double kOfSide = 0.05;
  Box box;
  double shortest = 1e300;
  for (const auto& [patch, u, v] : pieces) {
    for (const Vec3& p : patch.points_world) box.add(p);
    for (int side = 0; side < 4; ++side) {
      if (const double length = side_length(patch, side); length > 0) {
        shortest = std::min(shortest, length);
      }
    }
  }
  return std::min(kOfSize * box.size(), kOfSide * shortest);
}

TopoDS_Shape shape_of(const Patches& patches, double unit_mm, const std::string& file) {
  for (const Patch& patch : patches) {
    if (patch.is_grid() && patch.nj > 1) continue;
    throw InputError(fmt::format("{}: STEP is of structured patches, but '{}' is {}; write {}",
                                 file, patch.name, patch.nj == 1 ? "a curve" : "made of polygons",
                                 patch.nj == 1 ? ".obj" : ".stl"));
  }
  const std::vector<SplinePiece> pieces = spline_pieces(patches);
  BRepBuilderAPI_Sewing sewing(gap_world(pieces) * unit_mm);
  for (const SplinePiece& piece : pieces) sewing.Add(face_of(piece, unit_mm));
  sewing.Perform();
  return sewing.SewedShape();
}

}  // namespace

void vdb_offset_cad_write(const std::string& file, const std::string& target,
                          const Patches& patches, const std::string& unit) {
  keep_quiet();
  try {
    const Length length = length_of(unit.empty() ? "mm" : unit);
    STEPControl_Controller::Init();
    Interface_Static::SetCVal("write.step.unit", length.step_name);  // before there is a writer
    STEPControl_Writer writer;
    const bool is_written = writer.Transfer(shape_of(patches, length.mm, target),
                                            STEPControl_AsIs) == IFSelect_RetDone &&
                            writer.Write(file.c_str()) == IFSelect_RetDone;
    if (!is_written) throw IoError(target + ": cannot be written (disk full?)");
  } catch (const Standard_Failure& failure) {
    throw IoError(
        fmt::format("{}: OpenCASCADE cannot write it: {}", target, failure.GetMessageString()));
  }
}

}  // namespace vdb_offset::cad
