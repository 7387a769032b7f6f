#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "console.h"
#include "options.h"

namespace vdb_offset::command {

enum class Format {
  Plot3d,
  Plot3dFormatted,
  NeutralMap,
  Cgns,
  Vtk,
  Vtu,
  OpenFoam,
  Su2,
  Vdb,
  Airfoil,
  Obj,
  Stl,
  Step
};

struct Output {
  std::filesystem::path file;
  Format format = Format::Plot3d;
  bool is_outer_surface = false;  ///< the outermost level alone
};

/// Formats that a command can write, and how its messages call it.
struct OutputRule {
  std::string command;
  std::vector<Format> allowed;
};

/// All -o, --vdb and --outer-surface, with their formats; checked before any work.
/// Throws InputError for an unknown format, two outputs of one name, or an output that is an input;
/// IoError for a folder that is missing or may not be written.
std::vector<Output> plan_outputs(const Settings& settings, const OutputRule& rule);

/// Throws InputError for an output of structured blocks, --topology among them, where a patch is
/// made of polygons; and for a neutral map of curves.
void refuse_unfit(const Patches& patches, const std::vector<Output>& outputs,
                  const Settings& settings);

/// The stages' options, with the memory that they cannot know of: the program's own, and what the
/// outputs copy (`layers`: the level's points too). Throws LimitError if --memory is less than the
/// program takes before any work.
PipelineOptions plan_memory(const Settings& settings, const std::vector<Output>& outputs,
                            bool layers);

/// Says the unit of length, as CGNS calls it or would, and warns of outputs that cannot say it or
/// have to say one; empty: it is not known.
void note_unit(const std::string& unit, const std::vector<Output>& outputs, const Console& console);

}  // namespace vdb_offset::command
