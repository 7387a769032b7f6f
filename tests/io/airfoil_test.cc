#include "vdb_offset/io/airfoil.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <string>

#include "io/airfoil_parse.h"
#include "io/curve_points.h"
#include "io/plot3d_grid.h"
#include "support/shapes.h"
#include "vdb_offset/surface/example.h"

using namespace vdb_offset;
using plot3d_test::contains;
using plot3d_test::io_error;
using test::TempFolder;

namespace {

Patches parsed(const std::string& text, AirfoilInfo* info = nullptr) {
  AirfoilInfo found;
  Patches patches = read_airfoil_bytes(text, "wing.dat", found);
  if (info != nullptr) *info = found;
  return patches;
}

std::string refusal(const std::string& text) {
  return io_error([&] { parsed(text); });
}

/// Abbott and von Doenhoff, Theory of Wing Sections, eq. 6.2, for 12 percent.
double half_thickness(double x, double last = 0.1015) {
  return 0.12 / 0.2 *
         (0.2969 * std::sqrt(x) - 0.126 * x - 0.3516 * x * x + 0.2843 * std::pow(x, 3) -
          last * std::pow(x, 4));
}

bool is_closed(const Patch& patch) {
  return patch.points_world.front() == patch.points_world.back();
}

bool same(const Patches& a, const Patches& b) {
  return a.size() == b.size() &&
         std::equal(a.begin(), a.end(), b.begin(), [](const Patch& p, const Patch& q) {
           return p.name == q.name && p.nj == 1 && p.points_world == q.points_world;
         });
}

/// A diamond with a nose at (0, 0) and a sharp tail at (1, 0), or a blunt one.
const std::string kUpper = "0 0\n.5 .1\n";
const std::string kLower = "0 0\n.5 -.1\n";

}  // namespace

TEST_CASE("airfoil: Selig, Lednicer and halves of one section give the same curves") {
  const std::string selig = "diamond\n1 0.005\n.5 .1\n0 0\n.5 -.1\n1 -0.005\n";
  const std::string upper = kUpper + "1 0.005\n";
  const std::string lower = kLower + "1 -0.005\n";
  AirfoilInfo info;
  const Patches expected = parsed(selig, &info);
  CHECK(info.form == AirfoilForm::Selig);
  CHECK(info.title == "diamond");
  CHECK(info.blunt);
  CHECK(info.chord_world == doctest::Approx(1.0));
  REQUIRE(expected.size() == 2);
  CHECK(expected[0].ni == 5);
  CHECK(expected[0].name == "airfoil");
  CHECK(expected[0].family == "wing");
  CHECK(expected[1].family == "trailing edge");
  CHECK(enclosed_area(expected[0].points_world) > 0);
  for (const std::string& text : {"a\n 3. 3.\n\n" + upper + "\n" + lower, "3 3\n" + upper + lower,
                                  "a b 3 c\n\n3.0D0 3\n" + upper + "\n\n" + lower}) {
    CAPTURE(text);
    CHECK(same(parsed(text, &info), expected));
    CHECK(info.form == AirfoilForm::Lednicer);
    CHECK(info.repeated == 1);  // the nose
  }
  CHECK(same(parsed(upper + "\n" + lower, &info), expected));
  CHECK(info.form == AirfoilForm::Halves);
  CHECK(same(parsed("1\t.005\r\n5.0D-1,+.1\r\n\r\n0 0\r\n.5 -.1\r\n1e0 -5.E-3\r\n", &info),
             expected));
  CHECK(info.form == AirfoilForm::Selig);
}

TEST_CASE("airfoil: a clockwise file is turned round, a counter-clockwise one is not") {
  AirfoilInfo info;
  const Patches one = parsed("1 0\n.5 .1\n0 0\n.5 -.1\n1 0\n", &info);
  CHECK_FALSE(info.turned);
  const Patches other = parsed("1 0\n.5 -.1\n0 0\n.5 .1\n1 0\n", &info);
  CHECK(info.turned);
  CHECK(same(one, other));
  CHECK(one[0].at(1, 0).y() == 0.1);
}

TEST_CASE("airfoil: what the gap at the end is decides between base, closing edge and rounding") {
  AirfoilInfo info;
  const std::string middle = "\n.9 .02\n.5 .1\n0 0\n.5 -.1\n.9 -.02\n";
  const auto ends = [&](const std::string& first, const std::string& last) {
    const Patches patches = parsed(first + middle + last, &info);
    CHECK(is_closed(patches[0]) == (patches.size() == 1));
    if (patches.size() == 2) {
      CHECK(patches[1].points_world.front() == patches[0].points_world.back());
      CHECK(patches[1].points_world.back() == patches[0].points_world.front());
    }
    return patches;
  };
  CHECK(ends("1 0", "1 0")[0].ni == 7);
  CHECK_FALSE(info.end_added);
  const Patches rounded = ends("1 1e-7", "1 -1e-7");
  CHECK(rounded[0].ni == 7);
  CHECK(rounded[0].at(0, 0).y() == 0.0);  // the mean, which keeps symmetry
  CHECK(ends("1 .002", "1 -.002").size() == 2);
  CHECK(ends("1 .002", "1.003 -.002").size() == 2);  // a slanted base
  CHECK(ends("1 0", "")[0].ni == 7);
  CHECK(info.end_added);
  CHECK_FALSE(info.blunt);
  // A round body lacks a point: the gap does not turn off.
  std::string circle;
  for (int k = 0; k < 12; ++k) {
    const double angle = std::numbers::pi * k / 6;
    circle += fmt::format("{} {}\n", std::cos(angle), std::sin(angle));
  }
  const Patches round = parsed(circle, &info);
  CHECK(info.end_added);
  CHECK(round[0].ni == 13);
  // A square does, but the gap is as long as the body.
  CHECK(parsed("1 0\n1 1\n0 1\n0 0\n").size() == 1);
}

TEST_CASE(
    "airfoil: a base gets cells about as long as their neighbours, and no more than the loop") {
  const Patches patches = parsed("1 .03\n.98 .03\n.5 .1\n0 0\n.5 -.1\n.98 -.03\n1 -.03\n");
  REQUIRE(patches.size() == 2);
  CHECK(patches[1].ni == 4);
  for (int i = 0; i < 4; ++i) {
    CHECK(patches[1].at(i, 0).y() == doctest::Approx(-0.03 + 0.02 * i));
  }
  const Patches fine = parsed("1 .03\n.99999 .03\n.5 .1\n0 0\n.5 -.1\n.99999 -.03\n1 -.03\n");
  CHECK(fine[1].ni == fine[0].ni);
}

TEST_CASE("airfoil: repeated points are dropped wherever they stand") {
  AirfoilInfo info;
  const Patches patches = parsed("1 0\n1 0\n.5 .1\n0 0\n0 0\n0 0\n.5 -.1\n1 0\n1 0\n", &info);
  CHECK(info.repeated == 4);
  REQUIRE(patches.size() == 1);
  CHECK(patches[0].ni == 5);
  CHECK(is_closed(patches[0]));
}

TEST_CASE("airfoil: a name line is told from a damaged point") {
  const std::string points = "1 0\n.5 .1\n0 0\n.5 -.1\n";
  AirfoilInfo info;
  for (const char* title : {"NACA 0012", "0012", "2412 (my own)", "1 1/2 inch", "x"}) {
    parsed(std::string(title) + "\n" + points, &info);
    CHECK(info.title == title);
  }
  parsed("# made by hand\n\n\xEF\xBB\xBF" + points.substr(0, 0) + points, &info);
  CHECK(contains(refusal("1.0 O.0\n" + points), "wing.dat, line 1: y = \"O.0\" is not a number"));
  CHECK(contains(refusal("1.0\n" + points), "line 1: holds 1 words or numbers"));
}

TEST_CASE("airfoil: what is written is read back bit by bit") {
  const TempFolder scratch;
  for (const bool closed : {true, false}) {
    ExampleOptions options;
    options.closed = closed;
    options.naca = "4415";
    const Patches patches = make_example("airfoil", options);
    write_airfoil(scratch / "a.dat", patches);
    const Patches again = read_airfoil(scratch / "a.dat");
    CHECK(same(patches, again));
    CHECK(again[0].family == "a");
    CHECK(inspect_airfoil(scratch / "a.dat").title == "airfoil airfoil");
  }
  CHECK_THROWS_AS(write_airfoil(scratch / "b.dat", make_example("cube")), InputError);
  CHECK_THROWS_AS(write_airfoil(scratch / "b.dat", {}), InputError);
  Patches open = make_example("circle");
  open[0].points_world.back().x() += 1;
  CHECK_THROWS_AS(write_airfoil(scratch / "b.dat", open), InputError);
  CHECK_FALSE(std::filesystem::exists(scratch / "b.dat"));
}

TEST_CASE("airfoil: files by others give the bodies they are named after") {
  const auto data = test::shared_data();
  if (!data || !std::filesystem::is_directory(std::filesystem::path(*data) / "airfoil")) {
    MESSAGE("skipped: ../shared/data/airfoil is absent");
    return;
  }
  struct Expected {
    AirfoilForm form;
    int points;
    int base;  // points; 0: sharp
    bool turned;
  };
  const std::map<std::string, Expected> files = {
      {"prefoil_naca0012", {AirfoilForm::Halves, 131, 5, false}},
      {"prefoil_rae2822", {AirfoilForm::Selig, 121, 2, false}},
      {"pygeo_naca0012", {AirfoilForm::Selig, 160, 2, false}},
      {"pygeo_naca0012_clockwise", {AirfoilForm::Selig, 160, 2, true}},
      {"pygeo_naca0012_sharp", {AirfoilForm::Selig, 154, 0, false}},
      {"pygeo_naca0012_zeroLE", {AirfoilForm::Selig, 161, 2, false}}};
  for (const auto& [name, expected] : files) {
    CAPTURE(name);
    const auto file = std::filesystem::path(*data) / "airfoil" / (name + ".dat");
    const AirfoilInfo info = inspect_airfoil(file);
    CHECK(info.form == expected.form);
    CHECK(info.turned == expected.turned);
    CHECK(info.blunt == (expected.base > 0));
    CHECK(info.end_added == (expected.base == 0));
    CHECK(info.chord_world == doctest::Approx(1.0).epsilon(0.01));
    const Patches patches = read_airfoil(file);
    CHECK(patches[0].ni == expected.points);
    CHECK(patches.size() == (expected.base > 0 ? 2U : 1U));
    if (expected.base > 0) CHECK(patches[1].ni == expected.base);
    CHECK(enclosed_area(patches[0].points_world) > 0.07);
    if (name == "prefoil_rae2822") continue;
    for (const Vec3& p : patches[0].points_world) {
      // pyGeo's files come from a spline through its points, good to their fifth digit or so.
      const double tolerance = name == "prefoil_naca0012" ? 1e-7 : 2e-4;
      CHECK(std::abs(std::abs(p.y()) - half_thickness(p.x())) < tolerance + 2e-3 * (p.x() == 1));
    }
  }
}
