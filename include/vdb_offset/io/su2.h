#pragma once

#include <cstdint>
#include <filesystem>

#include "vdb_offset/blocks/cell_zone.h"
#include "vdb_offset/blocks/multi_block.h"

namespace vdb_offset {

/// Write blocks as a native SU2 mesh (`.su2`), by temporary file and rename.
///
/// Points once, each double to the bit. Cells are hexahedra (12), and where edges are collapsed
/// prisms (13), pyramids (14) or tetrahedra (10). Cells of five or seven corners that are none of
/// these, which fans have where they close and columns that end at the wall, are parted into
/// pyramids and tetrahedra about a point in their middle, chosen so that these are positive; these
/// points stand behind all others. A marker for each name and condition of
/// boundary faces: names as they are, but for characters other than letters, digits, '_', '-' and
/// '.', which become '_'.
/// A flat mesh has NDIME = 2: quadrilaterals (9) and triangles (5), x and y alone, lines as
/// markers.
/// Returns how many cells could not be parted so, for no point within sees all their faces.
/// Cost    memory: 4 bytes a point.
/// Throws  IoError naming the file; LimitError beyond 2^31 - 1 points or cells; InputError for a
///         cell that has collapsed to nothing.
std::int64_t write_su2(const std::filesystem::path& file, const MultiBlock& mesh);

/// Read one, of anybody: NDIME, NELEM, NPOIN and NMARK in any order, '%' begins a comment, a number
/// behind an element or a point is passed over.
///
/// Of two dimensions it is made one cell thick, from z = 0 as far as it is wide, between the
/// boundaries "front" and "back". A marker of the halo (SEND_RECEIVE) is left out.
/// Throws  IoError naming file, line and value: elements that are none of a volume mesh's, indices
///         of points that there are not, lists that end early, more than one zone, numbers that are
///         not finite.
CellZone read_su2(const std::filesystem::path& file);

}  // namespace vdb_offset
