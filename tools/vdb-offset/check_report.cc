#include "check_report.h"

#include <array>
#include <nlohmann/json.hpp>

namespace vdb_offset::command {
namespace {

using Json = nlohmann::ordered_json;

const char* name_of(BlockFace face) {
  constexpr std::array<const char*, 6> kNames{"imin", "imax", "jmin", "jmax", "kmin", "kmax"};
  return kNames[static_cast<std::size_t>(face)];
}

/// From 1, as people and files count.
Json indices(const std::array<int, 3>& at) {
  return Json::array({at[0] + 1, at[1] + 1, at[2] + 1});
}

std::string zone_name(const ZoneMesh& mesh, int zone) {
  const auto z = static_cast<std::size_t>(zone);
  return zone >= 0 && z < mesh.zones.size() ? mesh.zones[z].name : "";
}

Json minima_json(const QualityMinima& q) {
  return {{"cells", q.cells},
          {"nonpositive_cells", q.nonpositive_cells},
          {"min_scaled_jacobian", q.min_scaled_jacobian},
          {"min_jacobian", q.min_jacobian},
          {"min_volume", q.min_volume},
          {"max_skewness", q.max_skewness},
          {"max_aspect_ratio", q.max_aspect_ratio},
          {"min_orthogonality", q.min_orthogonality},
          {"growth_max", q.growth_max},
          {"side_growth_max", q.side_growth_max}};
}

Json zones_json(const CheckRun& run) {
  Json out = Json::array();
  for (std::size_t z = 0; z < run.check.zones.size(); ++z) {
    const Zone& zone = run.input.mesh.zones[z];
    Json one = {{"name", zone.name},
                {"family", zone.family},
                {"ni", zone.ni},
                {"nj", zone.nj},
                {"nk", zone.nk}};
    one.update(minima_json(run.check.zones[z]));
    out.push_back(std::move(one));
  }
  return out;
}

Json cells_json(const CheckRun& run) {
  Json out = Json::array();
  for (const CellPlace& cell : run.check.nonpositive) {
    out.push_back({{"zone", zone_name(run.input.mesh, cell.block)},
                   {"at", indices({cell.i, cell.j, cell.k})},
                   {"scaled_jacobian", cell.scaled_jacobian}});
  }
  return out;
}

Json faults_json(const CheckRun& run) {
  Json out = Json::array();
  for (const MeshFault& fault : run.check.faults) {
    Json one = {{"kind", describe(fault.kind)}, {"text", fault.text}, {"ranges", Json::array()}};
    for (const BlockRange& range : fault.ranges) {
      one["ranges"].push_back({{"zone", zone_name(run.input.mesh, range.block)},
                               {"face", name_of(range.face)},
                               {"begin", indices(range.begin)},
                               {"end", indices(range.end)}});
    }
    if (fault.kind == FaultKind::Mismatch) {
      one["points"] = fault.count;
      one["distance"] = fault.distance_world;
      one["at"] = indices(fault.at);
    } else if (fault.count > 0) {
      one["faces"] = fault.count;
    }
    out.push_back(std::move(one));
  }
  return out;
}

}  // namespace

std::string check_json(const CheckRun& run) {
  const MeshCheck& check = run.check;
  const ZoneMesh& mesh = run.input.mesh;
  Json quality = minima_json(check.quality);
  quality["mean_scaled_jacobian"] = check.mean_scaled_jacobian;
  const Json map = run.input.map.empty() ? Json() : Json(run.input.map.string());
  const Json out = {{"file", run.file},
                    {"format", run.input.format},
                    {"map", map},
                    {"sound", check.is_sound()},
                    {"points", mesh.points()},
                    {"quality", quality},
                    {"zones", zones_json(run)},
                    {"cells", cells_json(run)},
                    {"connectivity",
                     {{"known", check.has_connectivity},
                      {"interfaces", mesh.interfaces.size()},
                      {"boundary_faces", mesh.boundary_faces.size()},
                      {"points_compared", check.interface_points},
                      {"distance_max", check.interface_distance_world}}},
                    {"fault_count", check.fault_count},
                    {"faults", faults_json(run)},
                    {"seconds", {{"read", run.read_seconds}, {"check", run.check_seconds}}}};
  return out.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace vdb_offset::command
