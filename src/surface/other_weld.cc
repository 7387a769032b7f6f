#include "surface/other_weld.h"

#include <fmt/format.h>

#include <algorithm>

#include "surface/orient.h"
#include "surface/weld.h"
#include "vdb_offset/core/error.h"

namespace vdb_offset {

std::string weld_advice(double weld, bool has_moved, const std::function<bool(double)>& is_sound) {
  if (has_moved) {
    for (const double part : {0.3, 0.1, 0.03, 0.01, 0.0}) {
      if (!is_sound(part * weld)) continue;
      return fmt::format(
          "; or take --weld {:g}, with which points stay apart here that --weld {:g} made one",
          part * weld, weld);
    }
  }
  for (const double larger : {0.01, 0.02, 0.05, 0.1, 0.2, 0.3}) {
    if (larger <= weld || !is_sound(larger)) continue;
    return fmt::format(
        "; or take --weld {:g}, which makes points one here that --weld {:g} does not", larger,
        weld);
  }
  return {};
}

std::string weld_advice(const Patches& unwelded, double weld) {
  if (!std::ranges::all_of(unwelded, &Patch::is_grid)) return {};
  const auto moved_by = [&](double tolerance) {
    return vdb_offset::weld(unwelded, tolerance, {}).moved_max_world;
  };
  return weld_advice(weld, moved_by(weld) > 0, [&](double tolerance) {
    Patches patches = unwelded;
    Welding welding = vdb_offset::weld(patches, tolerance, {});
    try {
      orient({patches, welding.patch_nodes});
      return true;
    } catch (const InputError&) {
      return false;
    }
  });
}

}  // namespace vdb_offset
