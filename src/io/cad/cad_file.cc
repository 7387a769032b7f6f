// STEP, IGES and BREP through OpenCASCADE's readers with names and colours (XDE).

#include "io/cad/cad_file.h"

#include <fmt/format.h>

#include <BRepBndLib.hxx>
#include <BRepTools.hxx>
#include <BRepTools_ReShape.hxx>
#include <BRep_Builder.hxx>
#include <Bnd_Box.hxx>
#include <IGESCAFControl_Reader.hxx>
#include <IGESData_IGESEntity.hxx>
#include <IGESData_IGESModel.hxx>
#include <Message.hxx>
#include <Message_Messenger.hxx>
#include <Message_PrinterOStream.hxx>
#include <Quantity_Color.hxx>
#include <STEPCAFControl_Reader.hxx>
#include <Standard_Failure.hxx>
#include <StepRepr_RepresentationItem.hxx>
#include <StepShape_Face.hxx>
#include <TColStd_SequenceOfAsciiString.hxx>
#include <TCollection_HAsciiString.hxx>
#include <TDF_LabelSequence.hxx>
#include <TDataStd_Name.hxx>
#include <TDocStd_Document.hxx>
#include <TopExp_Explorer.hxx>
#include <TopoDS_Compound.hxx>
#include <UnitsMethods.hxx>
#include <XCAFApp_Application.hxx>
#include <XCAFDoc_ColorTool.hxx>
#include <XCAFDoc_DocumentTool.hxx>
#include <XCAFDoc_ShapeTool.hxx>
#include <XSControl_TransferReader.hxx>
#include <XSControl_WorkSession.hxx>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string_view>
#include <utility>

#include "io/cad/cad_losses.h"
#include "io/cad/step_numbers.h"
#include "vdb_offset/core/error.h"

namespace vdb_offset::cad {
namespace {

constexpr std::array<Length, 15> kLengths{{{"millimetre", "mm", 1, "MM"},
                                           {"metre", "m", 1000, "M"},
                                           {"centimetre", "cm", 10, "CM"},
                                           {"kilometre", "km", 1e6, "KM"},
                                           {"micrometre", "um", 1e-3, "UM"},
                                           {"inch", "in", 25.4, "INCH"},
                                           {"foot", "ft", 304.8, "FT"},
                                           {"mile", "mi", 1609344, "MI"},
                                           {"mil", "mil", 0.0254, "MIL"},
                                           // As IGES has them, where that is not the short name.
                                           {"inches", "in", 25.4, "INCH"},
                                           {"millimeter", "mm", 1, "MM"},
                                           {"meter", "m", 1000, "M"},
                                           {"centimeter", "cm", 10, "CM"},
                                           {"kilometer", "km", 1e6, "KM"},
                                           {"feet", "ft", 304.8, "FT"}}};

/// That the file names; `cad_mm`: the unit of lengths in OpenCASCADE.
void set_unit(Contents& contents, double cad_mm, std::string word) {
  for (char& c : word) c = c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
  const Length& length = length_of(word);
  contents.unit = length.name;
  contents.world_per_cad = cad_mm / length.mm;
}

std::string text_of(const Handle(TCollection_HAsciiString) & text) {
  if (text.IsNull()) return {};
  std::string out = text->ToCString();
  while (!out.empty() && out.back() == ' ') out.pop_back();
  return out;
}

/// Names that exporters give to all: none at all.
std::string real_name(std::string name) {
  constexpr std::array<std::string_view, 6> kEmpty{"NONE",  "none",  "'NONE'",
                                                   "Shape", "SOLID", "COMPOUND"};
  // And a version, and a number.
  if (name.starts_with("Open CASCADE STEP translator")) return {};
  return std::ranges::find(kEmpty, name) == kEmpty.end() ? name : std::string();
}

Handle(TDocStd_Document) new_document(double cad_mm) {
  Handle(TDocStd_Document) document;
  XCAFApp_Application::GetApplication()->NewDocument("MDTV-XCAF", document);
  XCAFDoc_DocumentTool::SetLengthUnit(document, cad_mm, UnitsMethods_LengthUnit_Millimeter);
  return document;
}

/// Colour and name in the document; the document stays alive in the function.
void use_document(Contents& contents, Handle(TDocStd_Document) document) {
  const Handle(XCAFDoc_ColorTool) colours = XCAFDoc_DocumentTool::ColorTool(document->Main());
  contents.colour_of = [document, colours](const TopoDS_Shape& shape) -> std::string {
    Quantity_Color colour;
    for (const XCAFDoc_ColorType type : {XCAFDoc_ColorSurf, XCAFDoc_ColorGen}) {
      if (!colours->GetInstanceColor(shape, type, colour) &&
          !colours->GetColor(shape, type, colour)) {
        continue;
      }
      std::string hex = Quantity_Color::ColorToHex(colour).ToCString();
      for (char& c : hex) c = c >= 'A' && c <= 'F' ? static_cast<char>(c - 'A' + 'a') : c;
      return hex;
    }
    return {};
  };
}

TopoDS_Shape shapes_of(const Handle(TDocStd_Document) & document) {
  TDF_LabelSequence labels;
  XCAFDoc_DocumentTool::ShapeTool(document->Main())->GetFreeShapes(labels);
  BRep_Builder builder;
  TopoDS_Compound all;
  builder.MakeCompound(all);
  for (const TDF_Label& label : labels) builder.Add(all, XCAFDoc_ShapeTool::GetShape(label));
  return all;
}

/// What stands for the empty name of an instance: its number, or an identifier with that.
bool is_number(std::string_view name) {
  if (name.starts_with("NAUO")) name.remove_prefix(4);
  return std::ranges::all_of(name, [](char c) { return c >= '0' && c <= '9'; });
}

/// The name of a shape in the document: of an instance, else of the body or part that it is of.
std::string name_in(const Handle(TDocStd_Document) & document, const TopoDS_Shape& shape) {
  TDF_Label label;
  const Handle(XCAFDoc_ShapeTool) tool = XCAFDoc_DocumentTool::ShapeTool(document->Main());
  if (!tool->Search(shape, label)) return {};
  for (;;) {
    Handle(TDataStd_Name) name;
    std::string text;
    if (label.FindAttribute(TDataStd_Name::GetID(), name)) {
      text = real_name(TCollection_AsciiString(name->Get(), '?').ToCString());
    }
    TDF_Label of;
    if (!XCAFDoc_ShapeTool::GetReferredShape(label, of)) return text;
    if (!is_number(text)) return text;
    label = of;
  }
}

Contents read_step(const std::string& file, double cad_mm) {
  check_step_numbers(file);
  STEPCAFControl_Reader reader;
  if (reader.ReadFile(file.c_str()) != IFSelect_RetDone) {
    throw IoError(file + ": is no STEP file, or one that breaks off");
  }
  Contents contents;
  TColStd_SequenceOfAsciiString lengths, angles, solid_angles;
  reader.ChangeReader().FileUnits(lengths, angles, solid_angles);
  if (!lengths.IsEmpty()) set_unit(contents, cad_mm, lengths.First().ToCString());
  Handle(TDocStd_Document) document = new_document(cad_mm);
  if (!reader.Transfer(document)) throw IoError(file + ": holds no shape that can be read");
  contents.shape = shapes_of(document);
  use_document(contents, document);
  const Handle(XSControl_WorkSession) session = reader.ChangeReader().WS();
  contents.name_of = [document, session](const TopoDS_Shape& shape) {
    const auto& transfer = session->TransferReader();
    const auto item =
        Handle(StepRepr_RepresentationItem)::DownCast(transfer->EntityFromShapeResult(shape, 1));
    const bool is_face = shape.ShapeType() == TopAbs_FACE;
    // What a face came from may be the body that it is of.
    const bool is_own = !item.IsNull() && is_face == item->IsKind(STANDARD_TYPE(StepShape_Face));
    const std::string name = is_own ? real_name(text_of(item->Name())) : std::string();
    return name.empty() && !is_face ? name_in(document, shape) : name;
  };
  contents.closed_of = closed_shells_of(session);
  contents.losses = losses_of(session);
  return contents;
}

/// Lines of each section have its letter in column 73; the last line counts those of the others.
/// OpenCASCADE takes what there is.
void check_whole_iges(const std::string& file) {
  constexpr std::string_view kSections = "SGDP";
  constexpr std::size_t kLetter = 72;
  std::array<int, 4> lines{};
  std::string last;
  std::ifstream stream(file, std::ios::binary);
  for (std::string line; last.empty() && std::getline(stream, line);) {
    if (line.size() <= kLetter) continue;
    const std::size_t section = kSections.find(line[kLetter]);
    if (section < lines.size()) ++lines[section];
    if (line[kLetter] == 'T') last = line;
  }
  if (last.empty()) {
    throw IoError(file + ": breaks off: its last line, with a T in column 73, is missing");
  }
  for (std::size_t n = 0; n < lines.size(); ++n) {
    const std::string counted = last.substr(8 * n, 8);
    if (counted.front() != kSections[n] || std::atoi(counted.c_str() + 1) == lines[n]) continue;
    throw IoError(fmt::format(
        "{}: is not whole: its last line counts {} lines of section {}, and there are {}", file,
        std::atoi(counted.c_str() + 1), kSections[n], lines[n]));
  }
}

Contents read_iges(const std::string& file, double cad_mm) {
  check_whole_iges(file);
  IGESCAFControl_Reader reader;
  if (reader.ReadFile(file.c_str()) != IFSelect_RetDone) {
    throw IoError(file + ": is no IGES file, or one that breaks off");
  }
  Contents contents;
  set_unit(contents, cad_mm, text_of(reader.IGESModel()->GlobalSection().UnitName()));
  Handle(TDocStd_Document) document = new_document(cad_mm);
  if (!reader.Transfer(document)) throw IoError(file + ": holds no shape that can be read");
  contents.shape = shapes_of(document);
  use_document(contents, document);
  const Handle(XSControl_WorkSession) session = reader.WS();
  contents.name_of = [session](const TopoDS_Shape& shape) -> std::string {
    const auto entity = Handle(IGESData_IGESEntity)::DownCast(
        session->TransferReader()->EntityFromShapeResult(shape, 1));
    if (entity.IsNull()) return {};
    std::string name = real_name(text_of(entity->NameValue()));
    return name.empty() ? real_name(text_of(entity->ShortLabel())) : name;
  };
  contents.closed_of = [](const TopoDS_Shape&) { return std::string(); };
  contents.losses = losses_of(session);
  return contents;
}

Contents read_brep(const std::string& file) {
  Contents contents;
  BRep_Builder builder;
  // At the end of what breaks off, OpenCASCADE reads on for ever, unless it is thrown out.
  std::stringstream text;
  text << std::ifstream(file, std::ios::binary).rdbuf() << '\n';
  try {
    text.exceptions(std::ios::eofbit | std::ios::failbit | std::ios::badbit);
    BRepTools::Read(contents.shape, text, builder);
  } catch (const std::ios::failure&) {
    contents.shape.Nullify();
  }
  if (contents.shape.IsNull()) throw IoError(file + ": is no BREP file, or one that breaks off");
  contents.name_of = [](const TopoDS_Shape&) { return std::string(); };
  contents.colour_of = contents.name_of;
  contents.closed_of = contents.name_of;
  return contents;
}

enum class Kind { Step, Iges, Brep };

/// By what the file begins with.
Kind kind_of(const std::string& file) {
  std::ifstream stream(file, std::ios::binary);
  if (!stream) throw IoError(file + ": cannot be opened");
  std::string start(400, '\0');
  stream.read(start.data(), static_cast<std::streamsize>(start.size()));
  start.resize(static_cast<std::size_t>(stream.gcount()));
  if (start.find("ISO-10303-21") != std::string::npos) return Kind::Step;
  if (start.find("CASCADE Topology") != std::string::npos ||
      start.find("DBRep_DrawableShape") != std::string::npos) {
    return Kind::Brep;
  }
  // Lines of 80 columns, the first of them of the start section.
  if (start.size() > 73 && start[72] == 'S') return Kind::Iges;
  throw IoError(file +
                ": is no CAD file that is known: STEP begins with ISO-10303-21, BREP with "
                "DBRep_DrawableShape or CASCADE Topology, IGES has an S in column 73");
}

Contents read_as(Kind kind, const std::string& file, double cad_mm) {
  return kind == Kind::Step   ? read_step(file, cad_mm)
         : kind == Kind::Iges ? read_iges(file, cad_mm)
                              : read_brep(file);
}

Bnd_Box box_around(const TopoDS_Shape& shape) {
  Bnd_Box box;
  BRepBndLib::Add(shape, box, false);
  return box;
}

/// Takes out faces without an end, unless all are, as IGES has them of planes and cylinders that
/// serve construction.
void drop_endless(Contents& contents) {
  if (contents.shape.IsNull() || !box_around(contents.shape).IsOpen()) return;
  BRepTools_ReShape rest;
  int dropped = 0;
  int kept = 0;
  for (TopExp_Explorer face(contents.shape, TopAbs_FACE); face.More(); face.Next()) {
    const bool is_endless = box_around(face.Current()).IsOpen();
    if (is_endless) rest.Remove(face.Current());
    ++(is_endless ? dropped : kept);
  }
  if (dropped == 0 || kept == 0) return;
  contents.shape = rest.Apply(contents.shape);
  contents.losses.push_back(dropped == 1
                                ? "a face has no end, and is left out"
                                : fmt::format("{} faces have no end, and are left out", dropped));
}

/// A unit in which what is `size_cad` long in millimetres is about 1000: a power of two of the
/// file's, so that numbers stay as they are. 0: millimetres do. Tolerances of readers and of
/// healing are lengths: 1e-7 at least, 1 at most.
double better_unit(double size_cad, double world_per_cad) {
  constexpr double kSmall = 10;
  constexpr double kLarge = 1e5;
  constexpr double kWanted = 1000;
  if (!(size_cad > 0) || (size_cad >= kSmall && size_cad <= kLarge)) return 0;
  const double file_mm = 1 / world_per_cad;
  return std::exp2(std::round(std::log2(size_cad / (kWanted * file_mm)))) * file_mm;
}

}  // namespace

double longest_side(const TopoDS_Shape& shape) {
  const Bnd_Box box = box_around(shape);
  if (box.IsVoid() || box.IsOpen()) return 0;
  const gp_Pnt lo = box.CornerMin();
  const gp_Pnt hi = box.CornerMax();
  return std::max({hi.X() - lo.X(), hi.Y() - lo.Y(), hi.Z() - lo.Z()});
}

const Length& length_of(std::string_view name) {
  const auto found = std::ranges::find_if(
      kLengths, [&](const Length& l) { return l.in_file == name || l.name == name; });
  return found == kLengths.end() ? kLengths.front() : *found;
}

void keep_quiet() {
  Message::DefaultMessenger()->RemovePrinters(STANDARD_TYPE(Message_PrinterOStream));
}

Contents read_contents(const std::string& file) {
  keep_quiet();
  const Kind kind = kind_of(file);
  try {
    Contents contents = read_as(kind, file, 1);
    drop_endless(contents);
    if (kind == Kind::Brep) return contents;
    const double cad_mm = better_unit(longest_side(contents.shape), contents.world_per_cad);
    if (!(cad_mm > 0)) return contents;
    contents = read_as(kind, file, cad_mm);
    drop_endless(contents);
    return contents;
  } catch (const Standard_Failure& failure) {
    throw IoError(file + ": OpenCASCADE cannot read it: " + failure.GetMessageString());
  }
}

}  // namespace vdb_offset::cad
