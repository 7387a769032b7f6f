#include "outputs.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <map>
#include <set>
#include <system_error>

#include "cad_input.h"
#include "vdb_offset/core/error.h"
#include "vdb_offset/core/units.h"
#include "vdb_offset/io/cad.h"
#include "vdb_offset/io/openfoam.h"
#include "vdb_offset/io/output.h"
#include "vdb_offset/io/vtk.h"

namespace vdb_offset::command {
namespace {

namespace fs = std::filesystem;

// Measured, on two threads: libraries, the threads' stacks, what OpenVDB and reading leave behind.
constexpr std::uint64_t kProgramBytes = std::uint64_t{47} << 20U;
// A grid: leaves of 8^3 values with masks and their share of the inner nodes; the upper nodes.
constexpr std::uint64_t kFloatLeafBytes = 2048 + 160;
constexpr std::uint64_t kVectorLeafBytes = 3 * 2048 + 160;
constexpr std::uint64_t kUpperNodeBytes = 2'500'000;
// The outermost level's points, and what sorting them takes; measured for bands of three tiles.
constexpr std::uint64_t kLevelTileBytes = 2900;

const std::map<std::string, Format>& formats_by_name() {
  static const std::map<std::string, Format> names = {
      {"plot3d", Format::Plot3d},     {"plot3d-formatted", Format::Plot3dFormatted},
      {"nmf", Format::NeutralMap},    {"cgns", Format::Cgns},
      {"vtk", Format::Vtk},           {"vtu", Format::Vtu},
      {"openfoam", Format::OpenFoam}, {"su2", Format::Su2},
      {"vdb", Format::Vdb},           {"airfoil", Format::Airfoil},
      {"obj", Format::Obj},           {"stl", Format::Stl},
      {"step", Format::Step}};
  return names;
}

const std::map<std::string, Format>& formats_by_extension() {
  static const std::map<std::string, Format> names = {{".xyz", Format::Plot3d},
                                                      {".p3d", Format::Plot3d},
                                                      {".x", Format::Plot3d},
                                                      {".g", Format::Plot3d},
                                                      {".grd", Format::Plot3d},
                                                      {".bin", Format::Plot3d},
                                                      {".fmt", Format::Plot3dFormatted},
                                                      {".nmf", Format::NeutralMap},
                                                      {".cgns", Format::Cgns},
                                                      {".vtm", Format::Vtk},
                                                      {".vtu", Format::Vtu},
                                                      {".foam", Format::OpenFoam},
                                                      {".su2", Format::Su2},
                                                      {".obj", Format::Obj},
                                                      {".stl", Format::Stl},
                                                      {".step", Format::Step},
                                                      {".stp", Format::Step},
                                                      {".vdb", Format::Vdb},
                                                      {".dat", Format::Airfoil}};
  return names;
}

/// The keys of `names` whose format a command can write: what an error offers.
std::string choices(const std::map<std::string, Format>& names, const OutputRule& rule) {
  std::vector<std::string> out;
  for (const auto& [name, format] : names) {
    if (std::ranges::count(rule.allowed, format) > 0) out.push_back(name);
  }
  return fmt::format("{}", fmt::join(out, ", "));
}

Format format_of(const fs::path& file, const std::string& forced, const OutputRule& rule) {
  const bool can_be_case = std::ranges::count(rule.allowed, Format::OpenFoam) > 0;
  const bool is_folder = !file.empty() && !file.has_filename();  // "case/"
  if (forced.empty() && is_folder && can_be_case) return Format::OpenFoam;
  const auto& names = forced.empty() ? formats_by_extension() : formats_by_name();
  const std::string name = forced.empty() ? file.extension().string() : forced;
  const auto found = names.find(name);
  const bool known = found != names.end();
  if (known && std::ranges::count(rule.allowed, found->second) > 0) return found->second;
  const std::string what =
      known ? fmt::format("'{}' cannot be written by '{}'", name, rule.command)
            : fmt::format("'{}' is not a known {}", name, forced.empty() ? "extension" : "format");
  const bool has_format = !rule.command.starts_with("--");  // an option goes by extension alone
  const std::string instead = has_format ? ", or --format " + choices(formats_by_name(), rule) : "";
  if (name.empty()) {
    throw InputError(fmt::format("{}: the name has no extension; use {}{}", file.string(),
                                 choices(names, rule), instead));
  }
  if (!forced.empty()) {
    throw InputError(fmt::format("--format: {}; use {}", what, choices(names, rule)));
  }
  throw InputError(
      fmt::format("{}: {}; use {}{}", file.string(), what, choices(names, rule), instead));
}

/// One spelling for each place on the disk.
std::string place(const fs::path& file) {
  std::error_code error;
  const fs::path path = fs::weakly_canonical(fs::absolute(file), error);
  return error ? file.string() : path.string();
}

/// What --outer-surface can be.
const OutputRule kSurfaces{"--outer-surface",
                           {Format::Plot3d, Format::Plot3dFormatted, Format::Cgns, Format::Obj,
                            Format::Stl, Format::Step}};

/// What an output puts in place; links are followed.
std::string target_of(const Output& output) {
  if (output.file.empty()) throw InputError("-o: the file name is empty");
  if (output.format == Format::OpenFoam) return place(openfoam_place(output.file));
  return place(output_place(output.file));
}

/// Places of all files that are read; FILE:NAME with and without its name.
std::set<std::string> inputs_of(const Settings& settings) {
  std::set<std::string> inputs;
  for (const std::string& file : settings.surfaces) inputs.insert(place(file));
  for (const auto* shapes : {&settings.shapes, &settings.internals}) {
    for (const std::string& text : *shapes) {
      inputs.insert(place(text));
      inputs.insert(place(text.substr(0, text.rfind(':'))));
    }
  }
  if (!settings.config.empty()) inputs.insert(place(settings.config));
  return inputs;
}

}  // namespace

std::vector<Output> plan_outputs(const Settings& settings, const OutputRule& rule) {
  std::vector<Output> out;
  for (const std::string& file : settings.outputs) {
    out.push_back({file, format_of(file, settings.format, rule)});
  }
  if (!settings.vdb.empty()) out.push_back({settings.vdb, Format::Vdb});
  for (const std::string& file : settings.outer_surfaces) {
    out.push_back({file, format_of(file, "", kSurfaces), true});
  }

  const std::set<std::string> inputs = inputs_of(settings);
  std::set<std::string> seen;
  const auto claim = [&](const fs::path& file, const std::string& target) {
    if (!seen.insert(target).second) {
      throw InputError(file.string() + ": is named twice as an output; give each its own name");
    }
    if (inputs.contains(target)) {
      throw InputError(file.string() + ": is an input too, and would be overwritten");
    }
  };
  for (const Output& output : out) claim(output.file, target_of(output));
  if (!settings.report.empty() && settings.report != "-") {
    claim(settings.report, place(output_place(settings.report)));
  }
  if (!settings.topology.empty()) {
    claim(settings.topology, place(output_place(settings.topology)));
  }
  for (const Output& output : out) {
    if (output.format != Format::Vtk) continue;
    const std::string pieces = place(vtm_pieces_place(output.file));
    if (!seen.insert(pieces).second) {
      throw InputError(pieces + ": is an output, but the pieces of " + output.file.string() +
                       " go into a folder of that name; give it another name");
    }
  }
  const auto step = std::ranges::find(out, Format::Step, &Output::format);
  if (step != out.end()) require_step(step->file);
  return out;
}

void refuse_unfit(const Patches& patches, const std::vector<Output>& outputs,
                  const Settings& settings) {
  const bool flat = !patches.empty() && patches.front().nj == 1;
  const auto map = std::ranges::find(outputs, Format::NeutralMap, &Output::format);
  if (flat && map != outputs.end()) {
    throw InputError(map->file.string() +
                     ": a neutral map is of blocks in three dimensions; for curves write .cgns");
  }
  const auto polygons = std::ranges::find_if_not(patches, &Patch::is_grid);
  if (polygons == patches.end()) return;
  if (!settings.topology.empty()) {
    throw InputError(fmt::format(
        "--topology {}: is of structured blocks, but patch '{}' is made of {} triangles and quads; "
        "leave it out",
        settings.topology, polygons->name, polygons->faces.size()));
  }
  constexpr std::array<Format, 5> kStructured{Format::Plot3d, Format::Plot3dFormatted,
                                              Format::NeutralMap, Format::Vtk, Format::Step};
  for (const Output& output : outputs) {
    const bool is_cgns_surface = output.is_outer_surface && output.format == Format::Cgns;
    if (!is_cgns_surface && std::ranges::count(kStructured, output.format) == 0) continue;
    throw InputError(fmt::format(
        "{}: holds structured blocks alone, but patch '{}' is made of {} triangles and quads; use "
        "{}",
        output.file.string(), polygons->name, polygons->faces.size(),
        output.is_outer_surface ? ".obj or .stl" : ".vtu, .cgns, .su2 or an OpenFOAM case"));
  }
}

PipelineOptions plan_memory(const Settings& settings, const std::vector<Output>& outputs,
                            bool layers) {
  PipelineOptions pipeline = settings.pipeline;
  RasterizeOptions& band = pipeline.rasterize;
  if (band.memory_bytes > 0 && band.memory_bytes <= kProgramBytes) {
    throw LimitError(
        fmt::format("--memory {}: the program alone takes about {}; give a larger --memory",
                    format_bytes(static_cast<double>(band.memory_bytes)),
                    format_bytes(static_cast<double>(kProgramBytes))));
  }
  band.other_bytes += kProgramBytes;
  const bool writes_grids = std::ranges::any_of(
      outputs, [](const Output& output) { return output.format == Format::Vdb; });
  if (!writes_grids) return pipeline;
  const auto add = [&](bool wanted, std::uint64_t leaf, std::uint64_t upper) {
    if (!wanted) return;
    band.output_tile_bytes += leaf;
    band.other_bytes += upper;
  };
  add(settings.grids.phi, kFloatLeafBytes, kUpperNodeBytes);
  add(settings.feature_grid, kFloatLeafBytes, kUpperNodeBytes);
  add(settings.grids.normal, kVectorLeafBytes, 2 * kUpperNodeBytes);
  add(layers, kLevelTileBytes, 0);
  return pipeline;
}

void note_unit(const std::string& unit, const std::vector<Output>& outputs,
               const Console& console) {
  if (!unit.empty()) console.note("unit of length: " + unit);
  for (const Output& output : outputs) {
    if (output.format == Format::Cgns && !unit.empty() && cgns_unit(unit).empty()) {
      console.warning(fmt::format("{} says no unit of length: CGNS does not know {}",
                                  output.file.string(), unit));
    }
    if (output.format == Format::Step && unit.empty()) {
      console.warning(
          fmt::format("{} says millimetres, as STEP needs a unit of length, and that of "
                      "the surface is not known",
                      output.file.string()));
    }
  }
}

}  // namespace vdb_offset::command
