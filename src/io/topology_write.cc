// By hand, a record a line: a document of numbers in a tree of objects would take many times its
// own size.

#include <fmt/format.h>

#include <cmath>
#include <iterator>
#include <nlohmann/json.hpp>
#include <ostream>
#include <string>
#include <utility>

#include "io/output_file.h"
#include "io/topology_words.h"

namespace vdb_offset {
namespace {

namespace words = topology_words;
using Document = TopologyDocument;

std::string text(const std::string& name) {
  using nlohmann::json;
  return json(name).dump(-1, ' ', false, json::error_handler_t::replace);
}

/// The shortest that brings back the double; "-0" would come back as a whole number, without its
/// sign.
std::string number(double value) {
  return value == 0 && std::signbit(value) ? "-0.0" : fmt::format("{}", value);
}

std::string vector(const Vec3& p) {
  return fmt::format("[{}, {}, {}]", number(p.x()), number(p.y()), number(p.z()));
}

template <typename Numbers>
std::string list(const Numbers& numbers) {
  return fmt::format("[{}]", fmt::join(numbers, ", "));
}

template <typename Words, typename Value>
std::string_view word(const Words& all, Value value) {
  return all[static_cast<std::size_t>(value)];
}

std::string range(const BlockRange& r) {
  return fmt::format(R"({{"block": {}, "face": "{}", "begin": {}, "end": {}}})", r.block,
                     word(words::kSides, r.face), list(r.begin), list(r.end));
}

std::string record(const Vec3& p) { return vector(p); }
std::string record(int number) { return fmt::format("{}", number); }
std::string record(const std::vector<int>& numbers) { return list(numbers); }

std::string record(const Document::Grid& grid) {
  std::string faces;
  for (const std::array<int, 4>& f : grid.faces) {
    if (!faces.empty()) faces += ", ";
    faces += f[3] < 0 ? fmt::format("[{}, {}, {}]", f[0], f[1], f[2]) : list(f);
  }
  return fmt::format(
      R"({{"name": {}, "family": {}, "role": "{}", "boundary": {}, "ni": {}, "nj": {}, )"
      R"("points": {}{}{}}})",
      text(grid.name), text(grid.family), word(words::kRoles, grid.role), text(grid.boundary),
      grid.ni, grid.nj, list(grid.points),
      grid.body == 0 ? "" : fmt::format(R"(, "body": {})", grid.body),
      grid.faces.empty() ? "" : fmt::format(R"(, "faces": [{}])", faces));
}

std::string record(const Document::BoundaryPlane& plane) {
  return fmt::format(R"({{"name": {}, "given": {}, "point": {}, "normal": {}{}}})",
                     text(plane.name), plane.given, vector(plane.point_world), vector(plane.normal),
                     plane.rest ? R"(, "rest": true)" : "");
}

std::string record(const Document::Edge& edge) {
  return fmt::format(R"({{"kind": "{}", "curve": {}, "vertices": {}, "degenerate": {}}})",
                     word(words::kEdges, edge.kind), edge.curve, list(edge.vertices),
                     edge.degenerate);
}

std::string record(const Document::Face& face) {
  std::string loop;
  for (const Document::EdgeUse& use : face.edges) {
    if (!loop.empty()) loop += ", ";
    loop += fmt::format("[{}, {}]", use.edge, use.reversed ? -1 : 1);
  }
  return fmt::format(
      R"({{"kind": "{}", "surface": {}, "interface": {}, "boundary_face": {}, "edges": [{}]}})",
      word(words::kFaces, face.kind), face.surface, face.interface, face.boundary_face, loop);
}

std::string record(const Document::Block& block) {
  std::string faces;
  for (std::size_t side = 0; side < words::kSides.size(); ++side) {
    if (side > 0) faces += ", ";
    faces += fmt::format(R"("{}": {})", words::kSides[side], list(block.faces[side]));
  }
  return fmt::format(
      R"({{"name": {}, "family": {}, "ni": {}, "nj": {}, "nk": {}, "faces": {{{}}}}})",
      text(block.name), text(block.family), block.ni, block.nj, block.nk, faces);
}

std::string record(const Interface& interface) {
  return fmt::format(R"({{"name": {}, "first": {}, "second": {}, "transform": {}}})",
                     text(interface.name), range(interface.first), range(interface.second),
                     list(interface.transform));
}

std::string record(const BoundaryFace& face) {
  return fmt::format(
      R"({{"kind": "{}", "name": {}, "condition": "{}", "cgns_type": {}, "range": {}}})",
      word(words::kBoundaries, face.kind), text(face.name),
      word(words::kConditions, face.condition.kind), text(face.condition.cgns_type),
      range(face.range));
}

template <typename Records>
void put(std::ostream& stream, const char* key, const Records& records) {
  stream << fmt::format(",\n\"{}\": [", key);
  bool is_first = true;
  for (const auto& one : records) {
    stream << (std::exchange(is_first, false) ? "\n" : ",\n") << record(one);
  }
  stream << "]";
}

}  // namespace

void write_topology(const std::filesystem::path& file, const TopologyDocument& document) {
  OutputFile output(file);
  std::ostream& stream = output.stream();
  stream << fmt::format("{{\"format\": \"{}\", \"version\": {}, \"flat\": {}", words::kFormat,
                        words::kVersion, document.flat);
  put(stream, "points", document.points_world);
  put(stream, "curves", document.curves);
  put(stream, "surfaces", document.surfaces);
  put(stream, "planes", document.planes);
  put(stream, "vertices", document.vertices);
  put(stream, "edges", document.edges);
  put(stream, "faces", document.faces);
  put(stream, "blocks", document.blocks);
  put(stream, "interfaces", document.interfaces);
  put(stream, "boundary_faces", document.boundary_faces);
  stream << "}\n";
  output.commit();
}

}  // namespace vdb_offset
