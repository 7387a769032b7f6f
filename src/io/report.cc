#include "vdb_offset/io/report.h"

#include <sys/resource.h>

#include <algorithm>
#include <map>
#include <nlohmann/json.hpp>

#include "io/output_file.h"
#include "vdb_offset/blocks/conditions.h"
#include "vdb_offset/core/version.h"
#include "vdb_offset/surface/inside.h"

namespace vdb_offset {
namespace {

// Keys keep the order in which they are written: the order of the pipeline.
using Json = nlohmann::ordered_json;

Json number_or_null(double value, bool known) { return known ? Json(value) : Json(nullptr); }

Json families_of(const Patches& patches) {
  Json out = Json::array();
  for (const Patch& patch : patches) {
    const bool known = std::find(out.begin(), out.end(), Json(patch.family)) != out.end();
    if (!patch.family.empty() && !known) out.push_back(patch.family);
  }
  return out;
}

Json vector_json(const Vec3& v) { return Json::array({v.x(), v.y(), v.z()}); }

const char* kind_of(const Boundary& boundary) {
  if (boundary.is_bare_wall()) return "wall";
  if (boundary.is_internal()) return "internal";
  return boundary.is_plane() ? "plane" : "surface";
}

Json boundaries_json(const Surface& surface) {
  Json out = Json::array();
  if (!surface.boundaries) return out;
  for (const Boundary& boundary : surface.boundaries->list()) {
    Json one = {{"name", boundary.name()},
                {"kind", kind_of(boundary)},
                {"free_edges", surface.free_edges_on(static_cast<int>(out.size()))}};
    if (boundary.is_plane()) {
      one["point"] = vector_json(boundary.plane().point_world);
      one["normal"] = vector_json(boundary.plane().normal);
    }
    out.push_back(one);
  }
  return out;
}

Json surface_json(const Surface& surface) {
  Json flipped = Json::array();
  for (const int patch : surface.report.flipped) {
    flipped.push_back(surface.patches[static_cast<std::size_t>(patch)].name);
  }
  return {{"patches", surface.patches.size()},
          {"points", surface.points() / (surface.flat ? 2 : 1)},
          {"nodes", surface.nodes()},
          {"faces", surface.faces()},
          {"closed", surface.free_edges() == 0},
          {"both_sides", surface.both_sides},
          {"dimensions", surface.flat ? 2 : 3},
          {"components", surface.topology.components},
          {"free_edges", surface.free_edges()},
          {"boundaries", boundaries_json(surface)},
          {"boundary_distance_max", surface.report.boundary_distance_max_world},
          {"families", families_of(surface.patches)},
          {"flipped", flipped},
          {"split_patches", surface.report.split_patches},
          {"fans", surface.report.fans},
          {"fan_corners", surface.report.fan_corners},
          {"weld_distance_max", surface.report.weld_distance_max_world},
          {"shortest_edge", surface.report.shortest_edge_world},
          {"median_edge", surface.report.median_edge_world}};
}

/// How phi in a file tells the sides.
const char* sign_of(const Surface& surface) {
  if (surface.winding != nullptr) return "winding";
  return has_inside(surface) ? "normals" : "none";
}

Json field_json(const DistanceField& field, const BandPlan& plan) {
  const SweepReport& sweep = field.report;
  return {
      {"voxel_size", field.voxel_world},
      {"voxel_rule", voxel_rule_name(plan.rule)},
      {"distance", field.distance_world},
      {"active_voxels", sweep.active_voxels},
      {"bytes", sweep.bytes},
      {"planned_bytes", plan.total_bytes},
      {"limit_bytes", plan.limit_bytes},
      {"sweeps", sweep.sweeps},
      {"tile_visits", sweep.tile_visits},
      {"converged", sweep.converged},
      {"last_change_voxels", number_or_null(sweep.last_change_voxels, !reached_new_voxels(sweep))}};
}

Json spacing_json(const LayerSpacing& spacing) {
  return {
      {"layers", spacing.layers},
      {"height", spacing.height_world},
      {"first_cell", spacing.first_cell_world},
      {"last_cell", spacing.last_cell_world},
      {"growth", spacing.growth},
      {"growth_requested", number_or_null(spacing.growth_requested, spacing.growth_requested > 0)}};
}

Json march_json(const MarchReport& march) {
  return {{"nodes", march.nodes},
          {"reached", march.reached},
          {"collided", march.collided},
          {"left_band", march.left_band},
          {"limited", march.limited},
          {"internal", march.internal},
          {"distance_error_max", march.distance_error_max}};
}

Json coverage_json(const MultiBlock& mesh) {
  Json out = Json::array();
  const std::vector<Coverage> parts = coverage(mesh);
  for (std::size_t b = 0; b < parts.size(); ++b) {
    out.push_back({{"patch", mesh.blocks[b].name},
                   {"family", mesh.blocks[b].family},
                   {"mean", parts[b].mean},
                   {"min", parts[b].min}});
  }
  return out;
}

/// How many faces of blocks each name has: walls, boundaries, internal surfaces.
Json named_faces(const MultiBlock& mesh) {
  std::map<std::string, int> counts;
  for (const BoundaryFace& face : mesh.boundary_faces) ++counts[face.name];
  for (const Interface& face : mesh.interfaces) {
    if (!face.name.empty()) ++counts[face.name];
  }
  return counts;
}

/// The condition of each name of boundary faces.
Json conditions_json(const MultiBlock& mesh) {
  std::map<std::string, std::string> conditions;
  for (const BoundaryFace& face : mesh.boundary_faces) {
    conditions[face.name] = describe(face.condition);
  }
  return conditions;
}

Json blocks_json(const MultiBlock& mesh) {
  return {{"count", mesh.blocks.size()},
          {"cells", mesh.cells()},
          {"nodes", mesh.layers.points_world.size()},
          {"interfaces", mesh.interfaces.size()},
          {"boundary_faces", mesh.boundary_faces.size()},
          {"named_faces", named_faces(mesh)},
          {"conditions", conditions_json(mesh)}};
}

/// The keys of a level or patch.
Json minima_json(const QualityMinima& worst) {
  return {{"cells", worst.cells},
          {"nonpositive_cells", worst.nonpositive_cells},
          {"min_scaled_jacobian", worst.min_scaled_jacobian},
          {"min_jacobian", worst.min_jacobian},
          {"min_volume", worst.min_volume},
          {"max_skewness", worst.max_skewness},
          {"max_aspect_ratio", worst.max_aspect_ratio},
          {"min_orthogonality", worst.min_orthogonality},
          {"max_growth", worst.growth_max},
          {"max_side_growth", worst.side_growth_max}};
}

/// Rows of layers of cells, from the wall up.
Json levels_json(const QualityReport& quality) {
  Json rows = Json::array();
  for (const QualityMinima& level : quality.levels) {
    Json row = {{"level", rows.size() + 1}};
    row.update(minima_json(level));
    rows.push_back(row);
  }
  return rows;
}

Json patches_json(const QualityReport& quality, const MultiBlock& mesh) {
  Json rows = Json::array();
  for (const QualityMinima& patch : quality.patches) {
    const Block& block = mesh.blocks[rows.size()];
    Json row = {{"patch", block.name}, {"family", block.family}};
    row.update(minima_json(patch));
    rows.push_back(row);
  }
  return rows;
}

Json repair_json(const RepairReport& repair) {
  return {{"windows", repair.windows},      {"columns", repair.columns},
          {"lowered", repair.lowered},      {"beyond", repair.beyond},
          {"steps", repair.steps},          {"unmended", repair.unmended},
          {"fall_short", repair.fall_short}};
}

Json astray_json(const std::vector<Astray>& found) {
  Json out = Json::array();
  for (const Astray& one : found) {
    out.push_back({{"name", one.name},
                   {"count", one.count},
                   {"farthest", one.farthest_world},
                   {"first", vector_json(one.place_world)}});
  }
  return out;
}

/// Those that are not positive, 1-based as in the messages.
Json cells_json(const MultiBlock& mesh, const QualityField& quality) {
  constexpr std::size_t kMost = 100;
  Json rows = Json::array();
  for (const CellPlace& cell : nonpositive_cells(mesh, quality, kMost)) {
    rows.push_back({{"block", mesh.blocks[static_cast<std::size_t>(cell.block)].name},
                    {"i", cell.i + 1},
                    {"j", cell.j + 1},
                    {"k", cell.k + 1},
                    {"scaled_jacobian", cell.scaled_jacobian}});
  }
  return rows;
}

Json quality_json(const QualityReport& quality, const MultiBlock& mesh) {
  const LayerSpacing& spacing = mesh.layers.spacing;
  const bool asked = spacing.growth_requested > 0;
  return {{"min_scaled_jacobian", quality.min_scaled_jacobian},
          {"mean_scaled_jacobian", quality.mean_scaled_jacobian},
          {"nonpositive_cells", quality.nonpositive_cells},
          {"min_volume", quality.min_volume},
          {"min_jacobian", quality.min_jacobian},
          {"max_skewness", quality.max_skewness},
          {"max_aspect_ratio", quality.max_aspect_ratio},
          {"min_orthogonality", quality.min_orthogonality},
          {"first_cell",
           {{"requested", spacing.first_cell_world},
            {"min", quality.first_cell_min},
            {"median", quality.first_cell_median},
            {"max", quality.first_cell_max}}},
          {"growth",
           {{"requested", number_or_null(spacing.growth_requested, asked)},
            {"solved", spacing.growth},
            {"max", quality.growth_max},
            {"side_max", quality.side_growth_max}}},
          {"levels", levels_json(quality)},
          {"patches", patches_json(quality, mesh)}};
}

Json value_json(const OptionValue& value) {
  return std::visit(
      [](const auto& v) -> Json {
        if constexpr (std::is_same_v<std::decay_t<decltype(v)>, std::monostate>)
          return nullptr;
        else
          return v;
      },
      value);
}

}  // namespace

std::string_view voxel_rule_name(VoxelRule rule) {
  switch (rule) {
    case VoxelRule::Given:
      return "given";
    case VoxelRule::Distance:
      return "distance";
    case VoxelRule::SurfaceEdge:
      return "surface-edge";
    case VoxelRule::Memory:
      return "memory";
  }
  return "unknown";
}

bool reached_new_voxels(const SweepReport& sweep) {
  constexpr double kLattice = 1U << 31U;  // voxels: no distance in it is larger
  return sweep.last_change_voxels > kLattice;
}

std::uint64_t peak_memory_bytes() {
  rusage usage{};
  if (::getrusage(RUSAGE_SELF, &usage) != 0) return 0;
  return static_cast<std::uint64_t>(usage.ru_maxrss) * 1024;  // Linux counts kibibytes
}

std::string report_json(const ReportParts& parts, const RunInfo& run) {
  Json out;
  if (parts.surface != nullptr) out["surface"] = surface_json(*parts.surface);
  if (parts.field != nullptr && parts.plan != nullptr) {
    out["field"] = field_json(*parts.field, *parts.plan);
    if (parts.surface != nullptr) out["field"]["sign"] = sign_of(*parts.surface);
  }
  if (parts.mesh != nullptr) {
    out["spacing"] = spacing_json(parts.mesh->layers.spacing);
    out["march"] = march_json(parts.mesh->layers.report);
    out["coverage"] = coverage_json(*parts.mesh);
    out["blocks"] = blocks_json(*parts.mesh);
  }
  if (parts.repair != nullptr) out["repair"] = repair_json(*parts.repair);
  if (parts.sides != nullptr) {
    out["points_beyond_boundaries"] = astray_json(parts.sides->beyond);
    out["cells_cut_by_internal"] = astray_json(parts.sides->cut);
    out["points_past_rims"] = astray_json(parts.sides->past);
  }
  if (parts.crossings != nullptr) {
    const CrossingsReport& found = *parts.crossings;
    out["crossings"] = {{"cells", found.cells}, {"wall_points", found.wall_points}};
    if (found.cells > 0) out["crossings"]["first"] = vector_json(found.place_world);
  }
  if (parts.mesh != nullptr && parts.quality != nullptr) {
    out["quality"] = quality_json(parts.quality->report, *parts.mesh);
    out["quality"]["nonpositive"] = cells_json(*parts.mesh, *parts.quality);
  }
  out["options"] = Json::object();
  for (const auto& [name, value] : run.options) out["options"][name] = value_json(value);
  out["time"] = Json::object();
  for (const auto& [stage, seconds] : run.seconds) out["time"][stage] = seconds;
  out["run"] = {{"command", run.command},
                {"outputs", run.outputs},
                {"threads", run.threads},
                {"peak_memory_bytes", peak_memory_bytes()},
                {"version", kVersion}};
  // File names need not be UTF-8: replace what is not, rather than fail after hours of work.
  return out.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

void write_report(const std::filesystem::path& file, const std::string& json) {
  OutputFile output(file);
  output.stream() << json;
  output.commit();
}

}  // namespace vdb_offset
