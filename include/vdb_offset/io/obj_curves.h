#pragma once

#include <filesystem>

#include "vdb_offset/surface/patch.h"

namespace vdb_offset {

/// Read plane curves from a Wavefront .obj file: polylines, or the outline of one polygon.
///
/// In       `l` lines, or a single `f`; indices from 1, negative ones from the end, `v/vt/vn`
/// forms;
///          a backslash continues a line. The vertices used lie in one plane z = const, within 1e-9
///          of their extent, and get the z of the first; the units are those of the file.
/// Out      one curve (see Patch) a polyline, in the sense in which it is written; closed if it
/// ends
///          where it begins. Lines of two vertices are chained, within a group, where exactly two
///          of them meet, which closes loops where they close; a chain runs as its first line in
///          the file. The outline of a face is closed and made counter-clockwise: a body. Points
///          that repeat the one before them (within 1e-9 of the extent) are dropped.
/// Names    those of the `o` or `g` line before, also as families; the second curve of a name is
///          "name 2". Without one: "curve 1", no family.
/// Memory   a small multiple of the file's length.
/// Throws   IoError naming file, line and value: an index of no vertex, several faces, faces beside
///          lines, vertices that leave the plane z = const, a curve of one point.
Patches read_obj_curves(const std::filesystem::path& file);

}  // namespace vdb_offset
