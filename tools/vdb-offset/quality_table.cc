#include "quality_table.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <numeric>
#include <string>
#include <vector>

#include "vdb_offset/blocks/widen_minima.h"

namespace vdb_offset::command {
namespace {

constexpr std::size_t kRows = 20;  ///< most rows of levels, and of patches

double degrees_off_normal(double cosine) {
  return std::acos(std::clamp(cosine, -1.0, 1.0)) * 180 / std::numbers::pi;
}

/// The cells at the wall stand alone; the others share what rows are left.
void print_levels(const std::vector<QualityMinima>& levels) {
  if (levels.empty()) return;
  const std::size_t band = levels.size() <= kRows ? 1 : (levels.size() + kRows - 3) / (kRows - 1);
  print_quality_head(stderr, band == 1 ? "level, from the wall" : "levels, from the wall");
  print_quality_row(stderr, "1", levels[0]);
  for (std::size_t first = 1; first < levels.size(); first += band) {
    const std::size_t end = std::min(first + band, levels.size());
    QualityMinima worst = levels[first];
    for (std::size_t k = first + 1; k < end; ++k) widen(levels[k], worst);
    print_quality_row(
        stderr, end - first == 1 ? fmt::format("{}", end) : fmt::format("{}-{}", first + 1, end),
        worst);
  }
  if (band > 1) fmt::print(stderr, "  the worst of each band; --report has every level\n");
}

void print_patches(const MultiBlock& mesh, const std::vector<QualityMinima>& patches) {
  if (patches.empty()) return;
  std::vector<std::size_t> order(patches.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::stable_sort(order, {},
                           [&](std::size_t b) { return patches[b].min_scaled_jacobian; });
  print_quality_head(stderr, "patch");
  for (std::size_t row = 0; row < std::min(order.size(), kRows); ++row) {
    print_quality_row(stderr, mesh.blocks[order[row]].name, patches[order[row]]);
  }
  if (order.size() > kRows) {
    fmt::print(stderr, "  and {} more, none with a smaller scaled Jacobian; --report has all\n",
               order.size() - kRows);
  }
}

}  // namespace

void print_quality_head(std::FILE* to, const char* what) {
  fmt::print(to, "  {:<24} {:>9} {:>7} {:>8} {:>9} {:>8} {:>9} {:>10} {:>7} {:>11}\n", what,
             "cells", "bad", "scaled J", "volume", "skewness", "aspect", "off normal", "growth",
             "side growth");
}

void print_quality_row(std::FILE* to, const std::string& name, const QualityMinima& row) {
  fmt::print(to,
             "  {:<24} {:9} {:7} {:8.4f} {:9.2e} {:8.4f} {:9.4g} {:9.2f}\u00B0 {:7.4g} {:11.4g}\n",
             name, row.cells, row.nonpositive_cells, row.min_scaled_jacobian, row.min_volume,
             row.max_skewness, row.max_aspect_ratio, degrees_off_normal(row.min_orthogonality),
             row.growth_max, row.side_growth_max);
}

void print_quality(const Console& console, const MultiBlock& mesh, const QualityReport& report) {
  if (!console.verbose() || console.quiet()) return;
  print_levels(report.levels);
  print_patches(mesh, report.patches);
  print_quality_head(stderr, "");
  print_quality_row(stderr, "all", report);
}

}  // namespace vdb_offset::command
