#include "vdb_offset/io/cad.h"

#include <BRepAlgoAPI_Cut.hxx>
#include <BRepBndLib.hxx>
#include <BRepBuilderAPI_MakeFace.hxx>
#include <BRepBuilderAPI_MakePolygon.hxx>
#include <BRepBuilderAPI_MakeVertex.hxx>
#include <BRepExtrema_DistShapeShape.hxx>
#include <BRepGProp.hxx>
#include <BRepPrimAPI_MakeBox.hxx>
#include <BRepPrimAPI_MakeCone.hxx>
#include <BRepPrimAPI_MakeCylinder.hxx>
#include <BRepPrimAPI_MakePrism.hxx>
#include <BRepPrimAPI_MakeSphere.hxx>
#include <BRepPrimAPI_MakeTorus.hxx>
#include <BRepTools.hxx>
#include <Eigen/Geometry>
#include <GProp_GProps.hxx>
#include <IGESControl_Writer.hxx>
#include <Interface_Static.hxx>
#include <Message.hxx>
#include <Message_Messenger.hxx>
#include <Message_PrinterOStream.hxx>
#include <Quantity_Color.hxx>
#include <STEPCAFControl_Writer.hxx>
#include <STEPControl_Controller.hxx>
#include <STEPControl_Writer.hxx>
#include <TDocStd_Document.hxx>
#include <TopExp_Explorer.hxx>
#include <XCAFApp_Application.hxx>
#include <XCAFDoc_ColorTool.hxx>
#include <XCAFDoc_DocumentTool.hxx>
#include <XCAFDoc_ShapeTool.hxx>
#include <algorithm>
#include <cmath>
#include <fstream>
#include <numbers>

#include "doctest/doctest.h"
#include "support/temp_folder.h"
#include "vdb_offset/core/error.h"
#include "vdb_offset/surface/surface.h"

using namespace vdb_offset;
using test::TempFolder;

namespace {

constexpr double kPi = std::numbers::pi;

/// The writers say what they do otherwise.
const bool kQuiet =
    Message::DefaultMessenger()->RemovePrinters(STANDARD_TYPE(Message_PrinterOStream)) > 0;

std::string write_step_file(const TempFolder& folder, const TopoDS_Shape& shape,
                            const char* unit = "MM") {
  const std::string file = folder / "model.step";
  STEPControl_Controller::Init();
  Interface_Static::SetCVal("write.step.unit", unit);  // before there is a writer
  STEPControl_Writer writer;
  REQUIRE(kQuiet);
  REQUIRE(writer.Transfer(shape, STEPControl_AsIs) == IFSelect_RetDone);
  REQUIRE(writer.Write(file.c_str()) == IFSelect_RetDone);
  return file;
}

std::string write_brep_file(const TempFolder& folder, const TopoDS_Shape& shape) {
  const std::string file = folder / "model.brep";
  REQUIRE(BRepTools::Write(shape, file.c_str()));
  return file;
}

std::string write_iges_file(const TempFolder& folder, const TopoDS_Shape& shape) {
  const std::string file = folder / "model.igs";
  IGESControl_Writer writer("MM", 0);  // faces, no solid
  REQUIRE(writer.AddShape(shape));
  writer.ComputeModel();
  REQUIRE(writer.Write(file.c_str()));
  return file;
}

/// Volume within patches, by the divergence theorem over their triangles: positive where normals
/// point outward.
double volume_within(const Patches& patches) {
  double six = 0;
  for (const Patch& patch : patches) {
    for_cells(patch, [&](const std::array<int, 4>& c) {
      const auto at = [&](std::size_t k) -> const Vec3& {
        return patch.points_world[static_cast<std::size_t>(c[k])];
      };
      six += at(0).dot(at(1).cross(at(2))) + at(0).dot(at(2).cross(at(3)));
    });
  }
  return six / 6;
}

double volume_of(const TopoDS_Shape& shape) {
  GProp_GProps properties;
  BRepGProp::VolumeProperties(shape, properties);
  return properties.Mass();
}

/// Largest distance of every `stride`-th point from a shape, by OpenCASCADE.
double worst_distance(const Patches& patches, const TopoDS_Shape& shape, std::size_t stride) {
  // Faces alone: a solid's inside would be at no distance.
  TopoDS_Compound faces;
  BRep_Builder builder;
  builder.MakeCompound(faces);
  for (TopExp_Explorer it(shape, TopAbs_FACE); it.More(); it.Next()) {
    builder.Add(faces, it.Current());
  }
  double worst = 0;
  for (const Patch& patch : patches) {
    for (std::size_t n = 0; n < patch.points_world.size(); n += stride) {
      const Vec3& p = patch.points_world[n];
      const BRepExtrema_DistShapeShape nearest(
          BRepBuilderAPI_MakeVertex(gp_Pnt(p.x(), p.y(), p.z())).Vertex(), faces);
      REQUIRE(nearest.IsDone());
      worst = std::max(worst, nearest.Value());
    }
  }
  return worst;
}

bool all_grids(const Patches& patches) {
  return std::ranges::all_of(patches, [](const Patch& patch) { return patch.is_grid(); });
}

/// A prism of height 2 over a polygon around the z axis.
TopoDS_Shape prism(int corners) {
  BRepBuilderAPI_MakePolygon base;
  for (int k = 0; k < corners; ++k) {
    const double angle = 2 * kPi * k / corners;
    base.Add(gp_Pnt(3 * std::cos(angle), 3 * std::sin(angle), 0));
  }
  base.Close();
  return BRepPrimAPI_MakePrism(BRepBuilderAPI_MakeFace(base.Wire()).Face(), gp_Vec(0, 0, 2))
      .Shape();
}

struct Solid {
  const char* name;
  TopoDS_Shape shape;
};

std::vector<Solid> solids_of_four_sided_faces() {
  return {{"box", BRepPrimAPI_MakeBox(4, 2, 3).Shape()},
          {"sphere", BRepPrimAPI_MakeSphere(2.0).Shape()},
          {"torus", BRepPrimAPI_MakeTorus(3.0, 1.0).Shape()},
          {"cylinder", BRepPrimAPI_MakeCylinder(1.0, 4.0).Shape()},
          {"cone", BRepPrimAPI_MakeCone(2.0, 0.0, 3.0).Shape()}};
}

}  // namespace

TEST_CASE("cad: solids of four-sided faces and discs are closed by patches on their surfaces") {
  const TempFolder folder;
  for (const Solid& solid : solids_of_four_sided_faces()) {
    const std::string name = solid.name;
    CAPTURE(name);
    for (const std::string& file :
         {write_step_file(folder, solid.shape), write_brep_file(folder, solid.shape)}) {
      const CadSurface read = read_cad(file, {.size_world = 0.5});
      CHECK(read.report.triangulated == 0);
      CHECK(read.report.free_edges == 0);
      CHECK(all_grids(read.patches));
      CHECK(worst_distance(read.patches, solid.shape, 7) <= 4e-9);
      // Chords of curves that turn by 15 degrees cut off 3.4 % of a circle's area at most.
      CHECK(volume_within(read.patches) ==
            doctest::Approx(volume_of(solid.shape)).epsilon(2 * 0.034));
      const Surface surface = build_surface(read.patches);
      CHECK(surface.closed);
      CHECK(surface.report.flipped.empty());
    }
  }
}

TEST_CASE("cad: an IGES box's loose faces are sewn into a closed surface") {
  const TempFolder folder;
  const TopoDS_Shape box = BRepPrimAPI_MakeBox(4, 2, 3).Shape();
  const CadSurface read = read_cad(write_iges_file(folder, box), {.size_world = 0.5});
  CHECK(read.report.faces == 6);
  CHECK(read.report.sewn_edges == 12);
  CHECK(read.report.free_edges == 0);
  CHECK(read.report.unit == "mm");
  CHECK(build_surface(read.patches).closed);
  CHECK(std::abs(volume_within(read.patches)) == doctest::Approx(24).epsilon(1e-12));
}

TEST_CASE("cad: faces of three and five sides are subdivided about a point") {
  const TempFolder folder;
  for (const int corners : {3, 5}) {
    CAPTURE(corners);
    const CadSurface read = read_cad(write_step_file(folder, prism(corners)), {.size_world = 0.4});
    CHECK(read.report.four_sided == corners);
    CHECK(read.report.split == 2);
    CHECK(std::ssize(read.patches) == 3 * corners);
    CHECK(all_grids(read.patches));
    CHECK(build_surface(read.patches).closed);
    // Plane faces: exact.
    const double area = 4.5 * corners * std::sin(2 * kPi / corners);
    CHECK(volume_within(read.patches) == doctest::Approx(2 * area).epsilon(1e-12));
  }
}

TEST_CASE("cad: faces with holes become triangles that share the points of patches beside them") {
  const TempFolder folder;
  const TopoDS_Shape box = BRepPrimAPI_MakeBox(gp_Pnt(-3, -3, 0), gp_Pnt(3, 3, 1)).Shape();
  const TopoDS_Shape hole =
      BRepPrimAPI_MakeCylinder(gp_Ax2(gp_Pnt(0.5, 0.25, -1), gp_Dir(0, 0, 1)), 1.0, 3.0).Shape();
  const TopoDS_Shape plate = BRepAlgoAPI_Cut(box, hole).Shape();
  const CadSurface read = read_cad(write_step_file(folder, plate), {.size_world = 0.4});
  CHECK(read.report.triangulated == 2);
  CHECK(read.report.four_sided == 5);
  const Surface surface = build_surface(read.patches);
  CHECK(surface.closed);
  CHECK(surface.report.weld_distance_max_world == 0);
  // 36 less a polygon of the circle's points.
  const double hole_area = 36 - volume_within(read.patches);
  CHECK(hole_area < kPi);
  CHECK(hole_area > 0.97 * kPi);
}

TEST_CASE("cad: triangles of a face with poles, a seam and a hole meet each other once") {
  const TempFolder folder;
  const TopoDS_Shape drill =
      BRepPrimAPI_MakeCylinder(gp_Ax2(gp_Pnt(0, 0, 0), gp_Dir(0.3, 1, 0.4)), 0.5, 3.0).Shape();
  const TopoDS_Shape drilled = BRepAlgoAPI_Cut(BRepPrimAPI_MakeSphere(2.0).Shape(), drill).Shape();
  const CadSurface read = read_cad(write_step_file(folder, drilled), {.size_world = 0.3});
  CHECK(read.report.triangulated == 1);
  const Surface surface = build_surface(read.patches);
  CHECK(surface.closed);
  CHECK(volume_within(read.patches) == doctest::Approx(volume_of(drilled)).epsilon(0.03));
}

TEST_CASE("cad: a washer's rings are one patch each") {
  const TempFolder folder;
  const TopoDS_Shape washer = BRepAlgoAPI_Cut(BRepPrimAPI_MakeCylinder(3.0, 1.0).Shape(),
                                              BRepPrimAPI_MakeCylinder(1.0, 1.0).Shape())
                                  .Shape();
  const CadSurface read = read_cad(write_step_file(folder, washer), {.size_world = 0.5});
  CHECK(read.report.four_sided == 4);
  CHECK(read.patches.size() == 4);
  CHECK(build_surface(read.patches).closed);
  CHECK(volume_within(read.patches) == doctest::Approx(8 * kPi).epsilon(0.02));
}

TEST_CASE("cad: edges turn by no more than is asked, and are no longer than the size") {
  const TempFolder folder;
  const TopoDS_Shape cylinder = BRepPrimAPI_MakeCylinder(1.0, 4.0).Shape();
  const CadSurface read =
      read_cad(write_step_file(folder, cylinder), {.size_world = 0.7, .turn = kPi / 18});
  double longest = 0;
  double chord = 0;
  for (const Patch& patch : read.patches) {
    for_edges(patch, [&](int a, int b) {
      const Vec3& from = patch.points_world[static_cast<std::size_t>(a)];
      const Vec3& to = patch.points_world[static_cast<std::size_t>(b)];
      longest = std::max(longest, (to - from).norm());
      const bool is_on_rim =
          from.z() == to.z() && from.head<2>().norm() > 0.999 && to.head<2>().norm() > 0.999;
      if (is_on_rim) chord = std::max(chord, (to - from).norm());
    });
  }
  CHECK(longest <= 0.7 * 1.0001);
  CHECK(chord <= 2 * std::sin(kPi / 36) * 1.0001);
  CHECK(chord > 0);
}

TEST_CASE("cad: points keep the file's unit") {
  const TempFolder folder;
  const TopoDS_Shape box = BRepPrimAPI_MakeBox(25.4, 25.4, 25.4).Shape();
  for (const auto& [step, unit, side] :
       {std::tuple{"INCH", "in", 1.0}, {"MM", "mm", 25.4}, {"M", "m", 0.0254}}) {
    const CadSurface read = read_cad(write_step_file(folder, box, step));
    CHECK(read.report.unit == unit);
    CHECK(volume_within(read.patches) == doctest::Approx(side * side * side).epsilon(1e-12));
  }
}

TEST_CASE("cad: a model of any size, in any unit, becomes the same patches") {
  const TempFolder folder;
  const auto read = [&](double size, const char* unit) {
    return read_cad(write_step_file(folder, BRepPrimAPI_MakeCylinder(size, 3 * size), unit))
        .patches;
  };
  const Patches usual = read(100, "MM");
  for (const auto& [size, unit] :
       {std::tuple{1e-6, "MM"}, {1e-5, "UM"}, {1e9, "KM"}, {1e9, "IN"}}) {
    const Patches patches = read(size, unit);
    REQUIRE(patches.size() == usual.size());
    const double scale = patches[0].at(0, 0).norm() / usual[0].at(0, 0).norm();
    for (std::size_t p = 0; p < patches.size(); ++p) {
      REQUIRE(patches[p].points_world.size() == usual[p].points_world.size());
      for (std::size_t n = 0; n < patches[p].points_world.size(); ++n) {
        const Vec3 away = patches[p].points_world[n] / scale - usual[p].points_world[n];
        CHECK(away.norm() <= 1e-9 * 300);
      }
    }
  }
}

TEST_CASE("cad: colours of faces become families") {
  const TempFolder folder;
  Handle(TDocStd_Document) document;
  XCAFApp_Application::GetApplication()->NewDocument("MDTV-XCAF", document);
  const auto shapes = XCAFDoc_DocumentTool::ShapeTool(document->Main());
  const auto colours = XCAFDoc_DocumentTool::ColorTool(document->Main());
  const TopoDS_Shape box = BRepPrimAPI_MakeBox(1, 1, 1).Shape();
  const TDF_Label label = shapes->AddShape(box, false);
  TopExp_Explorer face(box, TopAbs_FACE);
  colours->SetColor(shapes->AddSubShape(label, face.Current()), Quantity_Color(Quantity_NOC_RED),
                    XCAFDoc_ColorSurf);
  const std::string file = folder / "coloured.step";
  STEPCAFControl_Writer writer;
  REQUIRE(writer.Transfer(document, STEPControl_AsIs));
  REQUIRE(writer.Write(file.c_str()) == IFSelect_RetDone);
  const CadSurface read = read_cad(file);
  CHECK(std::ranges::count(read.patches, "#ff0000", &Patch::family) == 1);
}

TEST_CASE("cad: patches written as STEP are read back through their points, sewn") {
  const TempFolder folder;
  const CadSurface sphere = read_cad(
      write_step_file(folder, BRepPrimAPI_MakeTorus(3.0, 1.0).Shape()), {.size_world = 0.5});
  const std::string file = folder / "patches.step";
  write_step(file, sphere.patches, "m");
  const CadSurface back = read_cad(file, {.size_world = 0.25});
  CHECK(back.report.unit == "m");
  CHECK(back.report.free_edges == 0);
  double worst = 0;
  for (const Patch& patch : back.patches) {
    for (const Vec3& p : patch.points_world) {
      const double ring = p.head<2>().norm() - 3;
      worst = std::max(worst, std::abs(std::hypot(ring, p.z()) - 1));
    }
  }
  // Cubic through points that are a quarter of a radian apart: of fourth order.
  CHECK(worst < std::pow(0.3, 4) / 16);
  CHECK(worst > 0);
}

TEST_CASE("cad: an IGES file that is cut, or lost a line, is never taken for a smaller model") {
  const TempFolder folder;
  const TopoDS_Shape shape = BRepPrimAPI_MakeCylinder(1.0, 4.0).Shape();
  const std::string bytes = test::file_bytes(write_iges_file(folder, shape));
  const std::string cut = folder / "cut.iges";
  const auto attempt = [&](const std::string& content) {
    std::ofstream(cut, std::ios::binary) << content;
    CHECK_THROWS_AS(read_cad(cut, {.size_world = 0.5}), IoError);
  };
  for (std::size_t part = 1; part < 24; ++part) attempt(bytes.substr(0, bytes.size() * part / 24));
  const std::size_t line = bytes.find('\n', bytes.size() / 2) + 1;
  attempt(std::string(bytes).erase(line, bytes.find('\n', line) + 1 - line));
}

TEST_CASE("cad: files that break off or are damaged are refused, and nothing else happens") {
  const TempFolder folder;
  const TopoDS_Shape shape = BRepPrimAPI_MakeCylinder(1.0, 4.0).Shape();
  for (const std::string& whole : {write_step_file(folder, shape), write_brep_file(folder, shape),
                                   write_iges_file(folder, shape)}) {
    const std::string bytes = test::file_bytes(whole);
    const std::string damaged = folder / "damaged";
    const auto attempt = [&](const std::string& content) {
      std::ofstream(damaged, std::ios::binary) << content;
      try {
        read_cad(damaged, {.size_world = 0.5});
      } catch (const Error& error) {
        CHECK(std::string(error.what()).find("damaged") != std::string::npos);
      }
    };
    for (std::size_t part = 0; part < 24; ++part)
      attempt(bytes.substr(0, bytes.size() * part / 24));
    std::uint32_t state = 12345;
    for (int k = 0; k < 40; ++k) {
      std::string flipped = bytes;
      state = state * 1664525U + 1013904223U;
      flipped[state % flipped.size()] = static_cast<char>('0' + (state >> 16U) % 10);
      attempt(flipped);
    }
  }
  CHECK_THROWS_AS(read_cad(folder / "absent.step"), IoError);
}
