#include "io/cad/cad_shape.h"

#include <fmt/format.h>

#include <BRepBuilderAPI_Sewing.hxx>
#include <BRepCheck_Analyzer.hxx>
#include <BRepLib.hxx>
#include <BRep_Builder.hxx>
#include <BRep_Tool.hxx>
#include <ShapeBuild_ReShape.hxx>
#include <ShapeFix_Face.hxx>
#include <ShapeFix_Shape.hxx>
#include <TopExp.hxx>
#include <TopExp_Explorer.hxx>
#include <TopTools_IndexedDataMapOfShapeListOfShape.hxx>
#include <TopTools_IndexedMapOfShape.hxx>
#include <TopoDS.hxx>
#include <TopoDS_Compound.hxx>

#include <algorithm>
#include <map>
#include <set>
#include <utility>

#include "core/sets.h"
#include "io/cad/cad_file.h"
#include "io/cad/kinks.h"
#include "io/cad/lying_faces.h"
#include "vdb_offset/core/error.h"

namespace vdb_offset::cad {
namespace {

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
  const auto number = [&](const TopoDS_Shape& face) { return faces.FindIndex(face) - 1; };
  Sets parts(static_cast<std::size_t>(faces.Extent()));
  for (int e = 1; e <= around.Extent(); ++e) {
    for (const TopoDS_Shape& face : around(e)) {
      parts.join(number(around(e).First()), number(face));
    }
  }
  std::set<int> open;
  for (int e = 1; e <= around.Extent(); ++e) {
    if (!is_free(TopoDS::Edge(around.FindKey(e)), around(e))) continue;
    open.insert(parts.root(number(around(e).First())));
  }
  std::map<int, int> body_of;
  std::vector<int> bodies;
  for (int f = 0; f < faces.Extent(); ++f) {
    const int part = parts.root(f);
    const auto next = static_cast<int>(body_of.size()) + 1;
    bodies.push_back(open.contains(part) ? 0 : body_of.try_emplace(part, next).first->second);
  }
  return bodies;
}

/// A face of the file, and what it became.
struct Traced {
  NamedFace face;
  TopoDS_Shape now;
  bool is_solid = false;
};

std::vector<Traced> faces_of(const Contents& contents) {
  std::vector<Traced> faces;
  TopTools_IndexedMapOfShape seen;
  bool is_solid = true;
  const auto add = [&](const TopoDS_Shape& shape, const std::string& body) {
    if (seen.Contains(shape)) return;
    seen.Add(shape);
    Traced traced{
        {TopoDS::Face(shape), contents.name_of(shape), {}, seen.Extent()}, shape, is_solid};
    traced.face.closed = contents.closed_of(shape);
    if (traced.face.closed.empty() && is_solid) traced.face.closed = "solid";
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
  is_solid = false;
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

/// Makes several faces of those that have kinks, each of them traced.
TopoDS_Shape part_at_kinks(const TopoDS_Shape& shape, std::vector<Traced>& faces) {
  const Handle(ShapeBuild_ReShape) parted = split_kinks(shape);
  if (parted.IsNull()) return shape;
  std::vector<Traced> parts;
  for (const Traced& traced : faces) {
    const TopoDS_Shape now = parted->Apply(traced.now);
    for (TopExp_Explorer face(now, TopAbs_FACE); face.More(); face.Next()) {
      parts.push_back({traced.face, face.Current(), traced.is_solid});
    }
  }
  faces = std::move(parts);
  return parted->Apply(shape);
}

/// Makes faces share edges that lie near each other.
TopoDS_Shape sew(const TopoDS_Shape& shape, double near_cad, std::vector<Traced>& faces) {
  BRepBuilderAPI_Sewing sewing(near_cad);
  sewing.Add(shape);
  sewing.Perform();
  for (Traced& traced : faces) {
    if (sewing.IsModified(traced.now)) traced.now = sewing.Modified(traced.now);
    if (sewing.IsModifiedSubShape(traced.now)) traced.now = sewing.ModifiedSubShape(traced.now);
  }
  return sewing.SewedShape();
}

/// How far apart free edges may be that are the same by their own account: twice what the curve of
/// one may be off, as where an IGES file has a circle that OpenCASCADE makes a spline of.
double apart_cad(const TopoDS_Shape& shape) {
  TopTools_IndexedDataMapOfShapeListOfShape faces;
  TopExp::MapShapesAndAncestors(shape, TopAbs_EDGE, TopAbs_FACE, faces);
  double most = 0;
  for (int e = 1; e <= faces.Extent(); ++e) {
    const TopoDS_Edge edge = TopoDS::Edge(faces.FindKey(e));
    if (is_free(edge, faces(e))) most = std::max(most, 2 * BRep_Tool::Tolerance(edge));
  }
  return most;
}

/// Sews; once more with what the edges allow, up to `most_cad`, if that leaves fewer of them free.
TopoDS_Shape sew(const TopoDS_Shape& shape, double near_cad, double most_cad,
                 std::vector<Traced>& faces) {
  std::vector<Traced> wider = faces;
  TopoDS_Shape sewn = sew(shape, near_cad, faces);
  const double wider_cad = std::min(apart_cad(shape), most_cad);
  const int left = free_edges(sewn);
  if (left == 0 || !(wider_cad > near_cad)) return sewn;
  const TopoDS_Shape other = sew(shape, wider_cad, wider);
  if (free_edges(other) >= left) return sewn;
  faces = std::move(wider);
  return other;
}

/// The faces of a shape, and what each came from.
struct Origins {
  TopTools_IndexedMapOfShape faces;
  std::vector<const Traced*> of_face;  // null: nothing known
};

Origins origins_of(const TopoDS_Shape& shape, const std::vector<Traced>& traced) {
  Origins origins;
  TopExp::MapShapes(shape, TopAbs_FACE, origins.faces);
  origins.of_face.resize(static_cast<std::size_t>(origins.faces.Extent()));
  for (const Traced& t : traced) {
    for (TopExp_Explorer face(t.now, TopAbs_FACE); face.More(); face.Next()) {
      const int f = origins.faces.FindIndex(face.Current());
      if (f > 0) origins.of_face[static_cast<std::size_t>(f - 1)] = &t;
    }
  }
  return origins;
}

template <typename Keep>
TopoDS_Shape compound_of(const TopTools_IndexedMapOfShape& faces, const Keep& keep) {
  TopoDS_Compound compound;
  BRep_Builder builder;
  builder.MakeCompound(compound);
  for (int f = 1; f <= faces.Extent(); ++f) {
    if (keep(f)) builder.Add(compound, faces(f));
  }
  return compound;
}

/// Of each face the part that it is of: closed ones that are no solids from 1 on.
constexpr int kLoose = 0;
constexpr int kOfSolid = -1;
std::vector<int> parts_of(const Origins& origins) {
  const auto is_solid = [&](int f) {
    const Traced* from = origins.of_face[static_cast<std::size_t>(f - 1)];
    return from != nullptr && from->is_solid;
  };
  const TopoDS_Shape rest = compound_of(origins.faces, [&](int f) { return !is_solid(f); });
  TopTools_IndexedMapOfShape faces;
  TopExp::MapShapes(rest, TopAbs_FACE, faces);
  const std::vector<int> bodies = bodies_of(rest, faces);
  std::vector<int> parts(origins.of_face.size(), kOfSolid);
  for (int f = 1; f <= faces.Extent(); ++f) {
    const int face = origins.faces.FindIndex(faces(f));
    parts[static_cast<std::size_t>(face - 1)] = bodies[static_cast<std::size_t>(f - 1)];
  }
  return parts;
}

/// "face 7 'lid'"
std::string name_of(const Origins& origins, int face) {
  const Traced* from = origins.of_face[static_cast<std::size_t>(face - 1)];
  if (from == nullptr) return "a face";
  const std::string& name = from->face.name;
  return fmt::format("face {}{}", from->face.number, name.empty() ? "" : " '" + name + "'");
}

/// What messages need, and how near faces are that lie on each other.
struct Lengths {
  const std::string& file;
  double near_cad, most_cad, world_per_cad;
};

[[noreturn]] void refuse_partly(const std::string& words, const gp_Pnt& place,
                                const Lengths& lengths) {
  const gp_XYZ p = lengths.world_per_cad * place.XYZ();
  throw InputError(fmt::format(
      "{}: a part of {} at ({:.6g}, {:.6g}, {:.6g}), and the rest does not: an edge of three faces "
      "goes between; in a CAD program remove it, cut off what lies there, or unite it with the "
      "solid",
      lengths.file, words, p.X(), p.Y(), p.Z()));
}

std::string lies_on(const Origins& origins, int face, int on) {
  return fmt::format("{} lies on {}", name_of(origins, face), name_of(origins, on));
}

/// The faces of some parts, for others to lie on, and their numbers.
template <typename Takes>
std::pair<std::vector<TopoDS_Face>, std::vector<int>> faces_of_parts(const Origins& origins,
                                                                     const std::vector<int>& parts,
                                                                     const Takes& takes) {
  std::pair<std::vector<TopoDS_Face>, std::vector<int>> out;
  for (int f = 1; f <= origins.faces.Extent(); ++f) {
    if (!takes(parts[static_cast<std::size_t>(f - 1)])) continue;
    out.first.push_back(TopoDS::Face(origins.faces(f)));
    out.second.push_back(f);
  }
  return out;
}

/// Takes out loose faces that lie on closed parts. Throws InputError for one that does with a part.
TopoDS_Shape drop_lying(const TopoDS_Shape& shape, const std::vector<Traced>& traced,
                        const Lengths& lengths, CadReport& report) {
  const Origins origins = origins_of(shape, traced);
  const std::vector<int> parts = parts_of(origins);
  const auto loose = [](int part) { return part == kLoose; };
  if (std::ranges::none_of(parts, loose) || std::ranges::all_of(parts, loose)) return shape;
  const auto [faces, numbers] =
      faces_of_parts(origins, parts, [](int part) { return part != kLoose; });
  const Ground ground(faces, lengths.near_cad);
  std::set<int> lying;
  for (int f = 1; f <= origins.faces.Extent(); ++f) {
    if (!loose(parts[static_cast<std::size_t>(f - 1)])) continue;
    const Lying how = ground.lying_of(TopoDS::Face(origins.faces(f)));
    if (how.how == Lying::How::Apart) continue;
    const std::string words = lies_on(origins, f, numbers[how.on]);
    if (how.how == Lying::How::Partly) refuse_partly(words, how.place, lengths);
    lying.insert(f);
    report.lying_faces.push_back(words);
  }
  if (lying.empty()) return shape;
  return compound_of(origins.faces, [&](int f) { return !lying.contains(f); });
}

/// Of a sewn model the faces of no solid that lie on others, where either is loose or both are of
/// one part: sewing took either for the other's neighbour. Of two that are the same the first
/// stays.
std::set<const Traced*> doubled_faces(const TopoDS_Shape& shape, const std::vector<Traced>& traced,
                                      double near_cad, CadReport& report) {
  const Origins origins = origins_of(shape, traced);
  const std::vector<int> parts = parts_of(origins);
  const auto [faces, numbers] =
      faces_of_parts(origins, parts, [](int part) { return part != kOfSolid; });
  const Ground ground(faces, near_cad);
  std::vector<bool> left_out(faces.size(), false);
  std::set<const Traced*> doubled;
  const auto part = [&](std::size_t n) { return parts[static_cast<std::size_t>(numbers[n] - 1)]; };
  for (std::size_t n = faces.size(); n-- > 0;) {
    std::vector<bool> aside = left_out;
    for (std::size_t p = 0; p < aside.size(); ++p) {
      aside[p] = aside[p] || (part(n) != kLoose && part(p) != part(n));
    }
    const auto on = ground.under(n, aside);
    const Traced* from = origins.of_face[static_cast<std::size_t>(numbers[n] - 1)];
    if (!on || from == nullptr) continue;
    left_out[n] = true;
    doubled.insert(from);
    report.lying_faces.push_back(lies_on(origins, numbers[n], numbers[*on]));
  }
  return doubled;
}

/// Sews, once more without faces that lie on others.
TopoDS_Shape sew_single(const TopoDS_Shape& shape, const Lengths& lengths,
                        std::vector<Traced>& traced, CadReport& report) {
  const std::vector<Traced> before = traced;
  const TopoDS_Shape sewn = sew(shape, lengths.near_cad, lengths.most_cad, traced);
  const std::set<const Traced*> doubled = doubled_faces(sewn, traced, lengths.near_cad, report);
  if (doubled.empty()) return sewn;
  std::vector<Traced> single;
  for (std::size_t n = 0; n < traced.size(); ++n) {
    if (!doubled.contains(&traced[n])) single.push_back(before[n]);
  }
  traced = std::move(single);
  const Origins origins = origins_of(shape, traced);
  const auto stays = [&](int f) {
    return origins.of_face[static_cast<std::size_t>(f - 1)] != nullptr;
  };
  return sew(compound_of(origins.faces, stays), lengths.near_cad, lengths.most_cad, traced);
}

}  // namespace

bool is_free(const TopoDS_Edge& edge, const TopTools_ListOfShape& faces) {
  return faces.Extent() == 1 && !BRep_Tool::Degenerated(edge) &&
         !BRep_Tool::IsClosed(edge, TopoDS::Face(faces.First()));
}

Model read_model(const std::string& file, CadReport& report) {
  const Contents contents = read_contents(file);
  std::vector<Traced> traced = faces_of(contents);
  Model model;
  model.shape = contents.shape;
  model.world_per_cad = contents.world_per_cad;
  if (traced.empty()) throw InputError(file + ": holds no face");
  model.size_cad = longest_side(model.shape);
  if (!(model.size_cad > 0)) throw InputError(file + ": its faces have no size, or no end");
  constexpr double kNear = 1e-6;
  constexpr double kMost = 1e-4;
  const Lengths lengths{file, kNear * model.size_cad, kMost * model.size_cad, model.world_per_cad};
  model.shape = heal(model.shape, traced, report.healed_faces);
  model.shape = part_at_kinks(model.shape, traced);
  model.shape = drop_lying(model.shape, traced, lengths, report);
  const int free_before = free_edges(model.shape);
  if (free_before > 0) {
    model.shape = sew_single(model.shape, lengths, traced, report);
    model.shape = drop_lying(model.shape, traced, lengths, report);
  }
  BRepLib::SameParameter(model.shape, 1e-7 * model.size_cad);
  report.free_edges = free_edges(model.shape);
  report.sewn_edges = std::max(free_before - report.free_edges, 0) / 2;
  report.file_unit = contents.unit;
  report.flaws = contents.losses;

  const Origins origins = origins_of(model.shape, traced);
  const std::vector<int> bodies = bodies_of(model.shape, origins.faces);
  for (std::size_t f = 0; f < bodies.size(); ++f) {
    const Traced* from = origins.of_face[f];
    NamedFace named =
        from != nullptr ? from->face : NamedFace{{}, {}, {}, static_cast<int>(f) + 1, 0, {}};
    named.face = TopoDS::Face(origins.faces(static_cast<int>(f) + 1));
    named.body = bodies[f];
    model.faces.push_back(std::move(named));
  }
  report.faces = origins.faces.Extent();
  return model;
}

}  // namespace vdb_offset::cad
