// Splines that STEP files are written with, read back through OpenCASCADE.

#include <doctest/doctest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "support/shapes.h"
#include "support/temp_folder.h"
#include "vdb_offset/io/cad.h"

namespace vdb_offset {

using test::TempFolder;

TEST_CASE("cad: STEP of a patch around a box has its flat faces, in whole edges") {
  const TempFolder folder;
  // Around three sides of a box, and a lid on one of them that is half as long: sides meet parts.
  const auto around = [](double u) -> Vec3 {
    const double s = 3 * u;
    return s < 1 ? Vec3(0, 0, s) : s < 2 ? Vec3(s - 1, 0, 1) : Vec3(1, 0, 3 - s);
  };
  Patches patches{test::make_patch("around", 13, 9, [&](double u, double v) -> Vec3 {
    // Uneven on purpose, by a factor of ten.
    const double y = (std::exp(3 * v) - 1) / (std::exp(3.0) - 1);
    return around(u) + Vec3(0, y, 0);
  })};
  Patch lid = test::make_patch("lid", 5, 5, [](double u, double v) -> Vec3 { return {u, -v, 1}; });
  for (int i = 0; i < 5; ++i) lid.at(i, 0) = patches[0].at(4 + i, 0);
  patches.push_back(lid);
  const std::string file = folder / "box.step";
  write_step(file, patches);
  const CadSurface back = read_cad(file, {.size_world = 0.1});
  CHECK(back.report.faces == 4);
  CHECK(back.report.four_sided == 4);
  // Three edges within, of ten and three that there are.
  CHECK(back.report.free_edges == 4 * 4 - 2 * 3);
  double worst = 0;
  double area = 0;
  for (const Patch& patch : back.patches) {
    for (const Vec3& p : patch.points_world) {
      const double off = std::min({std::abs(p.x()), std::abs(p.x() - 1), std::abs(p.z() - 1)});
      worst = std::max(worst, off);
    }
    for_cells(patch, [&](const std::array<int, 4>& c) {
      const auto at = [&](std::size_t n) {
        return patch.points_world[static_cast<std::size_t>(c[n])];
      };
      area += 0.5 * (at(2) - at(0)).cross(at(3) - at(1)).norm();
    });
  }
  CHECK(worst < 1e-12);
  CHECK(area == doctest::Approx(4).epsilon(1e-9));
}

TEST_CASE("cad: STEP of uneven points is a spline of fourth order, without waves") {
  const TempFolder folder;
  const auto worst_of = [&](int points) {
    // A quarter of a cylinder, steps growing by a factor of twenty from end to end.
    const Patch patch = test::make_patch("quarter", points, points, [](double u, double v) -> Vec3 {
      const double s = (std::exp(3 * u) - 1) / (std::exp(3.0) - 1);
      return {std::cos(std::numbers::pi / 2 * s), std::sin(std::numbers::pi / 2 * s), v};
    });
    write_step(folder / "quarter.step", {patch});
    const CadSurface back = read_cad(folder / "quarter.step", {.size_world = 0.01});
    double worst = 0;
    for (const Vec3& p : back.patches.front().points_world) {
      worst = std::max(worst, std::abs(p.head<2>().norm() - 1));
    }
    return worst;
  };
  const double coarse = worst_of(17);
  const double fine = worst_of(33);
  CAPTURE(coarse);
  CAPTURE(fine);
  CHECK(std::log2(coarse / fine) > 3.4);
  CHECK(fine < 2e-5);
}

}  // namespace vdb_offset
