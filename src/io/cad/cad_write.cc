#include <fmt/format.h>

#include <BRepBuilderAPI_MakeFace.hxx>
#include <BRepBuilderAPI_Sewing.hxx>
#include <GeomAPI_PointsToBSplineSurface.hxx>
#include <Geom_BSplineSurface.hxx>
#include <Interface_Static.hxx>
#include <STEPControl_Controller.hxx>
#include <STEPControl_Writer.hxx>
#include <Standard_Failure.hxx>
#include <TColgp_Array2OfPnt.hxx>
#include <TopoDS_Face.hxx>

#include "io/cad/cad_file.h"
#include "io/cad_module.h"
#include "vdb_offset/core/error.h"
#include "vdb_offset/io/cad.h"

namespace vdb_offset::cad {
namespace {

TopoDS_Face face_of(const Patch& patch, double unit_mm) {
  TColgp_Array2OfPnt points(1, patch.ni, 1, patch.nj);
  for (int j = 0; j < patch.nj; ++j) {
    for (int i = 0; i < patch.ni; ++i) {
      const Vec3 p = patch.at(i, j) * unit_mm;
      points(i + 1, j + 1) = gp_Pnt(p.x(), p.y(), p.z());
    }
  }
  GeomAPI_PointsToBSplineSurface through;
  through.Interpolate(points);
  constexpr double kPole = 1e-7;  // OpenCASCADE's own, in millimetres
  return BRepBuilderAPI_MakeFace(through.Surface(), kPole).Face();
}

TopoDS_Shape shape_of(const Patches& patches, double unit_mm, const std::string& file) {
  Box box;
  for (const Patch& patch : patches) {
    for (const Vec3& p : patch.points_world) box.add(p);
  }
  constexpr double kSewn = 1e-5;  // of the size
  BRepBuilderAPI_Sewing sewing(kSewn * box.size() * unit_mm);
  for (const Patch& patch : patches) {
    if (!patch.is_grid() || patch.nj < 2) {
      throw InputError(fmt::format("{}: STEP is of structured patches, but '{}' is {}; write {}",
                                   file, patch.name, patch.nj == 1 ? "a curve" : "made of polygons",
                                   patch.nj == 1 ? ".obj" : ".stl"));
    }
    sewing.Add(face_of(patch, unit_mm));
  }
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
