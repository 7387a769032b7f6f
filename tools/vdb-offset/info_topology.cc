#include <fmt/format.h>

#include <map>
#include <nlohmann/json.hpp>

#include "inputs.h"
#include "vdb_offset/blocks/conditions.h"

namespace vdb_offset::command {
namespace {

using Json = nlohmann::ordered_json;

/// How many boundary faces each name has, and its condition.
std::map<std::string, std::pair<std::size_t, std::string>> names_of(
    const TopologyDocument& document) {
  std::map<std::string, std::pair<std::size_t, std::string>> names;
  for (const BoundaryFace& face : document.boundary_faces) {
    auto& [count, condition] = names[face.name];
    ++count;
    condition = describe(face.condition);
  }
  return names;
}

}  // namespace

std::string topology_lines(const std::string& file, const TopologyDocument& document) {
  std::string out = fmt::format(
      "file       {}\nformat     topology document\n"
      "geometry   {} points, {} curves, {} surfaces, {} planes\n"
      "topology   {} vertices, {} edges, {} faces, {} blocks\n"
      "entries    {} interfaces, {} boundary faces\n",
      file, document.points_world.size(), document.curves.size(), document.surfaces.size(),
      document.planes.size(), document.vertices.size(), document.edges.size(),
      document.faces.size(), document.blocks.size(), document.interfaces.size(),
      document.boundary_faces.size());
  for (const auto& [name, what] : names_of(document)) {
    out += fmt::format("boundary   {}: {} ({})\n", name, what.first, what.second);
  }
  return out;
}

std::string topology_json(const std::string& file, const TopologyDocument& document) {
  Json out = {{"file", file},
              {"format", "topology"},
              {"points", document.points_world.size()},
              {"curves", document.curves.size()},
              {"surfaces", document.surfaces.size()},
              {"planes", document.planes.size()},
              {"vertices", document.vertices.size()},
              {"edges", document.edges.size()},
              {"faces", document.faces.size()},
              {"blocks", document.blocks.size()},
              {"interfaces", document.interfaces.size()},
              {"boundary_faces", document.boundary_faces.size()},
              {"names", Json::object()}};
  for (const auto& [name, what] : names_of(document)) {
    out["names"][name] = {{"faces", what.first}, {"condition", what.second}};
  }
  return out.dump(2, ' ', false, Json::error_handler_t::replace);
}

}  // namespace vdb_offset::command
