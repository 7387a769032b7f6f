#include "surface/example_grid.h"

// A channel over a backward-facing step: a profile in the plane y = 0, swept along y. Both sides,
// the inlet and the outlet are open.

namespace vdb_offset::example {

namespace {

constexpr double kLength = 4.0;
constexpr double kHeight = 1.0;  // of the upper wall over the floor behind the step
constexpr double kWidth = 0.5;
constexpr double kStepX = 1.0;
constexpr double kStepHeight = 0.2;

/// The wall between two points of the profile, in even cells; its normal is to the left of the way
/// from `a` to `b`, with x to the right and z up.
Patch wall(const std::string& name, const Vec3& a, const Vec3& b, const ExampleOptions& options) {
  const Curve along = line(a, b, cells(options, (b - a).norm()));
  const Curve across = line(Vec3::Zero(), Vec3(0, kWidth, 0), cells(options, kWidth));
  const int ni = static_cast<int>(along.size());
  const int nj = static_cast<int>(across.size());
  return tabulate(name, ni, nj, [&](int i, int j) -> Vec3 {
    const Vec3& p = along[static_cast<std::size_t>(i)];
    return {p.x(), across[static_cast<std::size_t>(j)].y(), p.z()};
  });
}

}  // namespace

Patches channel(const ExampleOptions& options) {
  const Vec3 lip(kStepX, 0, kStepHeight);
  const Vec3 foot(kStepX, 0, 0);
  Patches patches{wall("lower upstream", Vec3(0, 0, kStepHeight), lip, options),
                  wall("step", lip, foot, options),
                  wall("lower downstream", foot, Vec3(kLength, 0, 0), options),
                  wall("upper", Vec3(kLength, 0, kHeight), Vec3(0, 0, kHeight), options)};
  set_family(patches, "lower");
  patches[1].family = "step";
  patches[3].family = "upper";
  return patches;
}

}  // namespace vdb_offset::example
