// Faces of IGES files that OpenCASCADE drops, and kinks within faces.

#include <BRepBuilderAPI_MakeEdge.hxx>
#include <BRepBuilderAPI_MakeFace.hxx>
#include <BRepBuilderAPI_MakeWire.hxx>
#include <BRepPrimAPI_MakeBox.hxx>
#include <BRepPrimAPI_MakePrism.hxx>
#include <BRepTools.hxx>
#include <Geom_BSplineCurve.hxx>
#include <IGESControl_Writer.hxx>
#include <IGESSolid_Block.hxx>
#include <Message.hxx>
#include <Message_Messenger.hxx>
#include <Message_PrinterOStream.hxx>
#include <TColStd_Array1OfInteger.hxx>
#include <TColStd_Array1OfReal.hxx>
#include <TColgp_Array1OfPnt.hxx>
#include <cmath>
#include <fstream>
#include <sstream>
#include <string_view>
#include <utility>

#include "doctest/doctest.h"
#include "support/temp_folder.h"
#include "vdb_offset/io/cad.h"
#include "vdb_offset/surface/surface.h"

using namespace vdb_offset;
using test::TempFolder;

TEST_CASE("cad: a face of an IGES file that OpenCASCADE does not make is named") {
  Message::DefaultMessenger()->RemovePrinters(STANDARD_TYPE(Message_PrinterOStream));
  const TempFolder folder;
  const std::string file = folder / "box.igs";
  IGESControl_Writer writer("MM", 0);  // trimmed surfaces, entity 144
  REQUIRE(writer.AddShape(BRepPrimAPI_MakeBox(2, 2, 2).Shape()));
  writer.ComputeModel();
  REQUIRE(writer.Write(file.c_str()));
  CHECK(read_cad(file).report.flaws.empty());

  std::stringstream all;
  all << std::ifstream(file).rdbuf();
  std::string text = all.str();
  // The first trimmed surface is that of the line behind its own.
  const std::size_t face = text.find("\n144,5,");
  REQUIRE(face != std::string::npos);
  text[face + 5] = '7';
  std::ofstream(file) << text;
  const CadSurface cut = read_cad(file);
  CHECK(cut.report.faces == 5);
  REQUIRE(cut.report.flaws.size() == 1);
  CHECK(cut.report.flaws[0].find("OpenCASCADE makes nothing of face D") != std::string::npos);
}

TEST_CASE("cad: what OpenCASCADE does not read beside the faces of an IGES file is named") {
  Message::DefaultMessenger()->RemovePrinters(STANDARD_TYPE(Message_PrinterOStream));
  const TempFolder folder;
  const std::string file = folder / "block.igs";
  IGESControl_Writer writer("MM", 0);
  REQUIRE(writer.AddShape(BRepPrimAPI_MakeBox(2, 2, 2).Shape()));
  const Handle(IGESSolid_Block) block = new IGESSolid_Block();
  block->Init({1, 1, 1}, {5, 0, 0}, {1, 0, 0}, {0, 0, 1});
  REQUIRE(writer.AddEntity(block));
  writer.ComputeModel();
  REQUIRE(writer.Write(file.c_str()));
  const auto check = [&](const std::string& words) {
    const CadSurface read = read_cad(file);
    CHECK(read.report.faces == 6);
    REQUIRE(read.report.flaws.size() == 1);
    CHECK(read.report.flaws[0].find("OpenCASCADE makes nothing of " + words) != std::string::npos);
  };
  check("solid D");
  std::stringstream all;
  all << std::ifstream(file).rdbuf();
  std::string text = all.str();
  for (const auto& [from, to] : {std::pair{"\n     150", "\n    5001"}, {"\n150,", "\n5001,"}}) {
    for (std::size_t at = text.find(from); at != std::string::npos; at = text.find(from)) {
      text.replace(at, std::string_view(from).size(), to);
      if (to[1] == '5') text.erase(text.find("     ", at), 1);  // letters stay in their columns
    }
  }
  std::ofstream(file) << text;
  check("entity D");
}

TEST_CASE("cad: cells end at kinks within a face") {
  const TempFolder folder;
  // A prism over the triangle (0, 0), (1, 0), (1, 1), two of whose sides are one edge.
  TColgp_Array1OfPnt corners(1, 3);
  TColStd_Array1OfReal knots(1, 3);
  TColStd_Array1OfInteger times(1, 3);
  for (int n = 1; n <= 3; ++n) {
    corners.SetValue(n, gp_Pnt(n > 1 ? 1 : 0, n > 2 ? 1 : 0, 0));
    knots.SetValue(n, n == 3 ? 1.3 : n - 1);
    times.SetValue(n, n == 2 ? 1 : 2);
  }
  const Handle(Geom_BSplineCurve) bent = new Geom_BSplineCurve(corners, knots, times, 1);
  BRepBuilderAPI_MakeWire ring(BRepBuilderAPI_MakeEdge(bent).Edge());
  ring.Add(BRepBuilderAPI_MakeEdge(corners(3), corners(1)).Edge());
  const TopoDS_Face floor = BRepBuilderAPI_MakeFace(ring.Wire(), true).Face();
  const std::string file = folder / "prism.brep";
  REQUIRE(BRepTools::Write(BRepPrimAPI_MakePrism(floor, gp_Vec(0, 0, 2)).Shape(), file.c_str()));
  const CadSurface read = read_cad(file, {.size_world = 0.3});
  CHECK(read.report.faces == 5);
  CHECK(read.report.flaws.empty());
  const Surface surface = build_surface(read.patches);
  CHECK(surface.closed);
  CHECK(surface.wall->area() == doctest::Approx(2 * 0.5 + 2 * (2 + std::sqrt(2.0))).epsilon(1e-9));
}
