#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "example_mesh.h"
#include "vdb_offset/core/error.h"

using namespace vdb_offset;
using namespace vdb_offset::example_test;

namespace {

Patches airfoil(int points, const std::string& naca, bool closed) {
  ExampleOptions options;
  options.naca = naca;
  options.closed = closed;
  return make("airfoil", points, options);
}

/// Area on the left of the curves, by Green's theorem: positive behind normals that point outward.
double area(const Patches& curves) {
  double twice = 0;
  for (const Patch& patch : curves) {
    for (int i = 0; i + 1 < patch.ni; ++i) {
      const Vec3& a = patch.at(i, 0);
      const Vec3& b = patch.at(i + 1, 0);
      twice += a.x() * b.y() - a.y() * b.x();
    }
  }
  return twice / 2;
}

bool same_bits(const Vec3& a, const Vec3& b) {
  return a == b && std::signbit(a.x()) == std::signbit(b.x()) &&
         std::signbit(a.y()) == std::signbit(b.y());
}

/// Abbott and von Doenhoff, Theory of Wing Sections, eq. 6.2; the mean line's height is eq. 6.4.
double thickness_at(double x, double t, double last) {
  return t / 0.2 *
         (0.2969 * std::sqrt(x) - 0.126 * x - 0.3516 * x * x + 0.2843 * std::pow(x, 3) -
          last * std::pow(x, 4));
}

double mean_line(double x, double m, double p) {
  return x < p ? m / (p * p) * (2 * p * x - x * x)
               : m / ((1 - p) * (1 - p)) * (1 - 2 * p + 2 * p * x - x * x);
}

}  // namespace

TEST_CASE(
    "example: a circle has its points on the circle, closed bit for bit, its area behind it") {
  for (const int points : kPoints) {
    const Patches curves = make("circle", points);
    REQUIRE(curves.size() == 1);
    const Patch& circle = curves[0];
    CHECK(circle.ni == 4 * (points - 1) + 1);
    CHECK(circle.nj == 1);
    CHECK(circle.family == "circle");
    CHECK(same_bits(circle.points_world.front(), circle.points_world.back()));
    for (const Vec3& p : circle.points_world) {
      REQUIRE(std::abs(p.norm() - 0.5) < kRounding);
      REQUIRE(p.z() == 0);
    }
    // a polygon of n corners on the circle
    const int n = circle.ni - 1;
    CHECK(area(curves) == doctest::Approx(n / 8.0 * std::sin(2 * kPi / n)).epsilon(1e-12));
  }
}

TEST_CASE("example: a symmetric airfoil lies on its thickness law, mirrored bit for bit") {
  for (const bool closed : {false, true}) {
    for (const int points : kPoints) {
      CAPTURE(points);
      const Patches curves = airfoil(points, "0012", closed);
      const Patch& loop = curves[0];
      REQUIRE(loop.ni == 2 * points - 1);
      for (int i = 0; i < loop.ni; ++i) {
        const Vec3& p = loop.at(i, 0);
        const Vec3& other = loop.at(loop.ni - 1 - i, 0);
        REQUIRE(p.x() == other.x());
        REQUIRE(p.y() == -other.y());
        // in proportion to terms of 0.6 * 0.3
        const double exact = thickness_at(p.x(), 0.12, closed ? 0.1036 : 0.1015);
        REQUIRE(std::abs(std::abs(p.y()) - exact) < kRounding);
        const double angle = kPi * (points - 1 - i) / (points - 1);
        REQUIRE(std::abs(p.x() - (1 - std::cos(angle)) / 2) < kRounding);
      }
      CHECK(loop.at(points - 1, 0) == Vec3::Zero());
      CHECK(loop.at(1, 0).y() > 0);  // over the upper surface first: counter-clockwise
      CHECK(area(curves) > 0);
    }
  }
}

TEST_CASE("example: the trailing edge is sharp and closed, or blunt with a base of its own") {
  const Patches sharp = airfoil(33, "2412", true);
  REQUIRE(sharp.size() == 1);
  CHECK(same_bits(sharp[0].points_world.front(), sharp[0].points_world.back()));
  CHECK(sharp[0].at(0, 0).x() == 1);
  for (const int points : {9, 33, 129}) {
    const Patches blunt = airfoil(points, "2412", false);
    REQUIRE(blunt.size() == 2);
    const Patch& base = blunt[1];
    CHECK(base.family == "trailing edge");
    CHECK(same_bits(base.points_world.front(), blunt[0].points_world.back()));
    CHECK(same_bits(base.points_world.back(), blunt[0].points_world.front()));
    const double length = (base.points_world.back() - base.points_world.front()).norm();
    CHECK(length == doctest::Approx(2 * 0.00126));
    const double edge = (blunt[0].at(1, 0) - blunt[0].at(0, 0)).norm();
    const double cell = length / (base.ni - 1);
    CHECK(cell < 1.5 * std::max(edge, length / 1.5));
    if (base.ni > 2) CHECK(cell > edge / 1.5);
  }
}

TEST_CASE("example: a cambered airfoil has its mean line half way between its surfaces") {
  const Patches curves = airfoil(65, "4415", false);
  const Patch& loop = curves[0];
  for (int k = 1; k < 64; ++k) {
    const Vec3& upper = loop.at(k, 0);
    const Vec3& lower = loop.at(loop.ni - 1 - k, 0);
    const Vec3 middle = (upper + lower) / 2;
    REQUIRE(std::abs(middle.y() - mean_line(middle.x(), 0.04, 0.4)) < kRounding);
    REQUIRE(std::abs((upper - lower).norm() - 2 * thickness_at(middle.x(), 0.15, 0.1015)) <
            kRounding);
    // across the mean line, by central differences of it
    const double h = 1e-5;
    const Vec3 along(
        2 * h, mean_line(middle.x() + h, 0.04, 0.4) - mean_line(middle.x() - h, 0.04, 0.4), 0);
    REQUIRE(std::abs((upper - lower).normalized().dot(along.normalized())) < 1e-5);
  }
}

TEST_CASE("example: a section that is no NACA four-digit one is refused by name") {
  for (const char* naca : {"", "012", "00120", "00a2", "-012", "2012", "0000", "2400"}) {
    CAPTURE(naca);
    CHECK_THROWS_WITH_AS(airfoil(9, naca, false), doctest::Contains("ExampleOptions::naca = "),
                         InputError);
  }
  CHECK(airfoil(9, "0412", false)[0].points_world == airfoil(9, "0012", false)[0].points_world);
}
