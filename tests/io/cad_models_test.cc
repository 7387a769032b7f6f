// Models of others, judged by what OpenCASCADE alone reads of them.

#include <BRepBndLib.hxx>
#include <BRepBuilderAPI_MakeVertex.hxx>
#include <BRepExtrema_DistShapeShape.hxx>
#include <BRepTools.hxx>
#include <BRep_Builder.hxx>
#include <BRep_Tool.hxx>
#include <Bnd_Box.hxx>
#include <GeomAPI_ProjectPointOnSurf.hxx>
#include <IGESControl_Reader.hxx>
#include <Message.hxx>
#include <Message_Messenger.hxx>
#include <Message_PrinterOStream.hxx>
#include <STEPControl_Reader.hxx>
#include <TopExp_Explorer.hxx>
#include <TopoDS.hxx>
#include <TopoDS_Compound.hxx>
#include <TopoDS_Face.hxx>
#include <algorithm>
#include <limits>

#include "doctest/doctest.h"
#include "support/shapes.h"
#include "vdb_offset/io/cad.h"

using namespace vdb_offset;

namespace {

template <typename Reader>
TopoDS_Shape transferred(const std::string& file) {
  Reader reader;
  Message::DefaultMessenger()->RemovePrinters(STANDARD_TYPE(Message_PrinterOStream));
  REQUIRE(reader.ReadFile(file.c_str()) == IFSelect_RetDone);
  reader.TransferRoots();
  return reader.OneShape();
}

/// STEP and IGES in millimetres, whatever their unit.
TopoDS_Shape model_of(const std::string& file) {
  if (file.ends_with(".iges")) return transferred<IGESControl_Reader>(file);
  if (!file.ends_with(".brep")) return transferred<STEPControl_Reader>(file);
  TopoDS_Shape shape;
  BRep_Builder builder;
  REQUIRE(BRepTools::Read(shape, file.c_str(), builder));
  return shape;
}

double size_of(const TopoDS_Shape& shape) {
  Bnd_Box box;
  BRepBndLib::AddOptimal(shape, box, false, false);
  const gp_XYZ sides = box.CornerMax().XYZ() - box.CornerMin().XYZ();
  return std::max({sides.X(), sides.Y(), sides.Z()});
}

/// Faces alone: a solid's inside would be at no distance.
TopoDS_Compound faces_of(const TopoDS_Shape& shape) {
  TopoDS_Compound faces;
  BRep_Builder builder;
  builder.MakeCompound(faces);
  for (TopExp_Explorer it(shape, TopAbs_FACE); it.More(); it.Next()) {
    builder.Add(faces, it.Current());
  }
  return faces;
}

double distance_of(const gp_Pnt& point, const TopoDS_Shape& shape) {
  const BRepExtrema_DistShapeShape nearest(BRepBuilderAPI_MakeVertex(point).Vertex(), shape);
  REQUIRE(nearest.IsDone());
  return nearest.Value();
}

/// From the nearest of the surfaces that faces are cut out of.
double distance_of_surfaces(const gp_Pnt& point, const TopoDS_Shape& shape) {
  double nearest = std::numeric_limits<double>::infinity();
  for (TopExp_Explorer it(shape, TopAbs_FACE); it.More(); it.Next()) {
    const GeomAPI_ProjectPointOnSurf foot(point, BRep_Tool::Surface(TopoDS::Face(it.Current())));
    if (foot.NbPoints() > 0) nearest = std::min(nearest, foot.LowerDistance());
  }
  return nearest;
}

struct Distances {
  double from_faces = 0;
  double from_surfaces = 0;  ///< where those of faces are above the tolerance; else these
  int points = 0;
};

/// Largest of every third point on sides of patches, and a few inside. Edges of a model that lie
/// apart a little have points on the surface of one of their faces, beyond where the other ends.
Distances worst_distances(const Patches& patches, const TopoDS_Shape& shape, double scale,
                          double tolerance) {
  constexpr int kInside = 97;
  const TopoDS_Compound faces = faces_of(shape);
  Distances worst;
  for (const Patch& patch : patches) {
    for (int n = 0; n < patch.ni * patch.nj; ++n) {
      const int i = n % patch.ni;
      const int j = n / patch.ni;
      const bool on_side = i == 0 || j == 0 || i == patch.ni - 1 || j == patch.nj - 1;
      if (n % (on_side ? 3 : kInside) != 0) continue;
      const Vec3 p = scale * patch.at(i, j);
      const gp_Pnt point(p.x(), p.y(), p.z());
      const double far = distance_of(point, faces);
      const double off = far > tolerance ? distance_of_surfaces(point, shape) : far;
      worst = {std::max(worst.from_faces, far), std::max(worst.from_surfaces, off),
               worst.points + 1};
    }
  }
  return worst;
}

struct Model {
  std::string name;
  int patches;
};

}  // namespace

TEST_CASE("cad: real models become structured patches, on their surfaces to 1e-9 of the size") {
  const auto shared = test::shared_data();
  if (!shared) {
    MESSAGE("skipped: ../shared/data is absent");
    return;
  }
  for (const auto& [name, patches] : {Model{"tigl_simplewing.brep", 8},
                                      {"tigl_nacelle.stp", 6},
                                      {"dealii_wigley.iges", 1},
                                      {"dealii_goteborg.step", 5}}) {
    CAPTURE(name);
    const std::string file = std::filesystem::path(*shared) / "cad" / name;
    const TopoDS_Shape model = model_of(file);
    const double size = size_of(model);
    const CadSurface read = read_cad(file);
    const double scale = read.report.unit == "m" ? 1000 : 1;
    CHECK(read.report.triangulated == 0);
    CHECK(std::ssize(read.patches) == patches);
    CHECK(std::ranges::all_of(read.patches, &Patch::is_grid));
    const Distances worst = worst_distances(read.patches, model, scale, 1e-9 * size);
    CHECK(worst.from_surfaces <= 1e-9 * size);
    CHECK(worst.from_faces <= 1e-5 * size);
  }
}
