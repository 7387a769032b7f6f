#pragma once

#include <filesystem>

#include "vdb_offset/blocks/cell_zone.h"
#include "vdb_offset/blocks/multi_block.h"
#include "vdb_offset/blocks/quality.h"
#include "vdb_offset/blocks/zone_mesh.h"

namespace vdb_offset {

/// Write blocks for ParaView: `FILE.vtm` and one `block_<n>.vts` a block in the folder FILE/ beside
/// it (FILE.blocks/ where FILE has no extension), appended raw binary, double points.
///
/// Point data: `height` (true distance of the point's level), `coverage`, `room` (true distance
/// that the column could reach, at most what is asked), `stop` (0 reached, 1 collided, 2 left the
/// band, 3 limited by its neighbours, 4 on an internal surface, 5 ended by the repair), `level`,
/// `node` (column). Cell data: `block`, `layer`, `scaled_jacobian`, and the fields of CellFields by
/// their names.
/// Behind the blocks stands the group "boundaries" with a group for each name (wall families,
/// "outer", boundaries, internal surfaces, "free", "pole") of grids one point thick, named after
/// their blocks, `block_<n>_face_<m>.vts`; their cell data is that of the cells that stand on them.
/// The files appear whole or not at all: pieces first, the `.vtm` last. A folder of pieces that is
/// there already is replaced; one that holds anything else is refused.
/// Throws  IoError naming the file; InputError when `quality` is not of this mesh.
void write_vtm(const std::filesystem::path& file, const MultiBlock& mesh,
               const QualityField& quality);

/// Write all cells as one unstructured grid, `FILE.vtu`, appended raw binary, double points: for
/// blocks of polygons, which `write_vtm` refuses, and for readers of no other. Points that
/// collapsed edges join are one, and their cells prisms or pyramids; data as above. Throws  IoError
/// naming the file; LimitError for more than 2^31 - 1 points or cells; InputError
///         for a cell that has no volume, or when `quality` is not of this mesh.
void write_vtu(const std::filesystem::path& file, const MultiBlock& mesh,
               const QualityField& quality);

/// Read the blocks of a `.vtm` as write_vtm writes it, or one `.vts`: points alone; and boundaries
/// by name. What blocks are to each other see find_interfaces. Data of arrays may be text, base64
/// or raw, and packed by zlib.
/// Throws  IoError naming the file, the value and the rule.
ZoneMesh read_vtm(const std::filesystem::path& file);

/// Read a `.vtu` of anybody, its pieces one after another: cells and points alone, of the linear
/// types. Cells that are faces are one boundary, "faces"; vertices and lines are passed over. The
/// format names no boundaries. Data as above.
/// Throws  IoError naming the file, the array or cell, the value and the rule.
CellZone read_vtu(const std::filesystem::path& file);

/// The folder that the pieces of FILE go into.
/// Throws IoError where `write_vtm` would for what is in the place of FILE or of that folder.
std::filesystem::path vtm_pieces_place(const std::filesystem::path& file);

}  // namespace vdb_offset
