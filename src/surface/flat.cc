// Two dimensions as three: a curve's strip between two boundary planes has the curve's own distance
// in the plane z = 0, and every stage works on it as on any surface.

#include "surface/flat.h"

#include <fmt/format.h>

#include <algorithm>

#include "surface/orient.h"
#include "vdb_offset/core/error.h"

namespace vdb_offset {

bool is_flat(const Patches& patches) {
  const auto is_curve = [](const Patch& patch) { return patch.nj == 1; };
  const auto curve = std::find_if(patches.begin(), patches.end(), is_curve);
  const auto grid = std::find_if_not(patches.begin(), patches.end(), is_curve);
  if (curve == patches.end()) return false;
  if (grid == patches.end()) return true;
  throw InputError(fmt::format(
      "{} is a curve and {} a surface: mesh either curves, in two dimensions, or surfaces",
      name_of(*curve, static_cast<int>(curve - patches.begin())),
      name_of(*grid, static_cast<int>(grid - patches.begin()))));
}

double extrude(Patches& patches, SurfaceOptions& options) {
  Box box;
  for (const Patch& patch : patches) {
    for (const Vec3& p : patch.points_world) box.add(p);
  }
  const double width = (box.hi - box.lo).head<2>().maxCoeff();
  if (!(width > 0)) throw InputError("the curves have no length");
  if (!(box.hi.z() - box.lo.z() <= kOnPlane * width)) {
    throw InputError(
        fmt::format("the curves reach from z = {:g} to z = {:g}: curves are meshed in a plane "
                    "z = const only",
                    box.lo.z(), box.hi.z()));
  }
  for (Patch& patch : patches) {
    for (Vec3& p : patch.points_world) p.z() = 0;
    const Vec3List front = patch.points_world;
    for (const Vec3& p : front) patch.points_world.emplace_back(p.x(), p.y(), width);
    patch.nj = 2;
  }
  options.planes.insert(options.planes.begin(), {{"front", {Vec3::Zero(), Vec3::UnitZ()}},
                                                 {"back", {Vec3(0, 0, width), Vec3::UnitZ()}}});
  return width;
}

}  // namespace vdb_offset
