#pragma once

#include <string>

#include "vdb_offset/blocks/check_cells.h"
#include "vdb_offset/blocks/check_mesh.h"
#include "volume_input.h"

namespace vdb_offset::command {

/// A check and what it was of.
struct CheckRun {
  const std::string& file;
  const VolumeInput& input;
  const MeshCheck& check;
  double read_seconds = 0;
  double check_seconds = 0;
  bool verbose = false;  ///< the table has every zone, and cells and faults up to kMostListed
};

/// On standard output.
void print_check(const CheckRun& run);

/// The same, and all that the table leaves out, as JSON's text.
std::string check_json(const CheckRun& run);

/// The same of a mesh without blocks.
struct CellCheckRun {
  const std::string& file;
  InputKind kind;
  const CellZone& mesh;
  const CellCheck& check;
  double read_seconds = 0;
  double check_seconds = 0;
  bool verbose = false;
};

void print_check(const CellCheckRun& run);
std::string check_json(const CellCheckRun& run);

}  // namespace vdb_offset::command
