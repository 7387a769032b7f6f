// Closed surfaces of patches whose file does not say which side is out.

#include <doctest/doctest.h>

#include <Eigen/Geometry>
#include <vector>

#include "vdb_offset/surface/example.h"
#include "vdb_offset/surface/surface.h"
#include "vdb_offset/surface/turn_round.h"

using namespace vdb_offset;

namespace {

/// The sphere of radius 1 as six patches, larger or smaller.
Patches sphere(double radius, bool inward, bool loose) {
  ExampleOptions options;
  options.points = 5;
  Patches patches = make_example("sphere", options);
  for (Patch& patch : patches) {
    for (Vec3& x : patch.points_world) x *= radius;
    if (inward) turn_round(patch);
    patch.loose = loose;
  }
  return patches;
}

Patches together(Patches a, const Patches& b) {
  a.insert(a.end(), b.begin(), b.end());
  return a;
}

/// The volume within each component, against that of the same with normals outward.
std::vector<int> senses(const Surface& surface) {
  std::vector<double> volume(static_cast<std::size_t>(surface.topology.components));
  for (std::size_t p = 0; p < surface.patches.size(); ++p) {
    const Patch& patch = surface.patches[p];
    for_cells(patch, [&](const std::array<int, 4>& c) {
      const auto at = [&](std::size_t n) { return patch.points_world[std::size_t(c[n])]; };
      volume[std::size_t(surface.topology.component[p])] +=
          at(0).dot((at(2) - at(0)).cross(at(3) - at(1)));
    });
  }
  std::vector<int> senses;
  for (const double v : volume) senses.push_back(v > 0 ? 1 : -1);
  return senses;
}

using Senses = std::vector<int>;

}  // namespace

TEST_CASE("loose patches that weld to a closed surface are turned outward, others are not") {
  for (const bool loose : {true, false}) {
    Patches patches = sphere(1, true, loose);
    turn_round(patches[2]);  // the first patch says how all are turned, unless they are loose
    const Surface surface = build_surface(patches);
    CHECK(surface.closed);
    CHECK(senses(surface) == Senses{loose ? 1 : -1});
    CHECK(surface.report.turned_parts == (loose ? 1 : 0));
    CHECK(surface.report.flipped == (loose ? std::vector{0, 1, 3, 4, 5} : std::vector{2}));
  }
  Patches mixed = sphere(1, true, true);
  mixed[3].loose = false;
  CHECK(senses(build_surface(mixed)) == Senses{-1});
  Patches open = sphere(1, true, true);
  open.pop_back();
  CHECK(senses(build_surface(open)) == Senses{-1});
  CHECK(build_surface(sphere(1, false, true)).report.turned_parts == 0);
}

TEST_CASE("loose cavities stay as they are, and bodies beside others do not") {
  const Patches outer = sphere(1, true, true);
  CHECK(senses(build_surface(together(outer, sphere(0.4, true, true)))) == Senses{1, -1});
  // Within the box of the larger one, and beside it.
  Patches beside = sphere(0.1, true, true);
  for (Patch& patch : beside) {
    for (Vec3& x : patch.points_world) x += Vec3::Constant(0.85);
  }
  const Surface both = build_surface(together(outer, beside));
  CHECK(both.report.turned_parts == 2);
}
