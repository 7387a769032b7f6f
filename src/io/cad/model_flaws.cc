#include "io/cad/model_flaws.h"

#include <fmt/format.h>

#include <BRepAdaptor_Curve.hxx>
#include <BRepAdaptor_Surface.hxx>
#include <BRep_Tool.hxx>
#include <Geom2d_Curve.hxx>
#include <GeomAPI_ProjectPointOnSurf.hxx>
#include <TopExp.hxx>
#include <TopExp_Explorer.hxx>
#include <TopTools_IndexedDataMapOfShapeListOfShape.hxx>
#include <TopoDS.hxx>

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "io/cad/kinks.h"

namespace vdb_offset::cad {
namespace {

std::string in_words(const gp_Pnt& place, const Model& model) {
  const gp_XYZ p = model.world_per_cad * place.XYZ();
  return fmt::format("({:.6g}, {:.6g}, {:.6g})", p.X(), p.Y(), p.Z());
}

/// Edges of one face.
struct Open {
  int edges = 0;
  gp_Pnt place;  // on the first
};

void find_open(const Model& model, std::vector<std::string>& words) {
  TopTools_IndexedMapOfShape faces;
  for (const NamedFace& named : model.faces) faces.Add(named.face);
  TopTools_IndexedDataMapOfShapeListOfShape around;
  TopExp::MapShapesAndAncestors(model.shape, TopAbs_EDGE, TopAbs_FACE, around);
  std::map<std::string, Open> open;
  for (int e = 1; e <= around.Extent(); ++e) {
    const TopoDS_Edge edge = TopoDS::Edge(around.FindKey(e));
    if (!is_free(edge, around(e))) continue;
    const int face = faces.FindIndex(around(e).First());
    const std::string closed =
        face > 0 ? model.faces[static_cast<std::size_t>(face - 1)].closed : std::string();
    if (closed.empty()) continue;
    Open& one = open[closed];
    if (one.edges++ > 0) continue;
    const BRepAdaptor_Curve curve(edge);
    one.place = curve.Value(0.5 * (curve.FirstParameter() + curve.LastParameter()));
  }
  for (const auto& [closed, one] : open) {
    words.push_back(fmt::format(
        "its {} comes out open: {} edge{} with one face alone, the first at {}; faces are missing, "
        "or lie farther apart than edges are sewn for",
        closed, one.edges, one.edges == 1 ? "" : "s", in_words(one.place, model)));
  }
}

/// How far an edge's curve lies off a face's surface, and where; 0: no more than `least_cad`.
std::pair<double, gp_Pnt> gap_of(const TopoDS_Edge& edge, const TopoDS_Face& face,
                                 double least_cad) {
  const BRepAdaptor_Surface surface(face, false);
  constexpr int kSamples = 16;
  std::pair<double, gp_Pnt> widest{0, {}};
  double first = 0, last = 0;
  const Handle(Geom2d_Curve) flat = BRep_Tool::CurveOnSurface(edge, face, first, last);
  TopLoc_Location location;
  double from = 0, to = 0;
  if (flat.IsNull() || BRep_Tool::Curve(edge, location, from, to).IsNull()) return widest;
  const BRepAdaptor_Curve curve(edge);
  for (int k = 0; k <= kSamples; ++k) {
    const double part = double(k) / kSamples;
    const gp_Pnt2d uv = flat->Value(std::lerp(first, last, part));
    const gp_Pnt place = curve.Value(std::lerp(from, to, part));
    double off = place.Distance(surface.Value(uv.X(), uv.Y()));
    if (!(off > least_cad)) continue;
    // The two may be divided in other ways.
    const GeomAPI_ProjectPointOnSurf nearest(place, BRep_Tool::Surface(face));
    if (nearest.NbPoints() > 0) off = std::min(off, nearest.LowerDistance());
    if (off > widest.first) widest = {off, place};
  }
  return widest;
}

void find_gaps(const Model& model, std::vector<std::string>& words) {
  constexpr double kMost = 1e-4;  // of the size
  const NamedFace* worst = nullptr;
  std::pair<double, gp_Pnt> widest{kMost * model.size_cad, {}};
  int faces = 0;
  for (const NamedFace& named : model.faces) {
    bool is_off = false;
    for (TopExp_Explorer it(named.face, TopAbs_EDGE); it.More(); it.Next()) {
      const TopoDS_Edge edge = TopoDS::Edge(it.Current().Oriented(TopAbs_FORWARD));
      if (BRep_Tool::Degenerated(edge)) continue;
      const std::pair<double, gp_Pnt> gap = gap_of(edge, named.face, kMost * model.size_cad);
      is_off = is_off || gap.first > kMost * model.size_cad;
      if (!(gap.first > widest.first)) continue;
      widest = gap;
      worst = &named;
    }
    faces += is_off ? 1 : 0;
  }
  if (worst == nullptr) return;
  words.push_back(
      fmt::format("{} of its faces {} edges off the surface, the farthest face {}{}, by {:.3g} at "
                  "{}: points on edges lie on the surface of one face alone",
                  faces, faces == 1 ? "has" : "have", worst->number,
                  worst->name.empty() ? "" : " '" + worst->name + "'",
                  widest.first * model.world_per_cad, in_words(widest.second, model)));
}

void find_kinks(const Model& model, std::vector<std::string>& words) {
  for (const NamedFace& named : model.faces) {
    if (!has_kink(named.face)) continue;
    words.push_back(fmt::format(
        "face {}{} has a kink within, which cells go over as if it were smooth: OpenCASCADE does "
        "not split it there; split it in a CAD program",
        named.number, named.name.empty() ? "" : " '" + named.name + "'"));
  }
}

}  // namespace

std::vector<std::string> flaws_of(const Model& model) {
  std::vector<std::string> words;
  find_open(model, words);
  find_gaps(model, words);
  find_kinks(model, words);
  return words;
}

}  // namespace vdb_offset::cad
