#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <map>
#include <numeric>
#include <vector>

#include "check_report.h"
#include "quality_table.h"

namespace vdb_offset::command {
namespace {

constexpr std::size_t kRows = 20;  ///< most rows of zones, cells and faults, without --verbose

std::size_t rows_of(std::size_t all, bool verbose) { return verbose ? all : std::min(all, kRows); }

void print_zones(const CheckRun& run) {
  const std::vector<QualityMinima>& zones = run.check.zones;
  std::vector<std::size_t> order(zones.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::stable_sort(order, {}, [&](std::size_t z) { return zones[z].min_scaled_jacobian; });
  print_quality_head(stdout, "zone");
  const std::size_t shown = rows_of(order.size(), run.verbose);
  for (std::size_t row = 0; row < shown; ++row) {
    print_quality_row(stdout, run.input.mesh.zones[order[row]].name, zones[order[row]]);
  }
  if (shown < order.size()) {
    fmt::print("  and {} more, none with a smaller scaled Jacobian\n", order.size() - shown);
  }
  print_quality_row(stdout, "all", run.check.quality);
}

void print_cells(const CheckRun& run) {
  const std::vector<CellPlace>& cells = run.check.nonpositive;
  if (cells.empty()) return;
  fmt::print("cells      {} of {} not positive\n", run.check.quality.nonpositive_cells,
             run.check.quality.cells);
  fmt::print("  {:<24} {:>6} {:>6} {:>6} {:>16}\n", "zone", "i", "j", "k", "scaled Jacobian");
  const std::size_t shown = rows_of(cells.size(), run.verbose);
  for (std::size_t row = 0; row < shown; ++row) {
    const CellPlace& cell = cells[row];
    fmt::print("  {:<24} {:>6} {:>6} {:>6} {:>16.3g}\n",
               run.input.mesh.zones[static_cast<std::size_t>(cell.block)].name, cell.i + 1,
               cell.j + 1, cell.k + 1, cell.scaled_jacobian);
  }
  if (shown < run.check.quality.nonpositive_cells) {
    fmt::print("  and {} more\n", run.check.quality.nonpositive_cells - shown);
  }
}

/// "2 mismatch, 1 uncovered"
std::string by_kind(const MeshCheck& check) {
  std::map<FaultKind, std::size_t> count;
  for (const MeshFault& fault : check.faults) ++count[fault.kind];
  std::vector<std::string> parts;
  for (const auto& [kind, n] : count) parts.push_back(fmt::format("{} {}", n, describe(kind)));
  return fmt::format("{}", fmt::join(parts, ", "));
}

void print_faults(const CheckRun& run) {
  const MeshCheck& check = run.check;
  if (check.fault_count == 0) {
    fmt::print("faults     none\n");
    return;
  }
  fmt::print("faults     {}: {}\n", check.fault_count, by_kind(check));
  const std::size_t shown = rows_of(check.faults.size(), run.verbose);
  for (std::size_t n = 0; n < shown; ++n) {
    fmt::print("  {:<14} {}\n", describe(check.faults[n].kind), check.faults[n].text);
  }
  if (shown < check.fault_count) fmt::print("  and {} more\n", check.fault_count - shown);
}

void print_connectivity(const CheckRun& run) {
  const MeshCheck& check = run.check;
  const ZoneMesh& mesh = run.input.mesh;
  if (!check.has_connectivity) {
    fmt::print("blocks     no connectivity is known: what meets what is not checked\n");
    return;
  }
  fmt::print(
      "blocks     {} interfaces, {} boundary faces; {} points compared, those that match "
      "within {:.3g}\n",
      mesh.interfaces.size(), mesh.boundary_faces.size(), check.interface_points,
      check.interface_distance_world);
}

}  // namespace

void print_check(const CheckRun& run) {
  const MeshCheck& check = run.check;
  fmt::print("file       {}\nformat     {}\n", run.file, run.input.format);
  if (!run.input.map.empty()) fmt::print("map        {}\n", run.input.map.string());
  fmt::print("mesh       {} zones, {} points, {} cells\n", run.input.mesh.zones.size(),
             run.input.mesh.points(), check.quality.cells);
  fmt::print("quality    scaled Jacobian {:.4f} least, {:.4f} mean; {} cells not positive\n",
             check.quality.min_scaled_jacobian, check.mean_scaled_jacobian,
             check.quality.nonpositive_cells);
  print_zones(run);
  print_cells(run);
  print_connectivity(run);
  print_faults(run);
  fmt::print("time       read {:.2f} s, checked {:.2f} s\n", run.read_seconds, run.check_seconds);
}

}  // namespace vdb_offset::command
