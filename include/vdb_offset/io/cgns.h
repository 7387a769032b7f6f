#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "vdb_offset/blocks/cell_zone.h"
#include "vdb_offset/blocks/multi_block.h"
#include "vdb_offset/blocks/zone_mesh.h"
#include "vdb_offset/surface/patch.h"

namespace vdb_offset {

/// Names of CGNS have so many bytes at most; longer ones are cut, and numbered where two are equal.
inline constexpr std::size_t kCgnsName = 32;

struct CgnsWriteOptions {
  /// "Meter", "Centimeter", "Millimeter", "Foot" or "Inch" (any case); empty: unknown, and the file
  /// says so.
  std::string length_unit = {};
};

/// Write blocks: one base, a zone a block, HDF5.
///
/// Every interface is a GridConnectivity1to1_t in both of its zones; every boundary face a BC_t of
/// its condition, named as it is, whose FamilyName is a Family_t with that condition as FamilyBC_t.
/// Overset faces are BCs of the user's own type with the UserDefinedData_t "BCOverset". Degenerate
/// faces have no family. A place on a zone's surface is in exactly one of them, as in the mesh.
/// With blocks of polygons all is one unstructured zone: a section for each kind of cell of a block
/// (PENTA_6, HEXA_8; TETRA_4 and PYRA_5 where edges are collapsed), and the boundary faces as
/// TRI_3 and QUAD_4, on which BCs lie by their numbers.
/// By temporary file and rename.
/// Cost    memory: 24 bytes for each of at most kCgnsSlab points (or one row of i).
/// Throws  IoError naming the file: also before anything is written for a block beyond 2^31 - 1
///         points (32-bit libcgns); InputError for a unit that is none.
void write_cgns(const std::filesystem::path& file, const MultiBlock& mesh,
                const CgnsWriteOptions& options = {});

/// Write a surface: a base of cell dimension 2, a zone a patch, families as FamilyName of zones.
/// Throws as above, and InputError for curves.
void write_cgns(const std::filesystem::path& file, const Patches& patches,
                const CgnsWriteOptions& options = {});

inline constexpr std::size_t kCgnsSlab = std::size_t{1} << 20U;

struct CgnsZoneInfo {
  std::string name;
  std::string family;
  std::int64_t ni = 0, nj = 0, nk = 1;  ///< of an unstructured zone ni is the number of points
  int interfaces = 0;                   ///< connectivity nodes
  int boundaries = 0;                   ///< BC_t nodes
  bool is_structured = true;
  std::int64_t cells = 0;  ///< of an unstructured zone, as it says
};

struct CgnsFamilyInfo {
  std::string name;
  std::string type;  ///< of its FamilyBC_t; empty: none
};

/// What is in a file: what `info` prints.
struct CgnsInfo {
  std::string container;  ///< "HDF5" or "ADF"
  double version = 0;
  int bases = 0;  ///< only the first is read
  std::string base;
  int cell_dimension = 0;
  int physical_dimension = 0;
  std::string length_unit;  ///< as written: "Meter"; empty: unknown
  std::vector<CgnsZoneInfo> zones;
  std::vector<CgnsFamilyInfo> families;

  bool is_unstructured() const;  ///< all zones
  /// Whether the zones are surfaces (structured, of cell dimension 2, or one index of 1 each).
  bool is_surface() const;
};

/// Throws IoError as `read_cgns`.
CgnsInfo inspect_cgns(const std::filesystem::path& file);

/// Read a surface from the first base of a CGNS file, ADF or HDF5.
///
/// Structured zones of cell dimension 2, or of 3 with one index of 1, become patches of the other
/// two, the earlier as i; the family is the zone's, or that of a BC that covers all of it. Of
/// volume zones those faces become patches whose BC is a wall, or of a family that is one; normals
/// point into the volume, and the family is the BC's, or its name. Other zones, and a volume
/// without walls, are refused. Coordinates CoordinateX, Y, Z in single or double precision; without
/// Z it is 0. Units as in the file (see CgnsInfo::length_unit).
/// Cost    sizes are checked against the file's length before anything is allocated.
/// Throws  IoError naming file, zone and node: no CGNS file, or one of a newer HDF5 than the
///         library reads; sizes that do not fit; unstructured zones; values that are not finite.
Patches read_cgns(const std::filesystem::path& file);

/// Read a volume mesh from the first base: zones, interfaces (1-to-1, once each), boundary faces.
///
/// Kinds of boundary faces follow their conditions: walls Wall, farfield and overset Outer,
/// degenerate Degenerate, all others Boundary. What does not fit (ranges off a face, donors that do
/// not exist, an interface in one zone alone, connectivity of other types, BCs as lists of points)
/// goes into `faults`.
/// Throws  IoError as read_cgns, and for a surface.
ZoneMesh read_cgns_mesh(const std::filesystem::path& file);

/// Read a volume mesh of unstructured zones from the first base, one zone behind the other.
///
/// Sections of TETRA_4, PYRA_5, PENTA_6, HEXA_8, and of these MIXED with faces, are cells; TRI_3
/// and QUAD_4 are the faces that BCs lie on, by the numbers of elements (PointRange or PointList
/// at FaceCenter, ElementRange, ElementList). A boundary has its family's name, or the BC's, and
/// the type of either. What does not fit (BCs of points, or of elements that are no faces;
/// connectivity between zones; a number of cells that the zone does not have) goes into `faults`.
/// Throws  IoError as read_cgns, and for elements of other types: NGON_n, NFACE_n, those of
///         higher order; ranges that do not fit the connectivity; points that there are not.
CellZone read_cgns_cells(const std::filesystem::path& file);

}  // namespace vdb_offset
