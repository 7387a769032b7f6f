#pragma once

#include <cstddef>
#include <optional>
#include <string>

#include "vdb_offset/surface/polygons.h"

namespace vdb_offset {

enum class PolygonFormat { Stl, Obj, Ply, Off };

/// "STL", "OBJ", "PLY" or "OFF".
const char* describe(PolygonFormat format);

/// A file that gzip packed may become so large, in bytes: this part of memory, and this many times
/// its own length.
constexpr std::size_t kUnpackedBase = std::size_t{64} << 20;
constexpr std::size_t kUnpackedTimes = 100;

/// Read a surface of polygons: STL, Wavefront .obj, PLY or OFF, or one of these packed by gzip.
///
/// In       STL ASCII and binary, told by length and zero bytes, not by the word "solid" alone; OBJ
///          faces, indices from 1 or back from -1, `v/vt/vn`, continued lines; PLY ascii and binary
///          of either endianness, elements and properties of other purposes passed over; OFF as
///          text, with normals, colours or texture too, indices from 0, or from 1 where they can
///          mean nothing else (1 and the count are used, 0 is not). The contents tell the format,
///          else the extension (.stl, .obj, .ply, .off, each with .gz too), unless `format` is
///          given.
/// Out      polygons as they stand in the file, of any number of corners, nothing welded and
///          nothing mended (see clean_polygons); units are those of the file.
/// Families of STL its solids; of OBJ the first of objects (`o`), groups (`g`) and materials
///          (`usemtl`) that tells two sets of faces apart, else the first that there is; PLY and
///          OFF have none. Statements of one name are one family.
/// Memory   a small multiple of the file's length, whatever the file counts; a packed file may
///          become kUnpackedBase + kUnpackedTimes * its length.
/// Throws   IoError naming file, line or byte, value and rule: counts that the file is too short
///          for, an index of no point, a point of a face that is not finite (of no face, it is no
///          matter), UTF-16, binary OFF. LimitError for what unpacks to more than the limit, and
///          for more than 2^31 - 1 points.
PolygonMesh read_polygons(const std::string& path, std::optional<PolygonFormat> format = {});

/// The format that the contents tell, else the extension. Throws as read_polygons does.
PolygonFormat detect_polygons(const std::string& path);

/// What an .obj file is made of.
struct ObjContents {
  std::size_t faces = 0;
  std::size_t lines = 0;
  std::size_t free_forms = 0;      ///< curves and surfaces, which are not read
  std::size_t free_form_line = 0;  ///< in the file, of the first of them
};

/// Counts `f`, `l`, `surf` and `curv` statements; a packed file is unpacked. Throws as
/// read_polygons does.
ObjContents inspect_obj(const std::string& path);

}  // namespace vdb_offset
