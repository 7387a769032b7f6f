#include "inputs.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <fstream>

#include "vdb_offset/core/error.h"
#include "vdb_offset/io/airfoil.h"
#include "vdb_offset/io/cgns.h"
#include "vdb_offset/io/obj_curves.h"

namespace vdb_offset::command {

InputFormat::InputFormat(const std::string& words) : words_(words) {
  if (words == "airfoil" || words == "obj" || words == "cgns") return;
  try {
    hint_ = Plot3dHint::parse(words);
  } catch (const InputError& error) {
    throw InputError(std::string(error.what()) + "; or airfoil, cgns or obj, alone");
  }
}

InputKind InputFormat::kind_of(const std::string& file) const {
  if (words_ == "airfoil") return InputKind::Airfoil;
  if (words_ == "obj") return InputKind::Obj;
  if (words_ == "cgns") return InputKind::Cgns;
  if (!words_.empty()) return InputKind::Plot3d;
  std::string extension = std::filesystem::path(file).extension().string();
  for (char& c : extension) c = c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
  if (extension == ".cgns") return InputKind::Cgns;
  if (extension == ".dat") return InputKind::Airfoil;
  if (extension == ".nmf") return InputKind::NeutralMap;
  return extension == ".obj" ? InputKind::Obj : InputKind::Plot3d;
}

Patches InputFormat::read(const std::string& file) const {
  switch (kind_of(file)) {
    case InputKind::Airfoil:
      return read_airfoil(file);
    case InputKind::Obj:
      return read_obj_curves(file);
    case InputKind::Cgns:
      return read_cgns(file);
    case InputKind::NeutralMap:
      throw InputError(file + ": is a neutral map, which holds no points");
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
