#include "vdb_offset/io/polygons.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <limits>

#include "io/gzip.h"
#include "io/input_file.h"
#include "io/obj_parse.h"
#include "io/polygon_parse.h"

namespace vdb_offset {
namespace {

constexpr const char* kKind = "an STL, OBJ, PLY or OFF file";

std::size_t unpacked_limit(std::size_t packed) { return kUnpackedBase + kUnpackedTimes * packed; }

/// By the extension, that of gzip taken off.
PolygonFormat format_of_name(const std::string& name) {
  std::string low = name;
  for (char& c : low) c = c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
  std::filesystem::path file = low;
  if (file.extension() == ".gz") file = file.stem();
  const std::string extension = file.extension().string();
  if (extension == ".stl") return PolygonFormat::Stl;
  if (extension == ".obj") return PolygonFormat::Obj;
  if (extension == ".ply") return PolygonFormat::Ply;
  if (extension == ".off") return PolygonFormat::Off;
  throw IoError(name +
                ": is none of STL, OBJ, PLY and OFF by its contents or its name; say which "
                "it is");
}

void refuse_utf16(const PolygonText& text) {
  const std::string_view start = text.bytes.substr(0, 4);
  if (start.size() < 2) return;
  const bool marked = start.substr(0, 2) == "\xFF\xFE" || start.substr(0, 2) == "\xFE\xFF";
  // A letter and a zero byte, twice; no binary format begins that way.
  const auto zero = [&](std::size_t n) { return start[n] == '\0'; };
  const bool bare =
      start.size() == 4 && zero(0) != zero(1) && zero(0) == zero(2) && zero(1) == zero(3);
  if (!marked && !bare) return;
  throw IoError(text.name + ": is text in UTF-16; convert it to UTF-8, with iconv say");
}

PolygonMesh parse(const PolygonText& text, PolygonFormat format) {
  switch (format) {
    case PolygonFormat::Stl:
      return parse_stl(text);
    case PolygonFormat::Obj:
      return parse_obj_faces(text);
    case PolygonFormat::Ply:
      return parse_ply(text);
    case PolygonFormat::Off:
      break;
  }
  return parse_off(text);
}

}  // namespace

const char* describe(PolygonFormat format) {
  constexpr std::array<const char*, 4> kNames{"STL", "OBJ", "PLY", "OFF"};
  return kNames[static_cast<std::size_t>(format)];
}

IoError PolygonText::at_line(std::size_t line, std::string_view what,
                             std::string_view advice) const {
  return IoError(fmt::format("{}, line {}: {}; {}", name, line, what, advice),
                 {static_cast<std::int64_t>(line)});
}

IoError PolygonText::at_byte(std::size_t byte, std::string_view what,
                             std::string_view advice) const {
  return IoError(fmt::format("{}, byte {}: {}; {}", name, byte, what, advice),
                 {static_cast<std::int64_t>(byte)});
}

int NameList::index_of(std::string_view name) {
  const auto found = indices_.find(name);
  if (found != indices_.end()) return found->second;
  const int index = static_cast<int>(names_.size());
  indices_.emplace(name, index);
  names_.emplace_back(name);
  return index;
}

PolygonBuilder::PolygonBuilder(const std::string& name, const char* unit) : unit_(unit) {
  mesh_.file = name;
}

int PolygonBuilder::add_point(const Vec3& point, std::size_t place) {
  constexpr double kLargest = 1e100;
  const std::size_t index = mesh_.points_world.size();
  if (index >= static_cast<std::size_t>(std::numeric_limits<int>::max())) {
    throw LimitError(mesh_.file + ": holds more than 2^31 - 1 points; split it");
  }
  if (!(point.cwiseAbs().maxCoeff() <= kLargest) || !point.allFinite()) {
    bad_.emplace_back(static_cast<int>(index), place);
  }
  mesh_.points_world.push_back(point);
  return static_cast<int>(index);
}

void PolygonBuilder::set_families(const NameList& names, std::vector<int> of_faces) {
  if (names.names().size() == 1 && names.names().front().empty()) return;
  mesh_.families = names.names();
  mesh_.family = std::move(of_faces);
}

void PolygonBuilder::reserve(std::size_t points, std::size_t faces) {
  mesh_.points_world.reserve(points);
  mesh_.first.reserve(faces + 1);
  mesh_.corners.reserve(3 * faces);
}

void PolygonBuilder::count_from_one() {
  for (int& corner : mesh_.corners) --corner;
  mesh_.counted_from_one = true;
}

PolygonMesh PolygonBuilder::finish() {
  if (mesh_.faces() == 0) {
    throw IoError(mesh_.file + ": holds no face; a surface is made of triangles or polygons");
  }
  if (bad_.empty()) return std::move(mesh_);
  std::vector<bool> is_bad(mesh_.points_world.size(), false);
  for (const auto& [point, place] : bad_) is_bad[static_cast<std::size_t>(point)] = true;
  for (std::size_t f = 0; f < mesh_.faces(); ++f) {
    for (const int point : mesh_.face(f)) {
      if (!is_bad[static_cast<std::size_t>(point)]) continue;
      const auto found = std::lower_bound(bad_.begin(), bad_.end(), std::pair(point, 0UL));
      const Vec3& p = mesh_.points_world[static_cast<std::size_t>(point)];
      throw IoError(
          fmt::format("{}, {} {}: the point ({}, {}, {}), which face {} uses, is not three finite "
                      "numbers; mend the point, or remove its faces",
                      mesh_.file, unit_, found->second, p.x(), p.y(), p.z(), f + 1),
          {static_cast<std::int64_t>(found->second)});
    }
  }
  return std::move(mesh_);
}

std::optional<PolygonFormat> polygon_format_of(std::string_view bytes) {
  // First STL: the header of a binary one may say anything, and its length then tells.
  if (is_stl(bytes)) return PolygonFormat::Stl;
  if (bytes.substr(0, 3) == "ply" && bytes.size() > 3 && (bytes[3] == '\n' || bytes[3] == '\r')) {
    return PolygonFormat::Ply;
  }
  if (is_off(bytes)) return PolygonFormat::Off;
  return {};
}

PolygonMesh read_polygons_bytes(const PolygonText& text, std::optional<PolygonFormat> format) {
  if (is_gzip(text.bytes)) {
    const std::string bytes = unpacked(text.bytes, text.name, unpacked_limit(text.bytes.size()));
    if (is_gzip(bytes)) throw IoError(text.name + ": is packed twice; unpack it once");
    return read_polygons_bytes({bytes, text.name}, format);
  }
  if (text.bytes.empty()) throw IoError(text.name + ": is empty; check how it was written");
  const std::optional<PolygonFormat> told = polygon_format_of(text.bytes);
  if (!told) refuse_utf16(text);
  if (!format) format = told;
  if (!format) format = format_of_name(text.name);
  return parse(text, *format);
}

PolygonMesh read_polygons(const std::string& path, std::optional<PolygonFormat> format) {
  return read_polygons_bytes({contents_of(path, kKind), path}, format);
}

std::string unpacked_contents_of(const std::string& file, std::string_view kind) {
  std::string bytes = contents_of(file, kind);
  if (!is_gzip(bytes)) return bytes;
  return unpacked(bytes, file, unpacked_limit(bytes.size()));
}

PolygonFormat detect_polygons(const std::string& path) {
  const std::string bytes = unpacked_contents_of(path, kKind);
  const auto told = polygon_format_of(bytes);
  return told ? *told : format_of_name(path);
}

ObjContents inspect_obj(const std::string& path) {
  const std::string bytes = unpacked_contents_of(path, kKind);
  refuse_utf16({bytes, path});
  ObjContents contents;
  for_obj_lines(bytes, [&](const std::vector<std::string_view>& tokens, std::size_t line) {
    contents.faces += tokens[0] == "f";
    contents.lines += tokens[0] == "l";
    if (tokens[0] != "surf" && tokens[0] != "curv") return;
    if (contents.free_forms++ == 0) contents.free_form_line = line;
  });
  return contents;
}

}  // namespace vdb_offset
