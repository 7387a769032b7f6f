#pragma once

#include <array>
#include <filesystem>
#include <string>
#include <vector>

#include "vdb_offset/blocks/multi_block.h"
#include "vdb_offset/surface/surface.h"

namespace vdb_offset {

/// What blocks are bounded by, and the geometry that it stands on, as one document.
///
/// Geometry: `points`, each place once; `curves`, polylines of points; `surfaces`, grids of points.
/// Topology: a vertex stands on a point, an edge along a curve between two vertices, a face has a
/// loop of edges, a block has faces on each of its six sides. All numbers are from 0.
///
/// Edges come in three kinds: on the wall, the same on the outermost level, and columns from a
/// vertex of the one to that of the other. Faces too: a patch of the wall, the same on the
/// outermost level, and sides, which stand on an edge of the wall: one block has them, or the two
/// that an interface joins.
///
/// As JSON (write_topology), a record a line:
///
///     {"format": "vdb-offset topology", "version": 1, "flat": false,
///      "points": [[x, y, z] ...],                     doubles, to the bit; world units
///      "curves": [[point ...] ...],
///      "surfaces": [{"name", "family", "role": "wall" | "boundary" | "internal", "boundary": name
///                    of the boundary that it is part of, "ni", "nj", "points": [ni * nj, i
///                    fastest], "body": where it is not 0, "faces": [[3 or 4 of its points] ...] of
///                    polygons alone} ...],
///      "planes": [{"name", "given": by name, else found, "point", "normal",
///                  "rest": true where it names all that no other of the same plane does} ...],
///      "vertices": [point ...],
///      "edges": [{"kind": "wall" | "outer" | "column", "curve", "vertices": [2],
///                 "degenerate": all of it is one node} ...],
///      "faces": [{"kind": "wall" | "outer" | "side", "surface": that it is, or a piece of; -1,
///                 "interface": -1 or, "boundary_face": what it is (where parts of an outer face
///                 end on internal surfaces: the first of its parts, which follow one another),
///                 "edges": [[edge, 1 along it or -1 against] ...] around, counter-clockwise seen
///                 along the patch's normal} ...],
///      "blocks": [{"name", "family", "ni", "nj", "nk", "faces": {"imin": [face ...], "imax",
///                  "jmin", "jmax", "kmin": the wall's, "kmax": the outermost level's}} ...],
///      "interfaces": [{"name", "first": range, "second": range, "transform": as Interface} ...],
///      "boundary_faces": [{"kind", "name", "condition", "cgns_type", "range"} ...]}
///
/// with ranges {"block", "face": "imin" ..., "begin": [i, j, k], "end": [i, j, k]}, of nodes.
struct TopologyDocument {
  enum class Role { Wall, Boundary, Internal };
  enum class EdgeKind { Wall, Outer, Column };
  enum class FaceKind { Wall, Outer, Side };

  /// A patch as the surface was given, scaled: before it was turned round, split or moved onto
  /// boundaries. A wall without layers is among them.
  struct Grid {
    std::string name = {}, family = {};
    Role role = Role::Wall;
    std::string boundary = {};  ///< Boundary, Internal: the boundary surface's name
    int body = 0;               ///< as Patch
    int ni = 0, nj = 0;
    std::vector<int> points = {};
    std::vector<std::array<int, 4>> faces = {};  ///< as Patch
    bool operator==(const Grid&) const = default;
  };
  struct BoundaryPlane {
    std::string name;
    bool given = false;
    Vec3 point_world = Vec3::Zero();
    Vec3 normal = Vec3::UnitX();
    bool rest = false;  ///< as NamedPlane
    bool operator==(const BoundaryPlane&) const = default;
  };
  struct Edge {
    EdgeKind kind = EdgeKind::Wall;
    int curve = -1;
    std::array<int, 2> vertices{-1, -1};
    bool degenerate = false;
    bool operator==(const Edge&) const = default;
  };
  struct EdgeUse {
    int edge = -1;
    bool reversed = false;
    bool operator==(const EdgeUse&) const = default;
  };
  struct Face {
    FaceKind kind = FaceKind::Wall;
    int surface = -1;  ///< -1: none, of fans and of all that is not the wall
    int interface = -1;
    int boundary_face = -1;  ///< one of these two; the first of those that an outer face is
    std::vector<EdgeUse> edges = {};
    bool operator==(const Face&) const = default;
  };
  struct Block {
    std::string name, family;
    int ni = 0, nj = 0, nk = 0;
    std::array<std::vector<int>, 6> faces = {};  ///< by BlockFace
    bool operator==(const Block&) const = default;
  };

  bool flat = false;  ///< of curves
  Vec3List points_world;
  std::vector<std::vector<int>> curves;
  std::vector<Grid> surfaces;
  std::vector<BoundaryPlane> planes;
  std::vector<int> vertices;  ///< points
  std::vector<Edge> edges;
  std::vector<Face> faces;
  std::vector<Block> blocks;
  std::vector<Interface> interfaces;
  std::vector<BoundaryFace> boundary_faces;

  bool operator==(const TopologyDocument&) const = default;
};

/// What a surface is made from: the patches, and the boundaries that were named.
struct GivenSurface {
  Patches patches;
  SurfaceOptions options;  ///< scale, planes, shapes and internals
};

/// In      given: from which `surface` was built, and of that `mesh`.
/// Throws  InputError if `mesh` is not of this surface, or that is of polygons.
TopologyDocument topology_document(const GivenSurface& given, const Surface& surface,
                                   const MultiBlock& mesh);

/// Its walls as patches, and its boundaries that were given by name into `options`, but for those
/// that have a name that `options` names too. Meshed with the same options they give the same
/// blocks, bit for bit.
Patches patches_of(const TopologyDocument& document, SurfaceOptions& options);

/// By temporary file and rename. Names that are not UTF-8 lose what is not. Throws IoError.
void write_topology(const std::filesystem::path& file, const TopologyDocument& document);

/// What write_topology wrote, and nothing else: an equal document.
/// Throws  IoError naming the file, the place (a JSON pointer), the value and the rule: indices of
///         what there is not, sizes that do not fit, loops that do not close, numbers that are not
///         finite, JSON that is none or nests deeper than such a document does.
TopologyDocument read_topology(const std::filesystem::path& file);

}  // namespace vdb_offset
