#pragma once

#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <string>

#include "inputs.h"
#include "vdb_offset/blocks/cell_zone.h"
#include "vdb_offset/blocks/zone_mesh.h"

namespace vdb_offset::command {

/// A volume mesh, and what it was read from.
struct VolumeInput {
  ZoneMesh mesh;
  std::string format;         ///< in words, with the dialect
  std::filesystem::path map;  ///< the neutral map that its connectivity is from; empty: none
};

/// Read a mesh of blocks to check: CGNS, VTK, or PLOT3D with the neutral map `nmf`, else with that
/// which stands beside it under its name. Each format gets its case here. Throws InputError,
/// IoError.
VolumeInput read_volume(const std::string& file, const InputFormat& format, const std::string& nmf);

/// Whether a file holds a mesh without blocks; of a CGNS file its zones tell. Throws IoError.
bool is_of_cells(const std::string& file, InputKind kind);

/// A mesh without blocks. Throws IoError.
CellZone read_cells(const std::string& file, InputKind kind);

/// `info` of one, as lines and as JSON; its file not among them.
std::string cell_lines(const CellZone& mesh);
nlohmann::ordered_json cells_json(const CellZone& mesh);

/// The format of such a mesh, in words.
const char* cell_format(InputKind kind);

}  // namespace vdb_offset::command
