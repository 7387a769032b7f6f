// The one list of options, by stage in the order of the pipeline.

#include <sstream>

#include "option_binding.h"
#include "surface_options.h"
#include "vdb_offset/core/units.h"

namespace vdb_offset::command {
namespace {

void parse_memory(Settings& settings, const std::string& text) {
  const std::uint64_t bytes = parse_bytes(text);
  if (bytes == 0) throw InputError(fmt::format("'{}' must be more than nothing", text));
  settings.pipeline.rasterize.memory_bytes = bytes;
}

OptionValue echo_memory(const Settings& settings) {
  const std::uint64_t bytes = settings.pipeline.rasterize.memory_bytes;
  return bytes == 0 ? OptionValue{} : OptionValue{static_cast<std::int64_t>(bytes)};
}

void parse_grids(Settings& settings, const std::string& text) {
  settings.grids.phi = settings.grids.normal = settings.feature_grid = false;
  std::istringstream names(text);
  std::string name;
  while (std::getline(names, name, ',')) {
    if (name == "phi") {
      settings.grids.phi = true;
    } else if (name == "normal") {
      settings.grids.normal = true;
    } else if (name == "feature") {
      settings.feature_grid = true;
    } else {
      throw InputError(fmt::format("'{}' is not phi, normal or feature", name));
    }
  }
  if (!settings.grids.phi && !settings.grids.normal && !settings.feature_grid) {
    throw InputError("name at least one of phi, normal and feature");
  }
}

OptionValue echo_grids(const Settings& settings) {
  std::vector<std::string> names;
  if (settings.grids.phi) names.emplace_back("phi");
  if (settings.grids.normal) names.emplace_back("normal");
  if (settings.feature_grid) names.emplace_back("feature");
  return fmt::format("{}", fmt::join(names, ","));
}

std::vector<OptionField> field_fields() {
  const unsigned both = kMesh | kField;
  return {
      automatic(
          {.stage = "rasterize",
           .flag = "--voxel",
           .value = "H",
           .unit = "length",
           .range = "> 0",
           .preset = "min(D / 12, median surface edge), larger if memory "
                     "needs it",
           .help = "Voxel edge; half of it costs eight times the memory and time.",
           .member = "RasterizeOptions::voxel_world",
           .commands = both},
          [](auto& s) -> auto& { return s.pipeline.rasterize.voxel_world; }),
      parsed({.stage = "rasterize",
              .flag = "--memory",
              .value = "SIZE",
              .unit = "bytes, or with K, M, G, T",
              .range = "> 0",
              .preset = "3/4 of the free memory",
              .help = "Most memory to use; refused before anything large is allocated.",
              .member = "RasterizeOptions::memory_bytes",
              .commands = both},
             parse_memory, echo_memory),
      direct(
          {.stage = "sweep",
           .flag = "--sweep-tolerance",
           .value = "T",
           .unit = "voxels",
           .range = ">= 0",
           .help = "Sweep until no voxel moves by more; 0: until no bit changes.",
           .member = "SweepOptions::tolerance_voxels",
           .commands = both},
          [](auto& s) -> auto& { return s.pipeline.sweep.tolerance_voxels; }),
      direct(
          {.stage = "sweep",
           .flag = "--max-sweeps",
           .value = "N",
           .range = "[1, 100000]",
           .help = "Give up after so many sweeps (exit 4).",
           .member = "SweepOptions::max_sweeps",
           .commands = both},
          [](auto& s) -> auto& { return s.pipeline.sweep.max_sweeps; }),
  };
}

std::vector<OptionField> march_fields() {
  return {
      automatic(
          {.stage = "march",
           .flag = "--distance",
           .value = "D",
           .unit = "length",
           .range = "> 0",
           .preset = "required",
           .help = "Thickness of the layers: true distance to the wall.",
           .member = "PipelineOptions::distance_world",
           .commands = kMesh | kField},
          [](auto& s) -> auto& { return s.pipeline.distance_world; }),
      direct(
          {.stage = "march",
           .flag = "--step",
           .value = "X",
           .unit = "voxels",
           .range = "[0.01, 2]",
           .help = "Runge-Kutta step along a column.",
           .member = "MarchOptions::step_voxels"},
          [](auto& s) -> auto& { return s.pipeline.march.step_voxels; }),
      direct(
          {.stage = "march",
           .flag = "--layers",
           .value = "N",
           .unit = "cells",
           .range = "[1, 10000]",
           .preset = "32, or from first cell and growth",
           .help = "Layers. Of layers, first cell and growth give two: the distance fixes the "
                   "third.",
           .member = "SpacingOptions::layers"},
          [](auto& s) -> auto& { return s.pipeline.spacing.layers; }),
      direct(
          {.stage = "march",
           .flag = "--first-cell",
           .value = "S",
           .unit = "length",
           .range = "> 0",
           .preset = "from layers and growth",
           .help = "Height of the cell at the wall.",
           .member = "SpacingOptions::first_cell_world"},
          [](auto& s) -> auto& { return s.pipeline.spacing.first_cell_world; }),
      direct(
          {.stage = "march",
           .flag = "--growth",
           .value = "R",
           .range = "[1, 10]",
           .preset = "1.2, or from layers and first cell",
           .help = "Ratio of neighbouring cells. With a first cell the layers round up and the "
                   "growth is solved again.",
           .member = "SpacingOptions::growth"},
          [](auto& s) -> auto& { return s.pipeline.spacing.growth; }),
      direct(
          {.stage = "march",
           .flag = "--last-cell",
           .value = "S",
           .unit = "length",
           .range = "> 0",
           .preset = "free",
           .help = "Height of the outermost cell; needs layers and first cell.",
           .member = "SpacingOptions::last_cell_world"},
          [](auto& s) -> auto& { return s.pipeline.spacing.last_cell_world; }),
      direct(
          {.stage = "march",
           .flag = "--max-growth",
           .value = "R",
           .range = "(1, 10]",
           .help = "A larger growth is refused.",
           .member = "SpacingOptions::max_growth"},
          [](auto& s) -> auto& { return s.pipeline.spacing.max_growth; }),
      direct(
          {.stage = "march",
           .flag = "--gap-margin",
           .value = "X",
           .unit = "free heights",
           .range = "[0, 0.9]",
           .help = "Part of its free height by which a column stays away from the front of a "
                   "facing wall.",
           .member = "MarchOptions::gap_margin"},
          [](auto& s) -> auto& { return s.pipeline.march.gap_margin; }),
      direct(
          {.stage = "march",
           .flag = "--splay",
           .value = "A",
           .unit = "degrees",
           .range = "[0, 57]",
           .help =
               "Angle by which columns lean outward at free edges on no boundary; it fades over "
               "twice the distance.",
           .member = "MarchOptions::splay"},
          [](auto& s) -> auto& { return s.splay_degrees; }),
      direct(
          {.stage = "march",
           .flag = "--family",
           .value = "NAME:KEY=X,...",
           .range = "distance=D, first-cell=S, layers=off",
           .preset = "none",
           .help = "Layers of one family or patch, tapered at its neighbours; with layers=off it "
                   "has none: its neighbours' end on it where they meet it at an angle, and taper "
                   "to nothing where they go on smoothly. May be repeated.",
           .member = "MarchOptions::families"},
          [](auto& s) -> auto& { return s.families; }),
  };
}

bool parse_switch(const std::string& text) {
  if (text == "on") return true;
  if (text == "off") return false;
  throw InputError(fmt::format("'{}' is not on or off", text));
}

void parse_outer(Settings& settings, const std::string& text) {
  ConditionKind& outer = settings.pipeline.conditions.outer;
  if (text == "farfield") {
    outer = ConditionKind::Farfield;
  } else if (text == "overset") {
    outer = ConditionKind::Overset;
  } else {
    throw InputError(fmt::format("'{}' is not farfield or overset", text));
  }
}

OptionValue echo_outer(const Settings& settings) {
  return describe({settings.pipeline.conditions.outer});
}

std::vector<OptionField> blocks_fields() {
  return {
      parsed(
          {.stage = "blocks",
           .flag = "--repair",
           .value = "WHAT",
           .range = "on, off",
           .help = "Move columns around cells that are not positive, have collapsed or are worse "
                   "than --quality, until they are valid; off: blocks as marched.",
           .member = "RepairOptions::on"},
          [](Settings& s, const std::string& text) { s.pipeline.repair.on = parse_switch(text); },
          [](const Settings& s) {
            return OptionValue{std::string(s.pipeline.repair.on ? "on" : "off")};
          }),
      direct(
          {.stage = "blocks",
           .flag = "--quality",
           .value = "Q",
           .unit = "scaled Jacobian",
           .range = "[0, 1)",
           .help = "Least that cells are brought to, where the wall's own corners allow it.",
           .member = "RepairOptions::quality"},
          [](auto& s) -> auto& { return s.pipeline.repair.quality; }),
      parsed({.stage = "blocks",
              .flag = "--outer",
              .value = "WHAT",
              .range = "farfield, overset",
              .help = "Boundary condition of the outermost level.",
              .member = "ConditionOptions::outer"},
             parse_outer, echo_outer),
      direct(
          {.stage = "blocks",
           .flag = "--bc",
           .value = "NAME:KIND",
           .range = "wall, inviscid-wall, symmetry, inflow, outflow, farfield, overset, or a "
                    "BCType of CGNS",
           .preset = "by kind and name",
           .help = "Boundary condition of a family, a patch, a boundary or internal surface, "
                   "outer or free; may be repeated. Else walls are wall, planes called "
                   "symmetry... symmetry, inlet... inflow, outlet... outflow.",
           .member = "ConditionOptions::named"},
          [](auto& s) -> auto& { return s.conditions; }),
  };
}

std::vector<OptionField> io_fields() {
  const unsigned both = kMesh | kField;
  return {
      direct(
          {.stage = "io",
           .flag = "-o,--output",
           .value = "FILE",
           .help = "Output, may be repeated. By extension: .xyz .p3d .x .g .grd .bin PLOT3D "
                   "unformatted, .fmt PLOT3D formatted, .nmf the neutral map of its blocks, .cgns "
                   "CGNS, .vtm VTK, .vtu VTK unstructured, .su2 SU2, .vdb OpenVDB; CASE/ or "
                   "CASE/NAME.foam an OpenFOAM "
                   "case; example only: .dat airfoil.",
           .commands = both | kExample},
          [](auto& s) -> auto& { return s.outputs; }),
      direct(
          {.stage = "io",
           .flag = "--format",
           .value = "FORMAT",
           .range = "plot3d, plot3d-formatted, nmf, cgns, vtk, openfoam, su2, vdb; airfoil",
           .preset = "by extension",
           .help = "Format of every -o.",
           .commands = both | kExample},
          [](auto& s) -> auto& { return s.format; }),
      direct(
          {.stage = "io",
           .flag = "--vdb",
           .value = "FILE",
           .preset = "none",
           .help = "The distance field and the outermost level as OpenVDB grids."},
          [](auto& s) -> auto& { return s.vdb; }),
      direct(
          {.stage = "io",
           .flag = "--outer-surface",
           .value = "FILE",
           .preset = "none",
           .help =
               "The outermost level, for another mesher to fill the rest: by extension PLOT3D, "
               ".cgns, .obj (quads), with the blocks' points to the bit; .stl (in floats); .step "
               "(B-spline surfaces through them). May be repeated."},
          [](auto& s) -> auto& { return s.outer_surfaces; }),
      direct(
          {.stage = "io",
           .flag = "--topology",
           .value = "FILE.json",
           .preset = "none",
           .help = "Vertices, edges, faces and blocks, how they bound one another, and the surface "
                   "they stand on, as JSON; it can be read as a SURFACE."},
          [](auto& s) -> auto& { return s.topology; }),
      parsed({.stage = "io",
              .flag = "--grids",
              .value = "NAMES",
              .range = "phi, normal, feature, with commas",
              .help = "Grids of a .vdb: distance, its unit gradient, number of the nearest face: "
                      "from 0 in the order of the file, over files; of grids the quads, i fastest; "
                      "of a mesh in the order of its patches.",
              .commands = both},
             parse_grids, echo_grids),
      direct(
          {.stage = "io",
           .flag = "--half",
           .help = "Floats of a .vdb in 16 bits: half the file, 3 digits.",
           .commands = both},
          [](auto& s) -> auto& { return s.grids.half; }),
      direct(
          {.stage = "io",
           .flag = "--report",
           .value = "FILE.json",
           .preset = "none",
           .help = "Report of the run as JSON; - prints it on standard output.",
           .commands = both},
          [](auto& s) -> auto& { return s.report; }),
  };
}

}  // namespace

const std::vector<OptionField>& option_fields() {
  static const std::vector<OptionField> all = [] {
    std::vector<OptionField> out;
    for (auto part : {surface_fields(), field_fields(), march_fields(), blocks_fields(),
                      example_fields(), io_fields(), run_fields()}) {
      out.insert(out.end(), part.begin(), part.end());
    }
    return out;
  }();
  return all;
}

}  // namespace vdb_offset::command
