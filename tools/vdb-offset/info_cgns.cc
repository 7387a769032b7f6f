#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "inputs.h"

namespace vdb_offset::command {
namespace {

using Json = nlohmann::ordered_json;
constexpr std::size_t kShown = 20;

std::string size_of(const CgnsZoneInfo& zone, bool two_dimensional) {
  if (!zone.is_structured) return fmt::format("{} points, {} cells", zone.ni, zone.cells);
  return two_dimensional ? fmt::format("{} x {}", zone.ni, zone.nj)
                         : fmt::format("{} x {} x {}", zone.ni, zone.nj, zone.nk);
}

}  // namespace

std::size_t cells_of(const CgnsZoneInfo& zone) {
  if (!zone.is_structured) return static_cast<std::size_t>(std::max<std::int64_t>(0, zone.cells));
  const auto cells = [](std::int64_t n) {
    return static_cast<std::size_t>(std::max<std::int64_t>(1, n - 1));
  };
  return cells(zone.ni) * cells(zone.nj) * cells(zone.nk);
}

std::string cgns_lines(const std::string& file, const CgnsInfo& info) {
  std::string out = fmt::format("file       {}\nformat     CGNS {:.4g} in {}\n", file, info.version,
                                info.container);
  out += fmt::format("base       {}: cells of {}, space of {} dimensions, unit of length {}{}\n",
                     info.base, info.cell_dimension, info.physical_dimension,
                     info.length_unit.empty() ? "unknown" : info.length_unit,
                     info.bases > 1 ? fmt::format("; the first of {} bases", info.bases) : "");
  for (std::size_t z = 0; z < std::min(info.zones.size(), kShown); ++z) {
    const CgnsZoneInfo& zone = info.zones[z];
    out +=
        fmt::format("zone {:<5} {}: {}, {} connections, {} boundary conditions{}\n", z + 1,
                    zone.name, size_of(zone, info.cell_dimension == 2), zone.interfaces,
                    zone.boundaries, zone.family.empty() ? "" : ", family '" + zone.family + "'");
  }
  if (info.zones.size() > kShown) {
    out += fmt::format("           and {} more\n", info.zones.size() - kShown);
  }
  for (const CgnsFamilyInfo& family : info.families) {
    out += fmt::format("family     {}: {}\n", family.name,
                       family.type.empty() ? "no boundary condition" : family.type);
  }
  return out;
}

std::string cgns_json(const std::string& file, const CgnsInfo& info) {
  Json out = {{"file", file},
              {"format", "cgns"},
              {"container", info.container},
              {"version", info.version},
              {"bases", info.bases},
              {"base", info.base},
              {"cell_dimension", info.cell_dimension},
              {"physical_dimension", info.physical_dimension},
              {"length_unit", info.length_unit.empty() ? Json() : Json(info.length_unit)},
              {"zones", Json::array()},
              {"families", Json::array()}};
  for (const CgnsZoneInfo& zone : info.zones) {
    if (!zone.is_structured) {
      out["zones"].push_back({{"name", zone.name},
                              {"family", zone.family},
                              {"points", zone.ni},
                              {"cells", zone.cells},
                              {"interfaces", zone.interfaces},
                              {"boundaries", zone.boundaries}});
      continue;
    }
    out["zones"].push_back({{"name", zone.name},
                            {"family", zone.family},
                            {"ni", zone.ni},
                            {"nj", zone.nj},
                            {"nk", zone.nk},
                            {"interfaces", zone.interfaces},
                            {"boundaries", zone.boundaries}});
  }
  for (const CgnsFamilyInfo& family : info.families) {
    out["families"].push_back({{"name", family.name}, {"type", family.type}});
  }
  return out.dump(2, ' ', false, Json::error_handler_t::replace);
}

}  // namespace vdb_offset::command
