#include "vdb_offset/rasterize/thin_parts.h"

#include <doctest/doctest.h>

#include "support/shapes.h"
#include "support/threads.h"
#include "vdb_offset/surface/example.h"

using namespace vdb_offset;
using namespace vdb_offset::test;

namespace {

/// A cube of side 1, pressed flat to `thickness` along z.
Surface plate(double thickness) {
  Eigen::Matrix3d press = Eigen::Matrix3d::Identity();
  press(2, 2) = thickness;
  return build_surface(mapped(make_example("cube", {.points = 9}), press, Vec3::Zero()));
}

}  // namespace

TEST_CASE("thin parts: a plate thinner than two voxels is found on both sides, to its thickness") {
  constexpr double kThickness = 0.03;
  const Surface surface = plate(kThickness);
  for (const double voxel : {0.0151, 0.02, 0.029, 0.05, 0.3}) {
    CAPTURE(voxel);
    const std::vector<ThinPart> parts = thin_parts(surface, voxel);
    REQUIRE(parts.size() >= 2);
    for (const ThinPart& part : parts) {
      if (part.cells != 64) continue;
      CHECK(part.thickness_world == doctest::Approx(kThickness).epsilon(1e-9));
      CHECK(std::abs(part.place_world.z()) == doctest::Approx(kThickness / 2).epsilon(1e-9));
    }
    CHECK(std::ranges::count(parts, std::size_t{64}, &ThinPart::cells) == 2);
  }
  CHECK(thin_parts(surface, 0.0149).empty());
}

TEST_CASE("thin parts: neither a thick body, nor a gap between bodies, nor a sharp edge is thin") {
  CHECK(thin_parts(build_surface(make_example("sphere", {.points = 17})), 0.2).empty());
  CHECK(thin_parts(build_surface(make_example("sphere-pair", {.points = 17, .gap = 0.02})), 0.05)
            .empty());
  CHECK(thin_parts(build_surface(make_example("wedge", {.points = 9})), 0.05).empty());
}

TEST_CASE("thin parts: the same for any number of threads") {
  const Surface surface = plate(0.03);
  const auto once = [&] { return thin_parts(surface, 0.02).front().place_world; };
  CHECK(on_threads(1, once) == on_threads(2, once));
}
