#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "check_report.h"

namespace vdb_offset::command {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::size_t kRows = 20;  ///< most rows of cells and faults, without --verbose

void print_row(const char* name, const QualityMinima& row) {
  fmt::print("  {:<24} {:9} {:7} {:8.4f} {:9.2e} {:8.4f} {:9.4g}\n", name, row.cells,
             row.nonpositive_cells, row.min_scaled_jacobian, row.min_volume, row.max_skewness,
             row.max_aspect_ratio);
}

void print_kinds(const CellCheck& check) {
  fmt::print("  {:<24} {:>9} {:>7} {:>8} {:>9} {:>8} {:>9}\n", "cells", "cells", "bad", "scaled J",
             "volume", "skewness", "aspect");
  for (std::size_t kind = 0; kind < kCellKinds; ++kind) {
    const QualityMinima& row = check.kinds[kind];
    const auto name = name_of(static_cast<CellKind>(kind));
    if (row.cells == 0) continue;
    if (static_cast<CellKind>(kind) != CellKind::Polyhedron) {
      print_row(name, row);
    } else {
      fmt::print("  {:<24} {:9} {:7} {:>8} {:9.2e}\n", name, row.cells, row.nonpositive_cells, "",
                 row.min_volume);
    }
  }
  print_row("all", check.quality);
}

void print_cells(const CellCheckRun& run) {
  const auto& cells = run.check.nonpositive;
  if (cells.empty()) return;
  fmt::print("cells      {} of {} not positive\n", run.check.quality.nonpositive_cells,
             run.check.quality.cells);
  fmt::print("  {:>10} {:<14} {:>16}  {}\n", "cell", "kind", "scaled Jacobian", "middle");
  const std::size_t shown = run.verbose ? cells.size() : std::min(cells.size(), kRows);
  for (std::size_t row = 0; row < shown; ++row) {
    const CellCheck::BadCell& cell = cells[row];
    const Vec3& at = cell.middle_world;
    fmt::print("  {:>10} {:<14} {:>16.3g}  ({:.6g}, {:.6g}, {:.6g})\n", cell.cell,
               name_of(run.mesh.kinds[static_cast<std::size_t>(cell.cell)]), cell.scaled_jacobian,
               at.x(), at.y(), at.z());
  }
  if (shown < run.check.quality.nonpositive_cells) {
    fmt::print("  and {} more\n", run.check.quality.nonpositive_cells - shown);
  }
}

void print_faces(const CellCheckRun& run) {
  const CellCheck& check = run.check;
  fmt::print("faces      {} between two cells, {} ", check.inner_faces, check.boundary_faces);
  if (run.mesh.names_boundaries) {
    return fmt::print("in {} boundaries\n", run.mesh.boundaries.size());
  }
  fmt::print("of one; the format names no boundaries\n");
  if (check.coincident_pairs == 0) return;
  fmt::print("           {} pairs of those lie in one place: walls of two sides, or gaps\n",
             check.coincident_pairs);
}

Json minima_json(const QualityMinima& q, bool only_volume) {
  Json out = {{"cells", q.cells}, {"nonpositive_cells", q.nonpositive_cells}};
  if (!only_volume) {
    out["min_scaled_jacobian"] = q.min_scaled_jacobian;
    out["min_jacobian"] = q.min_jacobian;
  }
  out["min_volume"] = q.min_volume;
  if (!only_volume) {
    out["max_skewness"] = q.max_skewness;
    out["max_aspect_ratio"] = q.max_aspect_ratio;
  }
  return out;
}

Json boundaries_json(const CellZone& mesh) {
  Json out = Json::array();
  for (const CellBoundary& boundary : mesh.boundaries) {
    out.push_back(
        {{"name", boundary.name}, {"type", boundary.type}, {"faces", boundary.faces.size()}});
  }
  return out;
}

}  // namespace

void print_check(const CellCheckRun& run) {
  const CellCheck& check = run.check;
  fmt::print("file       {}\nformat     {}\n", run.file, cell_format(run.kind));
  fmt::print("mesh       {} points, {} cells{}\n", run.mesh.points_world.size(),
             check.quality.cells, run.mesh.flat ? ", of two dimensions, made one cell thick" : "");
  fmt::print("quality    scaled Jacobian {:.4f} least, {:.4f} mean; {} cells not positive\n",
             check.quality.min_scaled_jacobian, check.mean_scaled_jacobian,
             check.quality.nonpositive_cells);
  print_kinds(check);
  print_cells(run);
  print_faces(run);
  if (check.fault_count == 0) {
    fmt::print("faults     none\n");
  } else {
    fmt::print("faults     {}\n", check.fault_count);
    for (const MeshFault& fault : check.faults) {
      fmt::print("  {:<14} {}\n", describe(fault.kind), fault.text);
    }
  }
  fmt::print("time       read {:.2f} s, checked {:.2f} s\n", run.read_seconds, run.check_seconds);
}

std::string check_json(const CellCheckRun& run) {
  const CellCheck& check = run.check;
  Json quality = minima_json(check.quality, false);
  quality["mean_scaled_jacobian"] = check.mean_scaled_jacobian;
  Json kinds = Json::object();
  for (std::size_t n = 0; n < kCellKinds; ++n) {
    const auto kind = static_cast<CellKind>(n);
    if (check.kinds[n].cells > 0) {
      kinds[name_of(kind)] = minima_json(check.kinds[n], kind == CellKind::Polyhedron);
    }
  }
  Json cells = Json::array();
  for (const CellCheck::BadCell& cell : check.nonpositive) {
    const Vec3& at = cell.middle_world;
    cells.push_back({{"cell", cell.cell},
                     {"kind", name_of(run.mesh.kinds[static_cast<std::size_t>(cell.cell)])},
                     {"scaled_jacobian", cell.scaled_jacobian},
                     {"middle", Json::array({at.x(), at.y(), at.z()})}});
  }
  Json faults = Json::array();
  for (const MeshFault& fault : check.faults) {
    faults.push_back(
        {{"kind", describe(fault.kind)}, {"text", fault.text}, {"count", fault.count}});
  }
  const Json out = {{"file", run.file},
                    {"format", cell_format(run.kind)},
                    {"sound", check.is_sound()},
                    {"points", run.mesh.points_world.size()},
                    {"flat", run.mesh.flat},
                    {"quality", quality},
                    {"kinds", kinds},
                    {"cells", cells},
                    {"faces",
                     {{"inner", check.inner_faces},
                      {"boundary", check.boundary_faces},
                      {"coincident_pairs", check.coincident_pairs}}},
                    {"boundaries", boundaries_json(run.mesh)},
                    {"fault_count", check.fault_count},
                    {"faults", faults},
                    {"seconds", {{"read", run.read_seconds}, {"check", run.check_seconds}}}};
  return out.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace vdb_offset::command
