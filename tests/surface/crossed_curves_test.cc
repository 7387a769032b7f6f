// Curves that cross themselves are refused by place.

#include <doctest/doctest.h>

#include <cmath>
#include <functional>
#include <numbers>
#include <string>

#include "vdb_offset/core/error.h"
#include "vdb_offset/surface/surface.h"

namespace vdb_offset::test {
namespace {

constexpr double kTurn = 2 * std::numbers::pi;

/// Through `count` pieces of a curve from t = a to t = b, closed to the bit if they are a turn
/// apart.
Patch curve(const std::string& name, int count, std::array<double, 2> range,
            const std::function<Vec3(double)>& at) {
  Patch patch;
  patch.name = name;
  patch.ni = count + 1;
  patch.nj = 1;
  for (int n = 0; n <= count; ++n) {
    patch.points_world.push_back(at(range[0] + (range[1] - range[0]) * n / count));
  }
  if (range[1] - range[0] == kTurn) patch.points_world.back() = patch.points_world.front();
  return patch;
}

Vec3 eight(double t) { return {std::sin(t), std::sin(t) * std::cos(t), 0}; }

std::string refusal(const Patches& curves) {
  try {
    refuse_crossed_cells(build_surface(curves));
  } catch (const InputError& error) {
    return error.what();
  }
  return {};
}

}  // namespace

TEST_CASE("crossed curves: a figure of eight is refused where it crosses") {
  // By symmetry at (0, 0), halfway along pieces 0 and `count` / 2 of a turn from -1/2 a piece on.
  for (const int count : {18, 50, 1000}) {
    CAPTURE(count);
    const double half = 0.5 * kTurn / count;
    const std::string said = refusal({curve("eight", count, {-half, kTurn - half}, eight)});
    CHECK(said.find("a curve crosses itself: patch 1 'eight', between points 1 and 2 and between "
                    "points " +
                    std::to_string(count / 2 + 1) + " and " + std::to_string(count / 2 + 2)) !=
          std::string::npos);
    const auto place = said.find(", at (");
    REQUIRE(place != std::string::npos);
    CHECK(std::abs(std::stod(said.substr(place + 6))) < 1e-15);
  }
  // In two patches, of which each is sound.
  const double cut = 0.25 * kTurn;
  const Patches halves{curve("a", 21, {-cut, cut}, eight), curve("b", 21, {cut, 3 * cut}, eight)};
  const std::string said = refusal(halves);
  CHECK(said.find("patch 1 'a', between points 11 and 12 and patch 2 'b', between points 11 and "
                  "12") != std::string::npos);
  CHECK(refusal({halves[0]}).empty());
}

TEST_CASE(
    "crossed curves: what touches itself in a point of its own is refused, each place counted") {
  // An arch whose top comes down to its foot's line between two points there; and below it.
  const auto arch = [](double y) {
    Patch patch = curve("arch", 6, {0, 6}, [](double t) { return Vec3(t, 0, 0); });
    patch.points_world = {{4, 0, 0}, {0, 0, 0}, {0, 2, 0}, {2, y, 0},
                          {4, 2, 0}, {5, 2, 0}, {5, 0, 0}};
    return patch;
  };
  CHECK(refusal({arch(1e-9)}).empty());
  CHECK(refusal({arch(0)}).find("crosses itself in 2 places") != std::string::npos);
  CHECK(refusal({arch(-0.1)}).find("crosses itself in 2 places") != std::string::npos);
}

TEST_CASE("crossed curves: circles, spirals and curves that cross others pass") {
  const auto circle = [](double x) {
    return curve("circle", 64, {0, kTurn},
                 [=](double t) { return Vec3(x + std::cos(t), std::sin(t), 0); });
  };
  CHECK(refusal({circle(0), circle(1)}).empty());
  const Patch spiral = curve("spiral", 500, {1, 40},
                             [](double t) { return Vec3(t * std::cos(t), t * std::sin(t), 0); });
  CHECK(refusal({spiral}).empty());
  // Limacons: r = 1 + c cos t has a loop within if c > 1.
  for (const double c : {0.9, 1.1, 1.5}) {
    CAPTURE(c);
    const Patch limacon = curve("limacon", 301, {0, kTurn}, [=](double t) -> Vec3 {
      return (1 + c * std::cos(t)) * Vec3(std::cos(t), std::sin(t), 0);
    });
    CHECK(refusal({limacon}).empty() == (c < 1));
  }
}

TEST_CASE(
    "crossed curves: points that more than two pieces share are named without a word of edges") {
  const auto spoke = [](const std::string& name, double angle) {
    return curve(name, 4, {0, 4},
                 [=](double t) { return Vec3(t * std::cos(angle), t * std::sin(angle), 0); });
  };
  const Patches star{spoke("a", 0), spoke("b", 2), spoke("c", 4)};
  const std::string said = refusal(star);
  CHECK(said.find("3 segments of curves meet in one point") != std::string::npos);
  CHECK(said.find("patch 2 'b', point 1 at (0, 0)") != std::string::npos);
  for (const char* word : {"edge", "cell", "manifold", "(0, 0, ", "(1, 1)"}) {
    CAPTURE(word);
    CHECK(said.find(word) == std::string::npos);
  }
  Patch far = spoke("far", 1);
  far.points_world[2].x() = 1e300;
  CHECK(refusal({far}).find("patch 1 'far', point 3 at (1e+300, ") != std::string::npos);
}

}  // namespace vdb_offset::test
