#include <fmt/format.h>

#include <array>
#include <nlohmann/json.hpp>

#include "inputs.h"
#include "vdb_offset/io/vtk.h"
#include "volume_input.h"

namespace vdb_offset::command {
namespace {

using Json = nlohmann::ordered_json;

std::string describe_zones(const std::string& file, bool json) {
  const ZoneMesh mesh = read_vtm(file);
  if (json) {
    Json out = {{"file", file},
                {"format", "vtk"},
                {"blocks", Json::array()},
                {"points", mesh.points()},
                {"cells", mesh.cells()}};
    for (const Zone& zone : mesh.zones) {
      out["blocks"].push_back(
          {{"name", zone.name}, {"ni", zone.ni}, {"nj", zone.nj}, {"nk", zone.nk}});
    }
    return out.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
  }
  constexpr std::size_t kShown = 20;
  std::string out = fmt::format("file       {}\nformat     VTK XML\n", file);
  for (std::size_t z = 0; z < std::min(kShown, mesh.zones.size()); ++z) {
    const Zone& zone = mesh.zones[z];
    out +=
        fmt::format("block {:<4} {} x {} x {}, {}\n", z + 1, zone.ni, zone.nj, zone.nk, zone.name);
  }
  if (mesh.zones.size() > kShown) {
    out += fmt::format("           and {} more\n", mesh.zones.size() - kShown);
  }
  return out + fmt::format("volume     {} blocks, {} points, {} cells\n", mesh.zones.size(),
                           mesh.points(), mesh.cells());
}

std::array<std::size_t, kCellKinds> count_kinds(const CellZone& mesh) {
  std::array<std::size_t, kCellKinds> counts{};
  for (const CellKind kind : mesh.kinds) ++counts[static_cast<std::size_t>(kind)];
  return counts;
}

}  // namespace

Json cells_json(const CellZone& mesh) {
  Json out = {{"dimensions", mesh.flat ? 2 : 3},
              {"points", mesh.points_world.size()},
              {"cells", mesh.kinds.size()},
              {"kinds", Json::object()},
              {"boundaries", Json::array()}};
  const auto counts = count_kinds(mesh);
  for (std::size_t kind = 0; kind < kCellKinds; ++kind) {
    if (counts[kind] > 0) out["kinds"][name_of(static_cast<CellKind>(kind))] = counts[kind];
  }
  for (const CellBoundary& boundary : mesh.boundaries) {
    out["boundaries"].push_back(
        {{"name", boundary.name}, {"type", boundary.type}, {"faces", boundary.faces.size()}});
  }
  return out;
}

std::string describe_volume(const std::string& file, InputKind kind, bool json) {
  if (kind == InputKind::Vtk) return describe_zones(file, json);
  const CellZone mesh = read_cells(file, kind);
  if (json) {
    const char* const format = kind == InputKind::Vtu   ? "vtu"
                               : kind == InputKind::Su2 ? "su2"
                                                        : "openfoam";
    Json out = {{"file", file}, {"format", format}};
    out.update(cells_json(mesh));
    return out.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
  }
  return fmt::format("file       {}\nformat     {}\n", file, cell_format(kind)) + cell_lines(mesh);
}

std::string cell_lines(const CellZone& mesh) {
  std::string out =
      fmt::format("volume     {} points, {} cells{}\n", mesh.points_world.size(), mesh.kinds.size(),
                  mesh.flat ? ", of two dimensions, made one cell thick" : "");
  const auto counts = count_kinds(mesh);
  for (std::size_t n = 0; n < kCellKinds; ++n) {
    if (counts[n] > 0) {
      out += fmt::format("cells      {} {}\n", counts[n], name_of(static_cast<CellKind>(n)));
    }
  }
  for (const CellBoundary& boundary : mesh.boundaries) {
    out += fmt::format("boundary   {}: {} faces{}\n", boundary.name, boundary.faces.size(),
                       boundary.type.empty() ? "" : ", " + boundary.type);
  }
  return out;
}

}  // namespace vdb_offset::command
