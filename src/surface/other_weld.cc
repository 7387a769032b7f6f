#include "surface/other_weld.h"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <vector>

#include "surface/orient.h"
#include "surface/single_edges.h"
#include "surface/weld.h"
#include "vdb_offset/core/error.h"

namespace vdb_offset {

std::string weld_advice(double weld, bool has_moved, const JudgeWeld& judge) {
  std::vector<double> tried;
  if (has_moved) {
    for (const double part : {0.3, 0.1, 0.03, 0.01, 0.0}) tried.push_back(part * weld);
  }
  for (const double larger : {0.01, 0.02, 0.05, 0.1, 0.2, 0.3}) {
    if (larger > weld) tried.push_back(larger);
  }
  std::size_t fewest = std::numeric_limits<std::size_t>::max();
  double best = weld;
  for (const double tolerance : tried) {
    const std::optional<std::size_t> left = judge(tolerance);
    if (!left || *left >= fewest) continue;
    fewest = *left;
    best = tolerance;
    if (fewest == 0) break;
  }
  if (best == weld) return {};
  const std::string left = fewest == 0 ? "" : fmt::format(" and {} edges are open", fewest);
  return best < weld
             ? fmt::format(
                   "; or take --weld {:g}, with which points stay apart here that --weld {:g} "
                   "made one{}",
                   best, weld, left)
             : fmt::format(
                   "; or take --weld {:g}, which makes points one here that --weld {:g} does not{}",
                   best, weld, left);
}

std::string weld_advice(const Patches& unwelded, double weld) {
  if (!std::ranges::all_of(unwelded, &Patch::is_grid)) return {};
  const auto moved_by = [&](double tolerance) {
    return vdb_offset::weld(unwelded, tolerance, {}).moved_max_world;
  };
  const auto judge = [&](double tolerance) -> std::optional<std::size_t> {
    Patches patches = unwelded;
    Welding welding = vdb_offset::weld(patches, tolerance, {});
    try {
      orient({patches, welding.patch_nodes});
      return count_single_edges(patches, welding.patch_nodes);
    } catch (const InputError&) {
      return {};
    }
  };
  return weld_advice(weld, moved_by(weld) > 0, judge);
}

}  // namespace vdb_offset
