#include <fmt/format.h>

#include <map>
#include <nlohmann/json.hpp>

#include "inputs.h"
#include "vdb_offset/io/neutral_map.h"

namespace vdb_offset::command {
namespace {

using Json = nlohmann::ordered_json;

/// How many boundary faces there are of each type.
std::map<std::string, std::size_t> types_of(const NeutralMap& map) {
  std::map<std::string, std::size_t> types;
  for (const BoundaryFace& face : map.boundary_faces) ++types[face.name];
  return types;
}

std::string lines_of(const std::string& file, const NeutralMap& map) {
  constexpr std::size_t kShown = 20;
  std::string out = fmt::format("file       {}\nformat     neutral map\n", file);
  std::size_t shown = 0;
  for (const auto& size : map.sizes) {
    if (++shown > kShown) break;
    out += fmt::format("block {:<4} {}\n", shown, fmt::join(size, " x "));
  }
  if (map.sizes.size() > kShown) {
    out += fmt::format("           and {} more\n", map.sizes.size() - kShown);
  }
  out += fmt::format("entries    {} interfaces, {} boundary faces\n", map.interfaces.size(),
                     map.boundary_faces.size());
  for (const auto& [type, count] : types_of(map)) {
    out += fmt::format("type       {}: {}\n", type, count);
  }
  return out;
}

}  // namespace

std::string describe_neutral_map(const std::string& file, bool json) {
  const NeutralMap map = read_neutral_map(file);
  if (!json) return lines_of(file, map);
  Json out = {{"file", file},
              {"format", "nmf"},
              {"blocks", Json::array()},
              {"interfaces", map.interfaces.size()},
              {"boundary_faces", map.boundary_faces.size()},
              {"types", types_of(map)}};
  for (const auto& size : map.sizes) {
    out["blocks"].push_back({{"ni", size[0]}, {"nj", size[1]}, {"nk", size[2]}});
  }
  return out.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace vdb_offset::command
