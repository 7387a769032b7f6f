#include "inputs.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <system_error>
#include <utility>

#include "vdb_offset/core/error.h"
#include "vdb_offset/io/airfoil.h"
#include "vdb_offset/io/cgns.h"
#include "vdb_offset/io/obj_curves.h"

namespace vdb_offset::command {
namespace {

/// The format that a word means; .obj files are told apart from those.
std::optional<PolygonFormat> polygon_word(std::string_view word) {
  if (word == "stl") return PolygonFormat::Stl;
  if (word == "ply") return PolygonFormat::Ply;
  return word == "off" ? std::optional(PolygonFormat::Off) : std::nullopt;
}

/// In small letters; of files that gzip packed both, as in ".stl.gz".
std::string extension_of(const std::filesystem::path& file) {
  std::string extension = file.extension().string();
  if (extension == ".gz") extension = file.stem().extension().string() + extension;
  for (char& c : extension) c = c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
  return extension;
}

/// Kinds that --input-format calls by a word of their own.
constexpr std::array<std::pair<std::string_view, InputKind>, 11> kWords{
    {{"airfoil", InputKind::Airfoil},
     {"obj", InputKind::Obj},
     {"cgns", InputKind::Cgns},
     {"step", InputKind::Cad},
     {"iges", InputKind::Cad},
     {"brep", InputKind::Cad},
     {"topology", InputKind::Topology},
     {"vtk", InputKind::Vtk},
     {"vtu", InputKind::Vtu},
     {"su2", InputKind::Su2},
     {"openfoam", InputKind::OpenFoam}}};
constexpr std::array<std::pair<std::string_view, InputKind>, 16> kExtensions{
    {{".cgns", InputKind::Cgns},
     {".dat", InputKind::Airfoil},
     {".nmf", InputKind::NeutralMap},
     {".json", InputKind::Topology},
     {".obj", InputKind::Obj},
     {".step", InputKind::Cad},
     {".stp", InputKind::Cad},
     {".iges", InputKind::Cad},
     {".igs", InputKind::Cad},
     {".brep", InputKind::Cad},
     {".brp", InputKind::Cad},
     {".vtm", InputKind::Vtk},
     {".vts", InputKind::Vtk},
     {".vtu", InputKind::Vtu},
     {".su2", InputKind::Su2},
     {".foam", InputKind::OpenFoam}}};

template <typename Table>
const InputKind* find_kind(const Table& table, std::string_view key) {
  const auto found = std::ranges::find(table, key, [](const auto& row) { return row.first; });
  return found == table.end() ? nullptr : &found->second;
}

}  // namespace

InputFormat::InputFormat(const std::string& words, const CadOptions& cad)
    : words_(words), cad_(cad) {
  if (find_kind(kWords, words) != nullptr || polygon_word(words)) return;
  try {
    hint_ = Plot3dHint::parse(words);
  } catch (const InputError& error) {
    throw InputError(std::string(error.what()) +
                     "; or airfoil, brep, cgns, iges, obj, off, openfoam, ply, step, stl, su2, "
                     "topology, vtk or vtu, alone");
  }
}

InputKind InputFormat::kind_of(const std::string& file) const {
  if (const InputKind* kind = find_kind(kWords, words_)) return *kind;
  if (polygon_word(words_)) return InputKind::Polygons;
  if (!words_.empty()) return InputKind::Plot3d;
  std::error_code ignored;
  if (std::filesystem::is_directory(file, ignored)) return InputKind::OpenFoam;
  const std::string extension = extension_of(file);
  if (const InputKind* kind = find_kind(kExtensions, extension)) return *kind;
  const bool known = extension.size() == 4 || (extension.size() == 7 && extension.ends_with(".gz"));
  return known && polygon_word(extension.substr(1, 3)) ? InputKind::Polygons : InputKind::Plot3d;
}

std::optional<PolygonMesh> InputFormat::polygons(const std::string& file,
                                                 std::vector<std::string>& notes,
                                                 std::vector<std::string>& warnings) const {
  if (kind_of(file) == InputKind::Obj) return read_obj_surface(file, notes, warnings);
  PolygonMesh mesh = read_polygons(file, polygon_word(words_));
  if (mesh.counted_from_one) {
    notes.push_back(file + ": its indices count from 1, though those of OFF count from 0");
  }
  return mesh;
}

PolygonFormat InputFormat::polygon_format(const std::string& file) const {
  if (kind_of(file) == InputKind::Obj) return PolygonFormat::Obj;
  const auto forced = polygon_word(words_);
  return forced ? *forced : detect_polygons(file);
}

Patches InputFormat::read(const std::string& file, PolygonUse& use,
                          std::vector<std::string>& notes) const {
  const InputKind kind = kind_of(file);
  const bool is_cgns = kind == InputKind::Cgns;
  if (is_cgns ? inspect_cgns(file).length_unit.empty() : kind != InputKind::Cad) {
    use.lacks_unit = true;
  }
  switch (kind) {
    case InputKind::Airfoil:
      return read_airfoil(file);
    case InputKind::Obj:
    case InputKind::Polygons: {
      const std::optional<PolygonMesh> mesh = polygons(file, notes, use.warnings);
      return mesh ? patches_of(*mesh, use, notes) : read_obj_curves(file);
    }
    case InputKind::Cad: {
      CadWords words{.length_unit = use.length_unit};
      Patches patches = read_cad_surface(file, cad_, words);
      use.lacks_unit = use.lacks_unit || words.length_unit.empty();
      if (!words.length_unit.empty()) use.length_unit = std::move(words.length_unit);
      notes.push_back(std::move(words.note));
      std::ranges::move(words.warnings, std::back_inserter(use.warnings));
      return patches;
    }
    case InputKind::Cgns:
      return read_cgns(file);
    case InputKind::Topology: {
      SurfaceOptions ignored;
      return patches_of(read_topology(file), ignored);
    }
    case InputKind::NeutralMap:
      throw InputError(file + ": is a neutral map, which holds no points");
    case InputKind::Vtk:
    case InputKind::Vtu:
    case InputKind::Su2:
    case InputKind::OpenFoam:
      throw InputError(file +
                       ": is a volume mesh, and no surface is taken from it; check and info "
                       "read it");
    case InputKind::Plot3d:
      break;
  }
  return read_plot3d(file, hint_);
}

void refuse_strangers(const std::string& file, std::string_view advice) {
  std::ifstream stream(file, std::ios::binary);
  char first = ' ';
  stream >> first;
  const char* kind = first == '<' ? "XML, like VTK's files" : first == '{' ? "JSON" : nullptr;
  if (!stream || kind == nullptr) return;
  throw IoError(fmt::format("{}: is {}; {}", file, kind, advice));
}

bool are_curves(const Patches& patches) {
  return std::ranges::all_of(patches, [](const Patch& patch) { return patch.nj == 1; });
}

}  // namespace vdb_offset::command
