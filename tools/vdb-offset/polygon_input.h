#pragma once

#include <optional>
#include <string>
#include <vector>

#include "vdb_offset/io/polygons.h"
#include "vdb_offset/surface/patch.h"
#include "vdb_offset/surface/polygons.h"

namespace vdb_offset::command {

/// What a surface is read for: a distance can be had of any, layers of manifolds alone.
enum class SurfaceUse { Distance, Layers };

/// The surface in an .obj file; nothing where it is curves: lines, or the outline of one face in a
/// plane z = const. Where there are faces and lines, the faces, and a note.
std::optional<PolygonMesh> read_obj_surface(const std::string& file,
                                            std::vector<std::string>& notes);

/// Cleaned, as patches; notes say what was mended. Throws InputError for what no layers grow on.
Patches patches_of(const PolygonMesh& mesh, SurfaceUse use, std::vector<std::string>& notes);

/// `info` of a file of polygons, as lines or as JSON.
std::string describe_polygons(const PolygonMesh& mesh, PolygonFormat format, bool json);

}  // namespace vdb_offset::command
