#include "vdb_offset/surface/example.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "example_mesh.h"
#include "vdb_offset/core/error.h"

using namespace vdb_offset;
using namespace vdb_offset::example_test;

namespace {

struct Case {
  std::string name;
  ExampleOptions options;
  int components;
  int euler;
  int loops;  // of free edges
};

/// Euler characteristics: a sphere has 2, a torus 0, every hole takes one off. The closed draft
/// tube is a ball with two slots, open to the outlet plane, from floor to roof: still a ball, so
/// its boundary is a sphere. Open it has lost the inlet and three outlet openings: 2 - 4. A tube
/// has 0, a disc 1: the channel's walls are two.
std::vector<Case> cases() {
  return {{"sphere", {}, 1, 2, 0},
          {"cube", {}, 1, 2, 0},
          {"torus", {}, 1, 0, 0},
          {"bumpy-torus", {}, 1, 0, 0},
          {"l-bar", {}, 1, 2, 0},
          {"l-bar", with(false, 0.09), 1, 2, 0},
          {"l-bar", with(false, 0.02), 1, 2, 0},
          {"u-slot", {}, 1, 2, 0},
          {"u-slot", with(false, 0.09), 1, 2, 0},
          {"u-slot", with(false, 0.02), 1, 2, 0},
          {"wedge", notch(10), 1, 2, 0},
          {"wedge", notch(30), 1, 2, 0},
          {"wedge", notch(60), 1, 2, 0},
          {"wedge", notch(90), 1, 2, 0},
          {"wedge", notch(120), 1, 2, 0},
          {"wedge", notch(170), 1, 2, 0},
          {"star", tips(3), 1, 2, 0},
          {"star", tips(5), 1, 2, 0},
          {"star", tips(12), 1, 2, 0},
          {"sphere-pair", {}, 2, 4, 0},
          {"naca0012-wing", {}, 1, 1, 1},
          {"draft-tube", {}, 1, -2, 4},
          {"draft-tube", with(true, 0), 1, 2, 0},
          {"quarter-cylinder", {}, 1, 1, 1},
          {"wing-on-cylinder", {}, 1, 1, 1},
          {"fuselage", {}, 1, 0, 2},
          {"channel", {}, 2, 2, 2}};
}

}  // namespace

TEST_CASE("example: patches meet bit for bit, in opposite senses, with the topology promised") {
  for (const Case& c : cases()) {
    for (const int points : kPoints) {
      CAPTURE(c.name);
      CAPTURE(points);
      CAPTURE(c.options.closed);
      CAPTURE(c.options.fillet);
      CAPTURE(c.options.angle);
      CAPTURE(c.options.tips);
      const Mesh mesh(make(c.name, points, c.options));
      int most_uses = 0;
      for (const auto& [edge, uses] : mesh.directed_edges) most_uses = std::max(most_uses, uses);
      CHECK(most_uses == 1);
      CHECK(mesh.euler() == c.euler);
      std::vector<std::pair<int, int>> all;
      for (const auto& [edge, uses] : mesh.directed_edges) all.push_back(edge);
      CHECK(parts(all) == c.components);
      const auto free = mesh.free_edges();
      CHECK(parts(free) == c.loops);
      std::map<int, int> starts;  // each free edge goes on in exactly one other: loops
      for (const auto& edge : free) ++starts[edge.first];
      CHECK(std::all_of(free.begin(), free.end(),
                        [&](const auto& edge) { return starts[edge.second] == 1; }));
    }
  }
}

TEST_CASE("example: no quad is folded, degenerate or a sliver") {
  for (const Case& c : cases()) {
    for (const int points : kPoints) {
      CAPTURE(c.name);
      CAPTURE(points);
      CAPTURE(c.options.fillet);
      CAPTURE(c.options.angle);
      CAPTURE(c.options.tips);
      CHECK(worst_corner(Mesh(make(c.name, points, c.options))) > std::sin(15 * kPi / 180));
    }
  }
}

TEST_CASE("example: patches are named uniquely, sized as stored and belong to a family") {
  for (const Case& c : cases()) {
    CAPTURE(c.name);
    std::set<std::string> names, families;
    const Patches patches = make(c.name, 9, c.options);
    for (const Patch& patch : patches) {
      CHECK(names.insert(patch.name).second);
      families.insert(patch.family);
      CHECK(patch.points_world.size() ==
            static_cast<std::size_t>(patch.ni) * static_cast<std::size_t>(patch.nj));
    }
    std::set<std::string> expected{c.name};
    if (c.name == "bumpy-torus") expected = {"bumpy torus"};
    if (c.name == "sphere-pair") expected = {"body 1", "body 2"};
    if (c.name == "naca0012-wing" || c.name == "wing-on-cylinder") {
      expected = {"wing", "tip", "trailing edge"};
    }
    if (c.name == "quarter-cylinder") expected = {"side", "top", "bottom"};
    if (c.name == "channel") expected = {"lower", "upper", "step"};
    if (c.name == "draft-tube") expected = {"wall", "pier"};
    if (c.options.closed) expected.insert({"inlet", "outlet"});
    CHECK(families == expected);
  }
}

TEST_CASE("example: the list's patch counts are those made") {
  REQUIRE(examples().size() == 17);
  for (const ExampleInfo& info : examples()) {
    CAPTURE(info.summary);
    const auto count = [&](const ExampleOptions& options) {
      return std::to_string(make(info.name, 5, options).size());
    };
    CHECK(info.summary.find(" " + count({}) + " patch") != std::string::npos);
    if (info.summary.find("(") == std::string::npos) continue;
    CHECK(info.summary.find("(" + count(with(true, 0.05)) + " with") != std::string::npos);
  }
}

TEST_CASE("example: sphere points lie on the sphere, its volume rises to 4/3 pi at second order") {
  for (const Patch& patch : make("sphere", 33)) {
    for (const Vec3& p : patch.points_world) REQUIRE(std::abs(p.norm() - 1) < kRounding);
  }
  const auto value = [](int points) { return volume(Mesh(make("sphere", points))); };
  CHECK(value(33) < 4 * kPi / 3);
  CHECK(value(17) < value(33));
  CHECK(order(value, 4 * kPi / 3) == doctest::Approx(2).epsilon(0.05));
}

TEST_CASE("example: torus points lie on the torus, its volume tends to 2 pi^2 R r^2") {
  for (const Patch& patch : make("torus", 17)) {
    for (const Vec3& p : patch.points_world) {
      const double tube = std::hypot(std::hypot(p.x(), p.y()) - 1, p.z());
      REQUIRE(std::abs(tube - 0.4) < kRounding);
    }
  }
  const auto value = [](int points) { return volume(Mesh(make("torus", points))); };
  CHECK(order(value, 2 * kPi * kPi * 0.4 * 0.4) == doctest::Approx(2).epsilon(0.05));
}

TEST_CASE("example: the gap of the pair is the gap asked for") {
  ExampleOptions options;
  options.gap = 0.25;
  double left = -1e9, right = 1e9;
  for (const Patch& patch : make("sphere-pair", 9, options)) {
    for (const Vec3& p : patch.points_world) {
      (p.x() < 0 ? left : right) = p.x() < 0 ? std::max(left, p.x()) : std::min(right, p.x());
    }
  }
  CHECK(std::abs(right - left - options.gap) < kRounding);
}

TEST_CASE("example: sharp bodies enclose their volume exactly") {
  for (const int points : kPoints) {
    CAPTURE(points);
    const auto error = [&](const char* name, double exact) {
      const Mesh mesh(make(name, points));
      // one rounding a quad, of terms no larger than six times the volume
      return std::abs(volume(mesh) - exact) / static_cast<double>(mesh.quads.size());
    };
    CHECK(error("cube", 1) < kRounding);
    CHECK(error("l-bar", 0.75) < kRounding);
    CHECK(error("u-slot", 0.9) < kRounding);
  }
}

TEST_CASE("example: a fillet takes (1 - pi/4) r^2 off outer edges and adds it to inner ones") {
  const double r = 0.08;
  const double edge = (1 - kPi / 4) * r * r;
  const auto bar = [&](const char* name, int points) {
    return volume(Mesh(make(name, points, with(false, r))));
  };
  // chords of angle h take off about h^2 / 6 of a sector's area pi r^2 / 4; eight corners at most
  const double tolerance = 8 * kPi / 4 * r * r * std::pow(kPi / 4 / 2, 2) / 6;
  CHECK(std::abs(bar("l-bar", 33) - (0.75 - 4 * edge)) < tolerance);
  CHECK(std::abs(bar("u-slot", 33) - (0.9 - 4 * edge)) < tolerance);
  CHECK(tolerance < edge);
}

TEST_CASE("example: wing points lie on NACA 0012, the root in y = 0, the tip in y = 2") {
  const Patches wing = make("naca0012-wing", 33);
  for (const Patch& patch : wing) {
    for (const Vec3& p : patch.points_world) {
      if (patch.family == "wing") {
        REQUIRE(std::abs(std::abs(p.z()) - naca_half_thickness(p.x())) < kRounding);
      }
      if (patch.family == "tip") REQUIRE(p.y() == 2.0);
      if (patch.family == "trailing edge") REQUIRE(p.x() == 1.0);
    }
  }
  const Mesh mesh(wing);
  for (const auto& [a, b] : mesh.free_edges()) {
    REQUIRE(mesh.point(a).y() == 0.0);
    REQUIRE(mesh.point(b).y() == 0.0);
  }
}

TEST_CASE("example: no quad of the wing is 500 times as long as it is wide") {
  // solvers' mesh checks begin to complain there; the trailing edge is 0.0025 high, the span 2 long
  for (const int points : {17, 33, 65}) {
    double worst = 0;
    for (const Patch& patch : make("naca0012-wing", points)) {
      for (int j = 0; j + 1 < patch.nj; ++j) {
        for (int i = 0; i + 1 < patch.ni; ++i) {
          const std::array<Vec3, 5> ring{patch.at(i, j), patch.at(i + 1, j), patch.at(i + 1, j + 1),
                                         patch.at(i, j + 1), patch.at(i, j)};
          double least = 1;
          double most = 0;
          for (std::size_t n = 0; n < 4; ++n) {
            const double length = (ring[n + 1] - ring[n]).norm();
            least = std::min(least, length);
            most = std::max(most, length);
          }
          worst = std::max(worst, most / least);
        }
      }
    }
    CAPTURE(points);
    CHECK(worst < 500);
  }
}

TEST_CASE("example: the wing's volume tends to section area times half span") {
  // the open root lies in y = 0: its missing face adds nothing to the divergence theorem
  const double section =
      2 * 0.6 * (0.2969 * 2 / 3 - 0.1260 / 2 - 0.3516 / 3 + 0.2843 / 4 - 0.1015 / 5);
  const auto value = [](int points) { return volume(Mesh(make("naca0012-wing", points))); };
  CHECK(value(33) < 2 * section);
  CHECK(order(value, 2 * section) == doctest::Approx(2).epsilon(0.15));
}

TEST_CASE("example: an unknown name is refused with the names there are") {
  CHECK_THROWS_WITH_AS(make_example("teapot"), doctest::Contains("naca0012-wing"), InputError);
}

TEST_CASE("example: options out of range are refused by name") {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  ExampleOptions options;
  options.points = 2;
  CHECK_THROWS_WITH_AS(make_example("cube", options), doctest::Contains("points = 2"), InputError);
  options = {};
  options.gap = nan;
  CHECK_THROWS_WITH_AS(make_example("cube", options), doctest::Contains("gap"), InputError);
  options = {};
  options.fillet = nan;
  CHECK_THROWS_WITH_AS(make_example("cube", options), doctest::Contains("fillet"), InputError);
  options.fillet = 0.1;
  CHECK_THROWS_WITH_AS(make_example("cube", options), doctest::Contains("fillet"), InputError);
  for (const double degrees : {9.9, 170.1, nan}) {
    CHECK_THROWS_WITH_AS(make_example("cube", notch(degrees)), doctest::Contains("angle"),
                         InputError);
  }
  for (const int count : {2, 13}) {
    CHECK_THROWS_WITH_AS(make_example("cube", tips(count)), doctest::Contains("tips"), InputError);
  }
}
