#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "vdb_offset/io/polygons.h"
#include "vdb_offset/surface/clean_polygons.h"
#include "vdb_offset/surface/patch.h"
#include "vdb_offset/surface/polygons.h"
#include "vdb_offset/surface/surface_options.h"

namespace vdb_offset::command {

/// What a surface is read for: a distance can be had of any, layers of manifolds alone.
enum class SurfaceUse { Distance, Layers };

/// What becomes of polygons that layers grow on.
enum class PolygonRule {
  Auto,    ///< structured blocks of quads alone, columns of others
  Blocks,  ///< structured blocks; anything but quads is an error
  Columns
};

/// How a field tells the sides of a surface.
enum class SignRule { Auto, Closed, Winding, Unsigned };

/// How polygons are read.
struct PolygonUse {
  SurfaceUse use = SurfaceUse::Layers;
  PolygonRule rule = PolygonRule::Auto;
  double weld = CleanOptions().weld;
  /// Out: whether normals cannot tell sides, and of all that was read faces and edges of one face.
  bool is_soup = false;
  std::size_t faces = 0;
  std::size_t open_edges = 0;
  /// Out: of each patch the numbers of its faces, counted on over files in their order; and where
  /// those of the next file begin.
  std::vector<std::vector<int>> face_numbers = {};
  int next_number = 0;
  /// Out: whether all that was read are the polygons of one file, or of files without open edges:
  /// nothing is left that another welding should join.
  bool is_all_welded = false;
  /// Out: farthest that welding moved a point, before any scale, and from where to where.
  double moved_max_world = 0;
  std::array<Vec3, 2> moved_farthest_world{Vec3::Zero(), Vec3::Zero()};
  /// In and out: the unit that lengths of CAD files become, as CGNS calls it; empty: that of the
  /// first CAD file with one. Out: whether a file says none.
  std::string length_unit = {};
  bool lacks_unit = false;
  /// Out: what was left out, that may have been meant.
  std::vector<std::string> warnings = {};
};

/// The rule of a field of what was read, with a note on why where that is chosen here.
/// Throws InputError for `closed` where normals cannot tell sides.
SideRule side_rule(SignRule sign, const PolygonUse& read, std::vector<std::string>& notes);

/// The surface in an .obj file; nothing where it is curves: lines, or the outline of one face in a
/// plane z = const. Where there are faces and lines, the faces, and a note. Free forms are warned
/// of; IoError where there is nothing else.
std::optional<PolygonMesh> read_obj_surface(const std::string& file,
                                            std::vector<std::string>& notes,
                                            std::vector<std::string>& warnings);

/// Cleaned, as patches; notes say what was mended and made. Throws InputError for what no layers
/// grow on.
Patches patches_of(const PolygonMesh& mesh, PolygonUse& use, std::vector<std::string>& notes);

/// `info` of a file of polygons, as lines or as JSON.
std::string describe_polygons(const PolygonMesh& mesh, PolygonFormat format, bool json);

}  // namespace vdb_offset::command
