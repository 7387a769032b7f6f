#include "io/cad/lying_faces.h"

#include <BRepAdaptor_Curve.hxx>
#include <BRepBndLib.hxx>
#include <BRepBuilderAPI_MakeVertex.hxx>
#include <BRepExtrema_DistShapeShape.hxx>
#include <BRepTools.hxx>
#include <BRepTopAdaptor_FClass2d.hxx>
#include <BRep_Tool.hxx>
#include <Precision.hxx>
#include <ShapeAnalysis_Surface.hxx>
#include <TopExp_Explorer.hxx>
#include <TopoDS.hxx>
#include <algorithm>
#include <cmath>
#include <optional>

namespace vdb_offset::cad {

/// A place of a face.
struct FacePlace {
  gp_Pnt point;
  std::optional<gp_Vec> normal;  ///< none on edges
};

namespace {

// |cosine| between normals of faces that lie on each other: a thousandth of a radian.
constexpr double kAlike = 1 - 5e-7;
constexpr int kPlaces = 100;      // within a face
constexpr int kFewest = 3;        // of them that are an area: a tangent plane may have one or two
constexpr int kTries = 20;        // for each of them, where a face is a small part of its box
constexpr int kPlacesOnEdge = 7;  // of each edge

std::optional<gp_Vec> normal_of(const Handle(Geom_Surface) & surface, double u, double v) {
  gp_Pnt point;
  gp_Vec along_u, along_v;
  surface->D1(u, v, point, along_u, along_v);
  const gp_Vec normal = along_u.Crossed(along_v);
  const double length = normal.Magnitude();
  if (!(length > 0)) return {};
  return normal / length;
}

/// Places within a face that no grid on it meets: Roberts' sequence of low discrepancy.
std::vector<FacePlace> places_within(const TopoDS_Face& face) {
  constexpr double kPlastic = 1.32471795724474602596;  // x^3 = x + 1
  double u0 = 0, u1 = 0, v0 = 0, v1 = 0;
  BRepTools::UVBounds(face, u0, u1, v0, v1);
  const BRepTopAdaptor_FClass2d classifier(face, Precision::PConfusion());
  const Handle(Geom_Surface) surface = BRep_Tool::Surface(face);
  std::vector<FacePlace> places;
  for (int n = 1; n <= kTries * kPlaces && std::ssize(places) < kPlaces; ++n) {
    double whole = 0;
    const double u = u0 + (u1 - u0) * std::modf(n / kPlastic, &whole);
    const double v = v0 + (v1 - v0) * std::modf(n / (kPlastic * kPlastic), &whole);
    if (classifier.Perform(gp_Pnt2d(u, v)) != TopAbs_IN) continue;
    if (const auto normal = normal_of(surface, u, v)) {
      places.push_back({surface->Value(u, v), normal});
    }
  }
  return places;
}

std::vector<FacePlace> places_on_edges(const TopoDS_Face& face) {
  std::vector<FacePlace> places;
  for (TopExp_Explorer it(face, TopAbs_EDGE); it.More(); it.Next()) {
    const TopoDS_Edge& edge = TopoDS::Edge(it.Current());
    if (BRep_Tool::Degenerated(edge)) continue;
    const BRepAdaptor_Curve curve(edge, face);
    const double first = curve.FirstParameter();
    const double step = (curve.LastParameter() - first) / (kPlacesOnEdge - 1);
    for (int n = 0; n < kPlacesOnEdge; ++n) places.push_back({curve.Value(first + n * step), {}});
  }
  return places;
}

}  // namespace

/// One of the faces, with what finds the nearest place of it.
struct Ground::Piece {
  Piece(const TopoDS_Face& of, double near_cad)
      : face(of),
        surface(BRep_Tool::Surface(of)),
        nearest(new ShapeAnalysis_Surface(surface)),
        classifier(of, Precision::PConfusion()) {
    BRepBndLib::Add(face, box, false);
    box.Enlarge(near_cad);
  }

  bool has(const FacePlace& place, double near_cad) const {
    if (box.IsOut(place.point)) return false;
    const gp_Pnt2d uv = nearest->ValueOfUV(place.point, near_cad);
    if (nearest->Gap() > near_cad) return false;
    if (place.normal) {
      const auto normal = normal_of(surface, uv.X(), uv.Y());
      if (!normal || std::abs(normal->Dot(*place.normal)) < kAlike) return false;
    }
    if (classifier.Perform(uv) != TopAbs_OUT) return true;
    const BRepExtrema_DistShapeShape away(BRepBuilderAPI_MakeVertex(place.point).Vertex(), face);
    return away.IsDone() && away.Value() <= near_cad;
  }

  TopoDS_Face face;
  Handle(Geom_Surface) surface;
  Handle(ShapeAnalysis_Surface) nearest;
  BRepTopAdaptor_FClass2d classifier;
  Bnd_Box box;
};

Ground::Ground(const std::vector<TopoDS_Face>& faces, double near_cad) : near_cad_(near_cad) {
  for (const TopoDS_Face& face : faces) pieces_.push_back(std::make_unique<Piece>(face, near_cad));
}

Ground::~Ground() = default;

/// The first of some pieces that a place is on; -1: none.
int Ground::first_under(const FacePlace& place, const std::vector<std::size_t>& some) const {
  for (const std::size_t p : some) {
    if (pieces_[p]->has(place, near_cad_)) return static_cast<int>(p);
  }
  return -1;
}

/// Those whose box meets a face's.
std::vector<std::size_t> Ground::near(const TopoDS_Face& face) const {
  Bnd_Box box;
  BRepBndLib::Add(face, box, false);
  std::vector<std::size_t> near;
  for (std::size_t p = 0; p < pieces_.size(); ++p) {
    if (!pieces_[p]->box.IsOut(box)) near.push_back(p);
  }
  return near;
}

Lying Ground::lying_of(const TopoDS_Face& face) const {
  Lying lying;
  const std::vector<std::size_t> some = near(face);
  if (some.empty()) return lying;
  int on = 0;
  const std::vector<FacePlace> within = places_within(face);
  for (const FacePlace& place : within) {
    const int under = first_under(place, some);
    if (under < 0) continue;
    if (on++ == 0) lying = {Lying::How::Apart, static_cast<std::size_t>(under), place.point};
  }
  if (on < kFewest) return lying;
  const bool is_whole = on == std::ssize(within) &&
                        std::ranges::all_of(places_on_edges(face), [&](const FacePlace& place) {
                          return first_under(place, some) >= 0;
                        });
  lying.how = is_whole ? Lying::How::Wholly : Lying::How::Partly;
  return lying;
}

std::optional<std::size_t> Ground::under(std::size_t own, const std::vector<bool>& left_out) const {
  const TopoDS_Face& face = pieces_[own]->face;
  std::vector<std::size_t> some = near(face);
  std::erase_if(some, [&](std::size_t p) { return p == own || left_out[p]; });
  if (some.empty()) return {};
  const auto is_on = [&](const FacePlace& place) { return first_under(place, some) >= 0; };
  const std::vector<FacePlace> within = places_within(face);
  if (within.empty() || !std::ranges::all_of(within, is_on)) return {};
  if (!std::ranges::all_of(places_on_edges(face), is_on)) return {};
  return static_cast<std::size_t>(first_under(within.front(), some));
}

}  // namespace vdb_offset::cad
