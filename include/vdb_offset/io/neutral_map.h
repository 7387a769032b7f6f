#pragma once

#include <array>
#include <filesystem>
#include <string>
#include <vector>

#include "vdb_offset/blocks/connectivity.h"
#include "vdb_offset/blocks/multi_block.h"
#include "vdb_offset/blocks/zone_mesh.h"

namespace vdb_offset {

/// What a neutral map file (`.nmf`) says of a mesh whose points stand in another file: how its
/// blocks meet, and the types of their boundaries. Names of blocks and families it has none.
struct NeutralMap {
  std::vector<std::array<int, 3>> sizes;     ///< points along i, j, k of each block
  std::vector<Interface> interfaces;         ///< ONE_TO_ONE
  std::vector<BoundaryFace> boundary_faces;  ///< `name` is the type as the file has it
  /// Entries of the type PATCHED, a sentence each: their faces are boundaries of kind Other here.
  std::vector<std::string> faults = {};
};

/// The map of a mesh.
///
/// Types: WALL; Symmetry-X, -Y or -Z where the plane is one of these, else SYMMETRY; POLE_DIR1 or
/// POLE_DIR2 for the direction (first or second of the face) whose points are one, COLLAPSED for
/// both; INFLOW, OUTFLOW, FARFIELD, OVERSET; UNPROCESSED for what has no condition; the BCType of
/// CGNS for others.
NeutralMap neutral_map(const MultiBlock& mesh);

/// Write it, by temporary file and rename. Throws IoError; InputError for a mesh of curves, whose
/// PLOT3D file has no third direction.
void write_neutral_map(const std::filesystem::path& file, const MultiBlock& mesh);
void write_neutral_map(const std::filesystem::path& file, const NeutralMap& map);

/// Read one.
///
/// '#' begins a comment, a backslash at the end of a line goes on in the next, types may be in
/// quotes and in any case, with '-' or '_', ranges may run backward, and TRUE may be .TRUE. or T.
/// Faces of one point along a direction (a line of a block) are read: check_mesh names them.
/// Throws  IoError naming file, line and value: block numbers, faces and indices that there are
///         not, entries that are too short or too long, sizes that do not fit an int.
NeutralMap read_neutral_map(const std::filesystem::path& file);

/// Give a mesh the connectivity of a map. Throws IoError naming both files where sizes differ.
struct NeutralMapFiles {
  std::filesystem::path map;
  std::filesystem::path points;
};
void connect(const NeutralMap& map, const NeutralMapFiles& files, ZoneMesh& mesh);

}  // namespace vdb_offset
