#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <map>
#include <numeric>
#include <vector>

#include "command.h"
#include "inputs.h"
#include "surface_options.h"
#include "vdb_offset/core/error.h"
#include "vdb_offset/io/cgns.h"

namespace vdb_offset::command {
namespace {

/// Curves bound a plane, surfaces a space. A file never holds both.
void check_one_kind(const Patch& a, const Patch& b) {
  if ((a.nj == 1) == (b.nj == 1)) return;
  const Patch& curve = a.nj == 1 ? a : b;
  const Patch& surface = a.nj == 1 ? b : a;
  throw InputError(fmt::format("{} holds curves, and {} surfaces; mesh them in runs of their own",
                               curve.file, surface.file));
}

/// The surfaces' files and those of boundaries.
std::vector<std::string> all_files(const Settings& settings) {
  std::vector<std::string> files = settings.surfaces;
  for (const std::string& text : settings.shapes) {
    files.push_back(parse_shape("--boundary", text).file);
  }
  for (const std::string& text : settings.internals) {
    files.push_back(parse_shape("--internal", text).file);
  }
  return files;
}

/// The unit of length of the CGNS files that say one; empty: none does.
std::string cgns_length_unit(const std::vector<std::string>& files, const InputFormat& format) {
  std::string unit;
  std::string first;
  for (const std::string& file : files) {
    if (format.kind_of(file) != InputKind::Cgns) continue;
    const std::string own = inspect_cgns(file).length_unit;
    if (own.empty() || own == unit) continue;
    if (!unit.empty()) {
      throw InputError(fmt::format(
          "{} has lengths in {}, and {} in {}; convert one of them, or mesh them in runs of their "
          "own",
          first, unit, file, own));
    }
    unit = own;
    first = file;
  }
  return unit;
}

/// Numbers of faces, counted on over files, of patches that came without.
void number_faces(const Patches& patches, std::size_t before, PolygonUse& use) {
  for (std::size_t p = use.face_numbers.size() - before; p < patches.size(); ++p) {
    std::vector<int>& numbers = use.face_numbers.emplace_back(patches[p].cells());
    std::iota(numbers.begin(), numbers.end(), use.next_number);
    use.next_number += static_cast<int>(numbers.size());
  }
}

void add_cad_notes(Settings& settings, const InputFormat& format) {
  const bool has_cad = std::ranges::any_of(all_files(settings), [&](const std::string& file) {
    return format.kind_of(file) == InputKind::Cad;
  });
  if (has_cad && settings.pipeline.surface.scale != 1) {
    settings.input_notes.push_back(
        fmt::format("lengths said of CAD files are theirs, before --scale {:g}",
                    settings.pipeline.surface.scale));
  }
  if (settings.cad.size_world > 0 && !has_cad) {
    settings.input_notes.push_back(
        "--surface-size is for CAD models, and none is given: it has no effect");
  }
}

}  // namespace

Patches read_surfaces(Settings& settings, PolygonUse& use) {
  SurfaceOptions& options = settings.pipeline.surface;
  CadOptions cad = settings.cad;
  cad.size_world /= options.scale;
  const InputFormat format(settings.input_format, cad);
  use.weld = options.weld;
  use.length_unit = cgns_length_unit(all_files(settings), format);
  Patches all;
  std::map<std::string, int> used;
  int bodies = 0;
  bool is_all_polygons = true;
  for (const std::string& file : settings.surfaces) {
    const int bodies_before = bodies;
    const bool is_topology = format.kind_of(file) == InputKind::Topology;
    Patches patches = is_topology ? patches_of(read_topology(file), options)
                                  : format.read(file, use, settings.input_notes);
    if (patches.empty()) throw InputError(file + ": holds no wall");
    use.lacks_unit = use.lacks_unit || is_topology;
    is_all_polygons = is_all_polygons && use.face_numbers.size() == all.size() + patches.size();
    number_faces(patches, all.size(), use);
    if (!all.empty()) check_one_kind(all.front(), patches.front());
    std::string stem = std::filesystem::path(file).stem().string();
    const int times = ++used[stem];
    if (times > 1) stem += fmt::format("-{}", times);
    for (Patch& patch : patches) {
      if (settings.surfaces.size() > 1) {
        patch.name = stem + ": " + patch.name;
        if (patch.family.empty()) patch.family = stem;
      }
      if (patch.body > 0) patch.body += bodies_before;
      bodies = std::max(bodies, patch.body);
      all.push_back(std::move(patch));
    }
  }
  use.is_all_welded = is_all_polygons && (settings.surfaces.size() == 1 || use.open_edges == 0);
  if (!use.lacks_unit && options.scale == 1) settings.length_unit = use.length_unit;
  const auto read = [&](const char* option, const std::string& text) {
    return read_shape(parse_shape(option, text), format, use.length_unit);
  };
  for (const std::string& text : settings.shapes) {
    options.shapes.push_back(read("--boundary", text));
  }
  for (const std::string& text : settings.internals) {
    options.internals.push_back(read("--internal", text));
  }
  add_cad_notes(settings, format);
  return all;
}

}  // namespace vdb_offset::command
