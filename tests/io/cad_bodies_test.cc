// STEP files of several bodies: their names, and where they touch.

#include <BRepAlgoAPI_Cut.hxx>
#include <BRepPrimAPI_MakeBox.hxx>
#include <BRepTools.hxx>
#include <BRep_Builder.hxx>
#include <Eigen/Geometry>
#include <Message.hxx>
#include <Message_Messenger.hxx>
#include <Message_PrinterOStream.hxx>
#include <STEPCAFControl_Writer.hxx>
#include <TDataStd_Name.hxx>
#include <TDocStd_Document.hxx>
#include <TopLoc_Location.hxx>
#include <TopoDS_Compound.hxx>
#include <XCAFApp_Application.hxx>
#include <XCAFDoc_DocumentTool.hxx>
#include <XCAFDoc_ShapeTool.hxx>
#include <array>
#include <gp_Trsf.hxx>
#include <map>
#include <string>
#include <vector>

#include "doctest/doctest.h"
#include "support/temp_folder.h"
#include "vdb_offset/blocks/check_cells.h"
#include "vdb_offset/io/cad.h"
#include "vdb_offset/io/su2.h"
#include "vdb_offset/io/vtk.h"
#include "vdb_offset/pipeline.h"
#include "vdb_offset/surface/surface.h"

using namespace vdb_offset;
using test::TempFolder;

namespace {

TopLoc_Location moved(double x, double y = 0, double z = 0) {
  gp_Trsf trsf;
  trsf.SetTranslation(gp_Vec(x, y, z));
  return trsf;
}

class StepDocument {
 public:
  StepDocument() {
    // The writers say what they do otherwise.
    Message::DefaultMessenger()->RemovePrinters(STANDARD_TYPE(Message_PrinterOStream));
    XCAFApp_Application::GetApplication()->NewDocument("MDTV-XCAF", document_);
    shapes_ = XCAFDoc_DocumentTool::ShapeTool(document_->Main());
  }

  TDF_Label part(const TopoDS_Shape& shape, const char* name) {
    const TDF_Label label = shapes_->AddShape(shape, false);
    TDataStd_Name::Set(label, name);
    return label;
  }
  TDF_Label assembly(const char* name) {
    const TDF_Label label = shapes_->NewShape();
    TDataStd_Name::Set(label, name);
    return label;
  }
  /// `name` of the instance; empty: none that says anything.
  void put(const TDF_Label& into, const TDF_Label& part, const TopLoc_Location& at,
           const char* name) {
    const TDF_Label instance = shapes_->AddComponent(into, part, at);
    TDataStd_Name::Set(instance, name);
  }
  CadSurface read(const TempFolder& folder) {
    const std::string file = folder / "assembly.step";
    shapes_->UpdateAssemblies();
    STEPCAFControl_Writer writer;
    REQUIRE(writer.Transfer(document_, STEPControl_AsIs));
    REQUIRE(writer.Write(file.c_str()) == IFSelect_RetDone);
    return read_cad(file, {.size_world = 0.5});
  }

 private:
  Handle(TDocStd_Document) document_;
  Handle(XCAFDoc_ShapeTool) shapes_;
};

std::map<std::string, int> families_of(const CadSurface& surface) {
  std::map<std::string, int> count;
  for (const Patch& patch : surface.patches) ++count[patch.family];
  return count;
}

/// Two boxes of 2 x 2 x 2, the second one moved.
CadSurface two_boxes(const TempFolder& folder, const gp_Vec& by) {
  StepDocument document;
  const TDF_Label box = document.part(BRepPrimAPI_MakeBox(2, 2, 2).Shape(), "box");
  const TDF_Label all = document.assembly("all");
  document.put(all, box, moved(0), "first");
  document.put(all, box, moved(by.X(), by.Y(), by.Z()), "second");
  return document.read(folder);
}

}  // namespace

TEST_CASE("cad: families of a STEP assembly are names of instances, or of their parts") {
  const TempFolder folder;
  StepDocument document;
  const TDF_Label bolt = document.part(BRepPrimAPI_MakeBox(1, 1, 1).Shape(), "bolt");
  const TDF_Label plate = document.part(BRepPrimAPI_MakeBox(1, 4, 4).Shape(), "plate");
  const TDF_Label all = document.assembly("all");
  document.put(all, bolt, moved(3), "upper bolt");
  document.put(all, bolt, moved(6), "lower bolt");
  document.put(all, plate, moved(9), "3");  // what exporters write for no name
  document.put(all, plate, moved(12), "NAUO4");
  const CadSurface read = document.read(folder);
  const std::map<std::string, int> expected{{"upper bolt", 6}, {"lower bolt", 6}, {"plate", 12}};
  CHECK(families_of(read) == expected);
}

TEST_CASE("cad: solids that touch in a point, an edge or a face are bodies of their own") {
  const TempFolder folder;
  // Nodes of a box whose edges have four cells.
  constexpr int kNodes = 5 * 5 * 5 - 3 * 3 * 3;
  for (const gp_Vec& by : {gp_Vec(2, 2, 2), gp_Vec(2, 2, 0), gp_Vec(2, 0, 0), gp_Vec(2, 1, 0)}) {
    CAPTURE(by.Y());
    CAPTURE(by.Z());
    const CadSurface read = two_boxes(folder, by);
    REQUIRE(read.patches.size() == 12);
    CHECK(read.report.free_edges == 0);
    const Surface surface = build_surface(read.patches);
    CHECK(surface.closed);
    CHECK(surface.topology.components == 2);
    CHECK(surface.nodes_world.size() == 2 * kNodes);
  }
}

TEST_CASE("cad: layers off bodies that touch are positive, and whole in every format") {
  const TempFolder folder;
  for (const gp_Vec& by : {gp_Vec(2, 2, 2), gp_Vec(2, 2, 0), gp_Vec(2, 0, 0), gp_Vec(2, 1, 0.3)}) {
    CAPTURE(by.Y());
    CAPTURE(by.Z());
    PipelineOptions options;
    options.distance_world = 0.2;
    options.spacing.layers = 3;
    const MeshResult made = make_mesh(two_boxes(folder, by).patches, options);
    CHECK(made.quality.report.nonpositive_cells == 0);
    CHECK(write_su2(folder / "mesh.su2", made.mesh) == 0);
    CHECK(check_cells(read_su2(folder / "mesh.su2")).is_sound());
    write_vtu(folder / "mesh.vtu", made.mesh, made.quality);
    CHECK(check_cells(read_vtu(folder / "mesh.vtu")).is_sound());
  }
}

TEST_CASE("cad: closed parts that are inside out are turned, and cavities stay") {
  const TempFolder folder;
  const TopoDS_Shape box = BRepPrimAPI_MakeBox(2, 2, 2).Shape();
  const auto volume_of = [&](const TopoDS_Shape& shape, int turned) {
    const std::string file = folder / "part.brep";
    REQUIRE(BRepTools::Write(shape, file.c_str()));
    const CadSurface surface = read_cad(file, {.size_world = 0.5});
    CHECK(surface.report.turned_parts == turned);
    double volume = 0;
    for (const Patch& patch : surface.patches) {
      for_cells(patch, [&](const std::array<int, 4>& c) {
        const auto p = [&](std::size_t n) {
          return patch.points_world[static_cast<std::size_t>(c[n])];
        };
        volume += p(0).dot(p(1).cross(p(2))) / 6 + p(0).dot(p(2).cross(p(3))) / 6;
      });
    }
    return volume;
  };
  CHECK(volume_of(box, 0) == doctest::Approx(8));
  CHECK(volume_of(box.Reversed(), 1) == doctest::Approx(8));
  const TopoDS_Shape core = BRepPrimAPI_MakeBox(gp_Pnt(0.5, 0.5, 0.5), 1, 1, 1).Shape();
  CHECK(volume_of(BRepAlgoAPI_Cut(box, core).Shape(), 0) == doctest::Approx(7));
}
