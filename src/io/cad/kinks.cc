#include "io/cad/kinks.h"

#include <BRepAdaptor_Surface.hxx>
#include <BRepCheck_Analyzer.hxx>
#include <GeomAdaptor_Surface.hxx>
#include <ShapeUpgrade_FaceDivide.hxx>
#include <ShapeUpgrade_ShapeDivide.hxx>
#include <ShapeUpgrade_SplitSurface.hxx>
#include <TColStd_Array1OfReal.hxx>
#include <TColStd_HSequenceOfReal.hxx>
#include <TopExp_Explorer.hxx>
#include <TopoDS.hxx>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

namespace vdb_offset::cad {
namespace {

/// Whether normals before and after a parameter differ anywhere along its line.
bool is_kink(const Adaptor3d_Surface& surface, bool along_u, double at, double step) {
  constexpr int kSamples = 8;
  constexpr double kLeast = std::numbers::pi / 12;  // as much as edges turn that are smooth
  const double from = along_u ? surface.FirstVParameter() : surface.FirstUParameter();
  const double to = along_u ? surface.LastVParameter() : surface.LastUParameter();
  for (int k = 0; k <= kSamples; ++k) {
    const double across = std::lerp(from, to, (k + 0.5) / (kSamples + 1));
    gp_Vec normal[2];
    for (const int side : {0, 1}) {
      const double here = at + (side == 0 ? -step : step);
      gp_Pnt p;
      gp_Vec du, dv;
      along_u ? surface.D1(here, across, p, du, dv) : surface.D1(across, here, p, du, dv);
      normal[side] = du.Crossed(dv);
    }
    const bool is_pole = normal[0].SquareMagnitude() == 0 || normal[1].SquareMagnitude() == 0;
    if (!is_pole && normal[0].Angle(normal[1]) > kLeast) return true;
  }
  return false;
}

/// The parameters of kinks between a surface's ends.
std::vector<double> kinks_of(const Adaptor3d_Surface& surface, bool along_u) {
  const int count = along_u ? surface.NbUIntervals(GeomAbs_C1) : surface.NbVIntervals(GeomAbs_C1);
  std::vector<double> kinks;
  if (count < 2) return kinks;
  TColStd_Array1OfReal ends(1, count + 1);
  along_u ? surface.UIntervals(ends, GeomAbs_C1) : surface.VIntervals(ends, GeomAbs_C1);
  for (int n = 2; n <= count; ++n) {
    constexpr double kStep = 1e-6;  // of the shorter interval: a curve turns little over it
    const double step = kStep * std::min(ends(n) - ends(n - 1), ends(n + 1) - ends(n));
    if (step > 0 && is_kink(surface, along_u, ends(n), step)) kinks.push_back(ends(n));
  }
  return kinks;
}

class KinkSplit : public ShapeUpgrade_SplitSurface {
 public:
  void Compute(const Standard_Boolean) override {
    const GeomAdaptor_Surface surface(mySurface, myUSplitValues->First(), myUSplitValues->Last(),
                                      myVSplitValues->First(), myVSplitValues->Last());
    for (const double u : kinks_of(surface, true)) add(myUSplitValues, u);
    for (const double v : kinks_of(surface, false)) add(myVSplitValues, v);
  }

 private:
  static void add(const Handle(TColStd_HSequenceOfReal) & values, double value) {
    values->InsertBefore(values->Length(), value);
  }
};

}  // namespace

bool has_kink(const TopoDS_Face& face) {
  const BRepAdaptor_Surface surface(face, true);
  return !kinks_of(surface, true).empty() || !kinks_of(surface, false).empty();
}

Handle(ShapeBuild_ReShape) split_kinks(const TopoDS_Shape& shape) {
  TopExp_Explorer face(shape, TopAbs_FACE);
  while (face.More() && !has_kink(TopoDS::Face(face.Current()))) face.Next();
  if (!face.More()) return {};
  const Handle(ShapeUpgrade_FaceDivide) faces = new ShapeUpgrade_FaceDivide();
  faces->SetSplitSurfaceTool(new KinkSplit());
  ShapeUpgrade_ShapeDivide divide(shape);
  divide.SetSplitFaceTool(faces);
  divide.Perform();
  const bool is_valid = BRepCheck_Analyzer(divide.GetContext()->Apply(shape)).IsValid();
  return is_valid ? divide.GetContext() : Handle(ShapeBuild_ReShape)();
}

}  // namespace vdb_offset::cad
