#include "io/cad/cad_shape.h"

#include <BRepBndLib.hxx>
#include <BRepBuilderAPI_Sewing.hxx>
#include <BRepCheck_Analyzer.hxx>
#include <BRepLib.hxx>
#include <BRep_Tool.hxx>
#include <Bnd_Box.hxx>
#include <ShapeBuild_ReShape.hxx>
#include <ShapeFix_Face.hxx>
#include <ShapeFix_Shape.hxx>
#include <TopExp.hxx>
#include <TopExp_Explorer.hxx>
#include <TopTools_IndexedDataMapOfShapeListOfShape.hxx>
#include <TopTools_IndexedMapOfShape.hxx>
#include <TopoDS.hxx>

#include <algorithm>
#include <map>
#include <numeric>

#include "io/cad/cad_file.h"
#include "vdb_offset/core/error.h"

namespace vdb_offset::cad {
namespace {

double longest_side(const TopoDS_Shape& shape) {
  Bnd_Box box;
  BRepBndLib::Add(shape, box, false);
  if (box.IsVoid() || box.IsOpen()) return 0;
  const gp_Pnt lo = box.CornerMin();
  const gp_Pnt hi = box.CornerMax();
  return std::max({hi.X() - lo.X(), hi.Y() - lo.Y(), hi.Z() - lo.Z()});
}

bool is_free(const TopoDS_Edge& edge, const TopTools_ListOfShape& faces) {
  return faces.Extent() == 1 && !BRep_Tool::Degenerated(edge) &&
         !BRep_Tool::IsClosed(edge, TopoDS::Face(faces.First()));
}

/// Edges of one face, seams and poles aside.
int free_edges(const TopoDS_Shape& shape) {
  TopTools_IndexedDataMapOfShapeListOfShape faces;
  TopExp::MapShapesAndAncestors(shape, TopAbs_EDGE, TopAbs_FACE, faces);
  int count = 0;
  for (int e = 1; e <= faces.Extent(); ++e) {
    count += is_free(TopoDS::Edge(faces.FindKey(e)), faces(e)) ? 1 : 0;
  }
  return count;
}

/// Of each face the part that edges connect it to, those that are closed counted from 1; 0: open.
std::vector<int> bodies_of(const TopoDS_Shape& shape, const TopTools_IndexedMapOfShape& faces) {
  TopTools_IndexedDataMapOfShapeListOfShape around;
  TopExp::MapShapesAndAncestors(shape, TopAbs_EDGE, TopAbs_FACE, around);
  std::vector<int> parents(static_cast<std::size_t>(faces.Extent()));
  std::iota(parents.begin(), parents.end(), 0);
  std::vector<bool> is_open(parents.size());
  const auto part_of = [&](int face) {
    auto part = static_cast<std::size_t>(face);
    while (static_cast<std::size_t>(parents[part]) != part) {
      parents[part] = parents[static_cast<std::size_t>(parents[part])];
      part = static_cast<std::size_t>(parents[part]);
    }
    return part;
  };
  const auto number = [&](const TopoDS_Shape& face) { return faces.FindIndex(face) - 1; };
  for (int e = 1; e <= around.Extent(); ++e) {
    for (const TopoDS_Shape& face : around(e)) {
      const std::size_t first = part_of(number(around(e).First()));
      const std::size_t second = part_of(number(face));
      parents[std::max(first, second)] = static_cast<int>(std::min(first, second));
    }
  }
  for (int e = 1; e <= around.Extent(); ++e) {
    if (!is_free(TopoDS::Edge(around.FindKey(e)), around(e))) continue;
    is_open[part_of(number(around(e).First()))] = true;
  }
  std::map<std::size_t, int> body_of;
  std::vector<int> bodies;
  for (int f = 0; f < faces.Extent(); ++f) {
    const auto next = static_cast<int>(body_of.size()) + 1;
    bodies.push_back(is_open[part_of(f)] ? 0 : body_of.try_emplace(part_of(f), next).first->second);
  }
  return bodies;
}

/// A face of the file, and what it became.
struct Traced {
  NamedFace face;
  TopoDS_Shape now;
};

std::vector<Traced> faces_of(const Contents& contents) {
  std::vector<Traced> faces;
  TopTools_IndexedMapOfShape seen;
  const auto add = [&](const TopoDS_Shape& shape, const std::string& body) {
    if (seen.Contains(shape)) return;
    seen.Add(shape);
    Traced traced{{TopoDS::Face(shape), contents.name_of(shape), {}}, shape};
    traced.face.family = traced.face.name;
    if (traced.face.family.empty()) traced.face.family = contents.colour_of(shape);
    if (traced.face.family.empty()) traced.face.family = body;
    faces.push_back(std::move(traced));
  };
  for (TopExp_Explorer solid(contents.shape, TopAbs_SOLID); solid.More(); solid.Next()) {
    std::string body = contents.name_of(solid.Current());
    if (body.empty()) body = contents.colour_of(solid.Current());
    for (TopExp_Explorer face(solid.Current(), TopAbs_FACE); face.More(); face.Next()) {
      add(face.Current(), body);
    }
  }
  for (TopExp_Explorer face(contents.shape, TopAbs_FACE); face.More(); face.Next()) {
    add(face.Current(), {});
  }
  return faces;
}

/// Mends faces that OpenCASCADE's own check refuses; the shape with those.
TopoDS_Shape heal(const TopoDS_Shape& shape, std::vector<Traced>& faces, int& healed) {
  if (BRepCheck_Analyzer(shape).IsValid()) return shape;
  const Handle(ShapeFix_Shape) fix = new ShapeFix_Shape(shape);
  fix->Perform();
  for (Traced& traced : faces) {
    const TopoDS_Shape now = fix->Context()->Apply(traced.now);
    healed += now.IsSame(traced.now) ? 0 : 1;
    traced.now = now;
  }
  return fix->Shape();
}

/// Makes faces share edges that lie within a millionth of the model's size.
TopoDS_Shape sew(const TopoDS_Shape& shape, double size_mm, std::vector<Traced>& faces) {
  constexpr double kNear = 1e-6;
  BRepBuilderAPI_Sewing sewing(kNear * size_mm);
  sewing.Add(shape);
  sewing.Perform();
  for (Traced& traced : faces) {
    if (sewing.IsModified(traced.now)) traced.now = sewing.Modified(traced.now);
    if (sewing.IsModifiedSubShape(traced.now)) traced.now = sewing.ModifiedSubShape(traced.now);
  }
  return sewing.SewedShape();
}

}  // namespace

Model read_model(const std::string& file, CadReport& report) {
  const Contents contents = read_contents(file);
  std::vector<Traced> traced = faces_of(contents);
  Model model;
  model.shape = contents.shape;
  model.per_millimetre = 1 / contents.unit_mm;
  if (traced.empty()) throw InputError(file + ": holds no face");
  model.size_mm = longest_side(model.shape);
  if (!(model.size_mm > 0)) throw InputError(file + ": its faces have no size, or no end");
  model.shape = heal(model.shape, traced, report.healed_faces);
  const int free_before = free_edges(model.shape);
  if (free_before > 0) model.shape = sew(model.shape, model.size_mm, traced);
  BRepLib::SameParameter(model.shape, 1e-7 * model.size_mm);
  report.free_edges = free_edges(model.shape);
  report.sewn_edges = std::max(free_before - report.free_edges, 0) / 2;
  report.unit = contents.unit;

  TopTools_IndexedMapOfShape faces;
  TopExp::MapShapes(model.shape, TopAbs_FACE, faces);
  std::map<int, const NamedFace*> names;
  for (const Traced& t : traced) {
    for (TopExp_Explorer face(t.now, TopAbs_FACE); face.More(); face.Next()) {
      names[faces.FindIndex(face.Current())] = &t.face;
    }
  }
  const std::vector<int> bodies = bodies_of(model.shape, faces);
  for (int f = 1; f <= faces.Extent(); ++f) {
    NamedFace named{TopoDS::Face(faces(f)), {}, {}, bodies[static_cast<std::size_t>(f - 1)]};
    if (const auto found = names.find(f); found != names.end()) {
      named.name = found->second->name;
      named.family = found->second->family;
    }
    model.faces.push_back(std::move(named));
  }
  report.faces = faces.Extent();
  return model;
}

}  // namespace vdb_offset::cad
