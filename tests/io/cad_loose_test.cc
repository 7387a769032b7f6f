// Faces of no solid: those that lie where others are, those that do not, and their seams.

#include <BRepBuilderAPI_MakeFace.hxx>
#include <BRepBuilderAPI_MakePolygon.hxx>
#include <BRepPrimAPI_MakeBox.hxx>
#include <BRepPrimAPI_MakeCone.hxx>
#include <BRepPrimAPI_MakeCylinder.hxx>
#include <BRepTools.hxx>
#include <BRep_Builder.hxx>
#include <Geom_CylindricalSurface.hxx>
#include <IGESControl_Writer.hxx>
#include <Message.hxx>
#include <Message_Messenger.hxx>
#include <Message_PrinterOStream.hxx>
#include <STEPControl_Writer.hxx>
#include <TopExp_Explorer.hxx>
#include <TopoDS.hxx>
#include <TopoDS_Compound.hxx>

#include "doctest/doctest.h"
#include "support/temp_folder.h"
#include "vdb_offset/core/error.h"
#include "vdb_offset/io/cad.h"
#include "vdb_offset/surface/surface.h"

using namespace vdb_offset;
using test::TempFolder;

namespace {

using Shapes = std::vector<TopoDS_Shape>;

TopoDS_Compound together(const Shapes& shapes) {
  TopoDS_Compound all;
  BRep_Builder builder;
  builder.MakeCompound(all);
  for (const TopoDS_Shape& shape : shapes) builder.Add(all, shape);
  return all;
}

enum class As { Brep, Step, Iges };

CadSurface read(const TempFolder& folder, const Shapes& shapes, As format) {
  // The writers say what they do otherwise.
  Message::DefaultMessenger()->RemovePrinters(STANDARD_TYPE(Message_PrinterOStream));
  const TopoDS_Compound all = together(shapes);
  const std::string file = folder / (format == As::Brep   ? "model.brep"
                                     : format == As::Step ? "model.step"
                                                          : "model.igs");
  if (format == As::Brep) {
    REQUIRE(BRepTools::Write(all, file.c_str()));
  } else if (format == As::Step) {
    STEPControl_Writer writer;
    REQUIRE(writer.Transfer(all, STEPControl_AsIs) == IFSelect_RetDone);
    REQUIRE(writer.Write(file.c_str()) == IFSelect_RetDone);
  } else {
    IGESControl_Writer writer("MM", 0);  // faces, no solid
    REQUIRE(writer.AddShape(all));
    writer.ComputeModel();
    REQUIRE(writer.Write(file.c_str()));
  }
  return read_cad(file, {.size_world = 0.5});
}

TopoDS_Face face_of(const std::vector<gp_Pnt>& corners) {
  BRepBuilderAPI_MakePolygon ring;
  for (const gp_Pnt& corner : corners) ring.Add(corner);
  ring.Close();
  return BRepBuilderAPI_MakeFace(ring.Wire()).Face();
}

TopoDS_Face flat(double x0, double x1, double y0, double y1, double z) {
  return face_of({{x0, y0, z}, {x1, y0, z}, {x1, y1, z}, {x0, y1, z}});
}

TopoDS_Shape box() { return BRepPrimAPI_MakeBox(2, 2, 2).Shape(); }

/// A face of the box's own edges.
TopoDS_Face lid_of(const TopoDS_Shape& box) {
  TopoDS_Face last;
  for (TopExp_Explorer it(box, TopAbs_FACE); it.More(); it.Next()) {
    last = TopoDS::Face(it.Current());
  }
  return BRepBuilderAPI_MakeFace(BRepTools::OuterWire(last)).Face();
}

}  // namespace

TEST_CASE("cad: a loose face that lies on a solid's face is left out and named") {
  const TempFolder folder;
  const TopoDS_Shape solid = box();
  const TopoDS_Shape can = BRepPrimAPI_MakeCylinder(1, 3).Shape();
  const Handle(Geom_Surface) round =
      new Geom_CylindricalSurface(gp_Ax3(gp_Pnt(0, 0, 0), gp_Dir(0, 0, 1)), 1.0);
  const std::vector<Shapes> models{
      {solid, flat(0, 2, 0, 2, 2)},          // the same
      {flat(0.5, 1.5, 0.6, 1.7, 2), solid},  // within it
      {solid, flat(0, 1, 0, 2, 2)},          // with one of its edges
      {solid, lid_of(solid)},                // shares its edges
      {can, BRepBuilderAPI_MakeFace(round, 0.3, 1.5, 0.5, 2.0, 1e-7).Face()}};
  for (std::size_t m = 0; m < models.size(); ++m) {
    for (const As format : {As::Brep, As::Step, As::Iges}) {
      CAPTURE(m);
      CAPTURE(int(format));
      const CadSurface surface = read(folder, models[m], format);
      CHECK(surface.report.faces == (m < 4 ? 6 : 3));
      CHECK(surface.report.free_edges == 0);
      CHECK(build_surface(surface.patches).closed);
      REQUIRE(surface.report.lying_faces.size() == 1);
      CHECK(surface.report.lying_faces[0].find("lies on face ") != std::string::npos);
    }
  }
}

TEST_CASE("cad: faces of a model have the same numbers when one is left out") {
  const TempFolder folder;
  const CadSurface alone = read(folder, {box()}, As::Step);
  const CadSurface more = read(folder, {box(), flat(0, 2, 0, 2, 2)}, As::Step);
  REQUIRE(alone.patches.size() == more.patches.size());
  for (const Patch& patch : alone.patches) {
    const auto same = std::ranges::find(more.patches, patch.name, &Patch::name);
    REQUIRE(same != more.patches.end());
    CHECK(same->points_world == patch.points_world);
  }
  CHECK(more.report.lying_faces[0] == "face 7 lies on face 6");  // the box's last is its top
}

TEST_CASE("cad: a loose face is refused where only a part of it lies on a solid's face") {
  const TempFolder folder;
  for (const TopoDS_Face& loose : {flat(1, 3, 0.5, 1.5, 2), flat(-1, 3, -1, 3, 2)}) {
    for (const As format : {As::Brep, As::Step, As::Iges}) {
      CAPTURE(int(format));
      try {
        read(folder, {box(), loose}, format);
        FAIL("read");
      } catch (const InputError& error) {
        const std::string said = error.what();
        CHECK(said.find("face 7 lies on face 6") != std::string::npos);
        CHECK(said.find("model.") != std::string::npos);
      }
    }
  }
}

TEST_CASE("cad: a sheet elsewhere stays, though it touches a solid, or is tangent to it") {
  const TempFolder folder;
  const TopoDS_Shape can = BRepPrimAPI_MakeCylinder(1, 3).Shape();
  const std::vector<Shapes> models{
      {box(), flat(0, 2, 0, 2, 5)},
      {box(), face_of({{0, 1, 2}, {2, 1, 2}, {2, 1, 3}, {0, 1, 3}})},    // stands on it
      {box(), face_of({{1, -1, 1}, {1, 3, 1}, {1, 3, 4}, {1, -1, 4}})},  // goes through it
      {can, face_of({{1, -1, 1}, {1, 1, 1}, {1, 1, 2}, {1, -1, 2}})}};   // tangent
  for (std::size_t m = 0; m < models.size(); ++m) {
    for (const As format : {As::Brep, As::Iges}) {
      CAPTURE(m);
      const CadSurface surface = read(folder, models[m], format);
      CHECK(surface.report.lying_faces.empty());
      CHECK(surface.report.faces == (m < 3 ? 7 : 4));
      CHECK(surface.report.free_edges == 4);
    }
  }
}

TEST_CASE("cad: faces of closed parts that touch stay, without solids too") {
  const TempFolder folder;
  const TopoDS_Shape other = BRepPrimAPI_MakeBox(gp_Pnt(2, 0.5, 0.5), 1, 1, 1).Shape();
  for (const As format : {As::Step, As::Iges}) {
    const CadSurface surface = read(folder, {box(), other}, format);
    CHECK(surface.report.lying_faces.empty());
    CHECK(surface.report.faces == 12);
    CHECK(surface.report.free_edges == 0);
    CHECK(build_surface(surface.patches).topology.components == 2);
  }
}

TEST_CASE("cad: of two sheets in one place the first stays") {
  const TempFolder folder;
  const CadSurface surface =
      read(folder, {flat(0, 2, 0, 2, 2), flat(0, 2, 0, 2, 2), flat(0.5, 1, 0, 1, 2)}, As::Brep);
  CHECK(surface.report.faces == 1);
  REQUIRE(surface.report.lying_faces.size() == 2);
  CHECK(surface.report.lying_faces[1] == "face 2 lies on face 1");
}

TEST_CASE("cad: faces of a frustum share their circles, which IGES has as splines beside them") {
  const TempFolder folder;
  constexpr double kOff = 1e-5;  // what OpenCASCADE allows those splines
  for (const auto& [bottom, top, height] :
       {std::array{1.0, 0.3, 2.0}, {0.2, 1.0, 1.5}, {1.0, 0.0, 2.0}}) {
    CAPTURE(top);
    const CadSurface surface =
        read(folder, {BRepPrimAPI_MakeCone(bottom, top, height).Shape()}, As::Iges);
    CHECK(surface.report.faces == (top > 0 ? 3 : 2));
    CHECK(surface.report.free_edges == 0);
    CHECK(build_surface(surface.patches).closed);
    for (const Patch& patch : surface.patches) {
      for (const Vec3& p : patch.points_world) {
        const double off_wall = bottom + (top - bottom) * p.z() / height - p.head<2>().norm();
        const double off_lids = std::min(std::abs(p.z()), std::abs(p.z() - height));
        REQUIRE(std::min(std::abs(off_wall), off_lids) < kOff);
        REQUIRE(off_wall > -kOff);
      }
    }
  }
}
