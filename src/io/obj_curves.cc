#include "vdb_offset/io/obj_curves.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <limits>
#include <map>
#include <utility>

#include "io/curve_points.h"
#include "io/obj_parse.h"
#include "io/polygon_parse.h"
#include "vdb_offset/core/error.h"

namespace vdb_offset {
namespace {

IoError error_at(const std::string& name, std::size_t line, std::string_view what,
                 std::string_view advice) {
  return IoError(fmt::format("{}, line {}: {}; {}", name, line, what, advice),
                 {static_cast<std::int64_t>(line)});
}

/// The vertices that elements use.
Box extent_of(const ObjFile& file) {
  Box box;
  for (const auto* elements : {&file.lines, &file.faces}) {
    for (const ObjElement& element : *elements) {
      for (const std::size_t vertex : element.vertices) box.add(file.vertices[vertex]);
    }
  }
  return box;
}

constexpr double kFlat = 1e-9;  // of the extent

void check_plane(const std::string& name, const Box& box) {
  const Vec3 sides = box.hi - box.lo;
  const double flat = kFlat * box.size();
  if (sides.z() <= flat) return;
  const int other = sides.x() <= flat ? 0 : sides.y() <= flat ? 1 : 2;
  const std::string where =
      other == 2 ? fmt::format("z goes from {} to {}", box.lo.z(), box.hi.z())
                 : fmt::format("its vertices lie in the plane {} = {}", "xy"[other], box.lo[other]);
  throw IoError(fmt::format(
      "{}: {}, and curves lie in a plane z = const; {}", name, where,
      other == 2 ? "project it, or give a structured surface as PLOT3D" : "exchange its axes"));
}

void check_kind(const std::string& name, const ObjFile& file) {
  if (file.faces.size() > 1) {
    throw error_at(name, file.faces[1].line, "a second face ('f')",
                   "only curves are read from .obj files: polylines ('l'), or the outline of one "
                   "face; a surface goes into a PLOT3D file");
  }
  if (!file.faces.empty() && !file.lines.empty()) {
    throw error_at(name, file.faces[0].line, "a face ('f') in a file that has lines ('l') too",
                   "give the body's outline a file of its own");
  }
  if (file.faces.empty() && file.lines.empty()) {
    throw IoError(name + ": holds no line ('l') and no face ('f'); curves are made of these");
  }
}

Vec3List points_of(const ObjFile& file, const ObjElement& element, double z) {
  Vec3List points;
  points.reserve(element.vertices.size() + 1);
  for (const std::size_t vertex : element.vertices) {
    points.push_back(file.vertices[vertex]);
    points.back().z() = z;
  }
  return points;
}

/// The closed curve round a face, counter-clockwise.
Vec3List outline(const std::string& name, const ObjElement& face, Vec3List points, double size) {
  points.push_back(points.front());
  drop_repeats(points, size);
  const double area = enclosed_area(points);
  if (points.size() < 4 || !(std::abs(area) > kFlat * size * size)) {
    throw error_at(name, face.line, "the face encloses no area",
                   "a body's outline needs three points at least, round it");
  }
  if (area < 0) std::reverse(points.begin(), points.end());
  return points;
}

Vec3List polyline(const std::string& name, const ObjElement& line, Vec3List points, double size) {
  drop_repeats(points, size);
  // A polyline that ends within the tolerance of its beginning is closed.
  if (points.size() > 3 && (points.front() - points.back()).norm() <= kFlat * size) {
    points.back() = points.front();
  }
  if (points.size() < 2) {
    throw error_at(name, line.line, "a polyline of one point, repeated",
                   "a curve has two points at least");
  }
  return points;
}

/// Names from groups, each once.
class Namer {
 public:
  std::string name(const std::string& group) {
    ++curves_;
    if (group.empty()) return fresh(fmt::format("curve {}", curves_));
    return fresh(group);
  }

 private:
  std::string fresh(const std::string& wanted) {
    std::string name = wanted;
    while (!taken_.emplace(name, 1).second) name = fmt::format("{} {}", wanted, ++taken_[wanted]);
    return name;
  }

  int curves_ = 0;
  std::map<std::string, int> taken_;
};

}  // namespace

Patches read_obj_curves_bytes(std::string_view bytes, const std::string& name) {
  const ObjFile file = parse_obj(bytes, name);
  check_kind(name, file);
  const Box box = extent_of(file);
  check_plane(name, box);
  const bool is_face = !file.faces.empty();
  const std::vector<ObjElement> elements = is_face ? file.faces : chained(file.lines);
  const double z = file.vertices[elements[0].vertices[0]].z();
  Patches patches;
  Namer namer;
  for (const ObjElement& element : elements) {
    Vec3List points = points_of(file, element, z);
    points = is_face ? outline(name, element, std::move(points), box.size())
                     : polyline(name, element, std::move(points), box.size());
    if (points.size() > static_cast<std::size_t>(std::numeric_limits<int>::max())) {
      throw error_at(name, element.line, fmt::format("a curve of {} points", points.size()),
                     "a curve may have 2^31 - 1");
    }
    const std::string& group = file.groups[element.group];
    const int count = static_cast<int>(points.size());
    patches.push_back({namer.name(group), group, count, 1, std::move(points), name});
  }
  return patches;
}

Patches read_obj_curves(const std::filesystem::path& file) {
  return read_obj_curves_bytes(unpacked_contents_of(file.string(), "an .obj file"), file.string());
}

}  // namespace vdb_offset
