#pragma once

#include <cstddef>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "vdb_offset/core/error.h"
#include "vdb_offset/io/polygons.h"

namespace vdb_offset {

/// A file of polygons in memory, with the name that messages call it by.
struct PolygonText {
  std::string_view bytes;
  const std::string& name;

  /// "FILE, line N: WHAT; ADVICE"
  IoError at_line(std::size_t line, std::string_view what, std::string_view advice) const;
  /// "FILE, byte N: WHAT; ADVICE"
  IoError at_byte(std::size_t byte, std::string_view what, std::string_view advice) const;
};

/// Names, each once, in the order in which they come.
class NameList {
 public:
  /// Of `name`, which is added if it is new.
  int index_of(std::string_view name);
  const std::vector<std::string>& names() const { return names_; }

 private:
  std::vector<std::string> names_;
  std::map<std::string, int, std::less<>> indices_;
};

/// Polygons while they are read.
class PolygonBuilder {
 public:
  /// `unit` is what places count: "line" or "byte".
  PolygonBuilder(const std::string& name, const char* unit);

  /// `place` is where the point stands in the file, for the case that a face uses it and it is not
  /// finite or beyond 1e100, where squares overflow. Throws LimitError for too many.
  int add_point(const Vec3& point, std::size_t place);
  void add_face(const std::vector<int>& points) { mesh_.add(points); }
  /// Of all faces; one family without a name is none.
  void set_families(const NameList& names, std::vector<int> of_faces);

  std::size_t points() const { return mesh_.points_world.size(); }
  std::size_t faces() const { return mesh_.faces(); }
  void reserve(std::size_t points, std::size_t faces);
  /// Take 1 from each corner.
  void count_from_one();
  /// What was read. Throws IoError where a face uses a bad point, or if there is no face.
  PolygonMesh finish();

 private:
  PolygonMesh mesh_;
  const char* unit_;
  std::vector<std::pair<int, std::size_t>> bad_;  // points, and their places
};

// Each reads a file that is in memory, and throws IoError as read_polygons does.
PolygonMesh parse_stl(const PolygonText& text);
PolygonMesh parse_obj_faces(const PolygonText& text);
PolygonMesh parse_ply(const PolygonText& text);
PolygonMesh parse_off(const PolygonText& text);

/// What the bytes say that they are.
std::optional<PolygonFormat> polygon_format_of(std::string_view bytes);
bool is_stl(std::string_view bytes);
bool is_off(std::string_view bytes);

/// The whole file in memory, unpacked if gzip packed it.
std::string unpacked_contents_of(const std::string& file, std::string_view kind);

/// read_polygons for a file that is in memory; `bytes` may be packed.
PolygonMesh read_polygons_bytes(const PolygonText& text, std::optional<PolygonFormat> format);

}  // namespace vdb_offset
