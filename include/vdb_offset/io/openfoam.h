#pragma once

#include <filesystem>

#include "vdb_offset/blocks/cell_zone.h"
#include "vdb_offset/blocks/multi_block.h"

namespace vdb_offset {

/// Write blocks as an OpenFOAM case: `constant/polyMesh`, and of `system` what is not there yet
/// (`controlDict`, `fvSchemes`, `fvSolution`: as little as OpenFOAM starts with).
///
/// In      file: the folder of the case, which is made where it is missing; or `FOLDER/NAME.foam`,
///         the file by which ParaView opens the case FOLDER: it is written too, empty.
/// Out     points once, each double to the bit; where edges are collapsed cells are prisms, or of
///         the shape that is left. Internal faces in upper-triangular order, then the patches, each
///         of one name and condition: names as they are, but for characters that OpenFOAM does not
///         take in a word, which become '_'. Types: `wall` for viscous walls, `symmetryPlane` for
///         symmetry that is flat to rounding, else `symmetry`, `empty` for the two planes that a
///         flat mesh lies between, `patch` for all else, with the condition as `physicalType`
///         ("overset" too: OpenFOAM's own type of that name needs a library of its own).
///         Text, labels below 2^31.
/// The polyMesh appears whole or not at all. One that is there already is replaced, with the sets
/// that checkMesh left in it, but refused if it holds anything else (zones, sets of one's own):
/// that would be of another mesh. Cost    memory: 4 bytes a point. Throws  IoError naming the file;
/// LimitError beyond 2^31 - 1 points or faces; InputError for a
///         cell that has collapsed to nothing.
void write_openfoam(const std::filesystem::path& file, const MultiBlock& mesh);

/// Read the polyMesh of a case, of anybody, in text.
///
/// In      file: the folder of a case, its `NAME.foam`, or the polyMesh folder.
/// Out     cells from their faces: those that have the faces of a tetrahedron, pyramid, prism or
///         hexahedron are such, others polyhedra; patches with their types. Cells whose faces do
///         not close are named in `faults`.
/// Throws  IoError naming file, line and value: binary and compressed files, counts that do not
///         fit, labels of what there is not, numbers that are not finite.
CellZone read_openfoam(const std::filesystem::path& file);

/// The polyMesh folder that `file` means.
/// Throws IoError where `write_openfoam` would for what is in its place.
std::filesystem::path openfoam_place(const std::filesystem::path& file);

}  // namespace vdb_offset
