#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "vdb_offset/core/vec.h"
#include "vdb_offset/surface/patch.h"

namespace vdb_offset {

/// An `l` or `f` of a file, or a chain of them.
struct ObjElement {
  std::vector<std::size_t> vertices;  ///< from 0
  std::size_t group = 0;              ///< index into ObjFile::groups
  std::size_t line = 0;               ///< in the file
};

struct ObjFile {
  Vec3List vertices;
  std::vector<std::string> groups{""};  ///< names in the order of the file, "" first
  std::vector<ObjElement> lines;
  std::vector<ObjElement> faces;  ///< the first two at most
};

/// Calls `take(words, line)` for every statement: comments gone, lines that a backslash continues
/// put together, `line` that of its beginning.
using ObjStatement = std::function<void(const std::vector<std::string_view>&, std::size_t)>;
void for_obj_lines(std::string_view bytes, const ObjStatement& take);

/// The vertex that "7", "7/2", "7//3" or "-1" means, from 0, when `count` are known; nothing for
/// what means none. Positive ones may be of vertices further on.
std::optional<std::size_t> obj_vertex(std::string_view token, std::size_t count);

/// Parse a file that is in memory; every index is that of a vertex. Throws IoError.
ObjFile parse_obj(std::string_view bytes, const std::string& name);

/// Lines of two vertices put together where exactly two of their group meet; the others as they
/// are. A chain stands in the place of its first line, and runs as that.
std::vector<ObjElement> chained(const std::vector<ObjElement>& lines);

/// read_obj_curves for a file that is in memory.
Patches read_obj_curves_bytes(std::string_view bytes, const std::string& name);

}  // namespace vdb_offset
