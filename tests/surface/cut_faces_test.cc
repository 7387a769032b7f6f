// Ducts cut by planes of symmetry: which planes the flow passes.

#include <doctest/doctest.h>

#include <cmath>
#include <map>
#include <numbers>
#include <string>

#include "support/shapes.h"
#include "vdb_offset/surface/surface.h"

namespace vdb_offset::test {
namespace {

constexpr double kPi = std::numbers::pi;

/// An angle in degrees, exact in multiples of 90.
Vec3 around(double degrees) {
  const double quarters = degrees / 90;
  if (quarters == std::round(quarters)) {
    const int n = static_cast<int>(quarters) % 4;
    return {n == 0 ? 1.0 : n == 2 ? -1.0 : 0.0, n == 1 ? 1.0 : n == 3 ? -1.0 : 0.0, 0};
  }
  return {std::cos(degrees * kPi / 180), std::sin(degrees * kPi / 180), 0};
}

/// A pipe bent by an angle in the plane y = 0, in legs of 1 and a bend of radius 2 about its middle
/// line; its section reaches from one angle to another about that line, from 0 outward in the bend.
struct Pipe {
  double turn = 0;
  double first = 0;
  double last = 180;
  double radius = 0.5;
  bool is_hub = false;  ///< the flow is outside

  Patch patch() const {
    const double legs = turn > 0 ? 1 : 2;
    const double bend = 2 * turn * kPi / 180;
    return make_patch(is_hub ? "hub" : "casing", 17, 33, [=, *this](double u, double v) -> Vec3 {
      const double s = v * (2 * legs + bend);
      const double part = std::clamp(s - legs, 0.0, bend);
      const Vec3 out(-std::cos(part / 2), 0, std::sin(part / 2));
      const Vec3 on(std::sin(part / 2), 0, std::cos(part / 2));
      const Vec3 middle = Vec3(2, 0, legs) + 2 * out + (s < legs ? s - legs : s - legs - part) * on;
      const Vec3 section = around(is_hub ? last + u * (first - last) : first + u * (last - first));
      return middle + radius * (section.x() * out + section.y() * Vec3::UnitY());
    });
  }
};

/// The kinds that planes have, without numbers.
using Kinds = std::map<std::string, std::string>;

Kinds kinds(const Patches& patches, const SurfaceOptions& options = {}) {
  const Surface surface = build_surface(patches, options);
  Kinds found;
  REQUIRE(surface.boundaries);
  for (const Boundary& boundary : surface.boundaries->list()) {
    std::string& kind = found[describe(boundary.plane())];
    kind += (kind.empty() ? "" : ", ") + boundary.name().substr(0, boundary.name().find(' '));
  }
  CHECK(surface.report.boundary_distance_max_world < 1e-14);
  return found;
}

/// The walls of a duct along z, 4 long, of height 1 between x = -1 and x = 1; normals inward.
struct Walls {
  double last = 1;  ///< x where floor and ceiling end

  Patch floor() const { return across("floor", {-1, 0, 4}, -4); }
  Patch ceiling() const { return across("ceiling", {-1, 1, 0}, 4); }
  Patch left() const {
    return rectangle("left", {5, 9}, {-1, 0, 0}, {Vec3::UnitY(), 4 * Vec3::UnitZ()});
  }
  Patch right() const {
    return rectangle("right", {5, 9}, {1, 0, 4}, {Vec3::UnitY(), -4 * Vec3::UnitZ()});
  }
  Patch across(const std::string& name, const Vec3& from, double length) const {
    return rectangle(name, {5, 9}, from,
                     {Vec3((last + 1) * Vec3::UnitX()), Vec3(length * Vec3::UnitZ())});
  }
};

/// A part of the unit sphere between angles about z, from the pole, normals outward.
Patch cap(double from, double to, double last) {
  return make_patch("cap", 17, 9, [=](double u, double v) -> Vec3 {
    const Vec3 down = around(from + v * (to - from));
    const Vec3 out = around((1 - u) * last);
    return {down.y() * out.x(), down.y() * out.y(), down.x()};
  });
}

const Kinds kHalf{{"y = 0", "symmetry"}, {"z = 0", "opening"}, {"z = 4", "opening"}};

}  // namespace

TEST_CASE("cut faces: of ducts cut by planes of symmetry the flow passes the ends") {
  CHECK(kinds({Pipe{0, 0, 360}.patch()}) == Kinds{{"z = 0", "opening"}, {"z = 4", "opening"}});
  CHECK(kinds({Pipe{}.patch()}) == kHalf);
  Kinds quarter = kHalf;
  quarter["x = 0"] = "symmetry";
  CHECK(kinds({Pipe{0, 0, 90}.patch()}) == quarter);
  CHECK(kinds({Pipe{.last = 180}.patch(), Pipe{.radius = 0.2, .is_hub = true}.patch()}) == kHalf);
  CHECK(kinds({Pipe{.last = 90}.patch(), Pipe{0, 0, 90, 0.2, true}.patch()}) == quarter);
}

TEST_CASE("cut faces: sectors end on two planes through their axis, with a hub and without") {
  for (const double angle : {2.0, 30.0, 72.0, 100.0, 120.0, 179.0, 179.9}) {
    for (const bool has_hub : {false, true}) {
      CAPTURE(angle);
      CAPTURE(has_hub);
      Patches sector{Pipe{0, 20, 20 + angle}.patch()};
      if (has_hub) sector.push_back(Pipe{0, 20, 20 + angle, 0.2, true}.patch());
      const Surface surface = build_surface(sector);
      REQUIRE(surface.boundaries->list().size() == 4);
      for (const Boundary& boundary : surface.boundaries->list()) {
        const Plane& plane = boundary.plane();
        const bool is_end = std::abs(plane.normal.z()) == 1;
        CHECK(boundary.name().substr(0, 5) == (is_end ? "openi" : "symme"));
        if (!is_end) CHECK(std::abs(plane.normal.dot(plane.point_world)) < 1e-12);
      }
      CHECK(surface.report.boundary_distance_max_world < 1e-12);
    }
  }
}

TEST_CASE("cut faces: sectors with a hub end on the planes through their axis however they lie") {
  for (const double angle : {60.0, 100.0, 120.0, 150.0, 175.0}) {
    for (const double middle : {0.0, 90.0, 180.0, 270.0, 33.0}) {
      CAPTURE(angle);
      CAPTURE(middle);
      const double first = middle - 0.5 * angle;
      const Surface surface = build_surface({Pipe{0, first, first + angle}.patch(),
                                             Pipe{0, first, first + angle, 0.2, true}.patch()});
      REQUIRE(surface.boundaries->list().size() == 4);
      for (const Boundary& boundary : surface.boundaries->list()) {
        const Plane& plane = boundary.plane();
        const bool is_end = std::abs(plane.normal.z()) == 1;
        CHECK(boundary.name().substr(0, 5) == (is_end ? "openi" : "symme"));
        if (!is_end) CHECK(std::abs(plane.normal.dot(plane.point_world)) < 1e-12);
      }
    }
  }
  // Without one the edges may as well be those of a trough that y = const cuts.
  const Kinds trough = kinds({Pipe{0, 30, 150}.patch()});
  CHECK(trough == Kinds{{"y = 0.25", "symmetry"}, {"z = 0", "opening"}, {"z = 4", "opening"}});
  CHECK(kinds({Pipe{0, 47, 167}.patch()}).size() == 4);
}

TEST_CASE(
    "cut faces: halves of bends are cut in their plane, and open at the ends, each of its own") {
  for (const bool has_hub : {false, true}) {
    CAPTURE(has_hub);
    const auto bend = [&](double turn) {
      Patches patches{Pipe{turn}.patch()};
      if (has_hub) patches.push_back(Pipe{turn, 0, 180, 0.2, true}.patch());
      return kinds(patches);
    };
    CHECK(bend(90) == Kinds{{"y = 0", "symmetry"}, {"z = 0", "opening"}, {"x = 3", "opening"}});
    CHECK(bend(180) == Kinds{{"y = 0", "symmetry"}, {"z = 0", "opening, opening"}});
  }
}

TEST_CASE(
    "cut faces: an end of half a bend whose plane the wall passes elsewhere is found, or named") {
  // One leg is longer by 0.7.
  Patch pipe = Pipe{180}.patch();
  for (int i = 0; i < pipe.ni; ++i) pipe.at(i, pipe.nj - 1).z() = -0.7;
  const Kinds found = kinds({pipe});
  CHECK(found == Kinds{{"y = 0", "symmetry"}, {"z = 0", "opening"}, {"z = -0.7", "opening"}});
  SurfaceOptions options;
  options.planes = {{"inlet", {Vec3::Zero(), Vec3::UnitZ()}}};
  const Surface surface = build_surface({pipe}, options);
  const Boundary& inlet = surface.boundaries->list()[0];
  CHECK(inlet.name() == "inlet");
  CHECK(inlet.is_local());
  CHECK(surface.free_edges_on(0) == 16);
  CHECK(surface.boundaries->list().size() == 3);
}

TEST_CASE("cut faces: points in single precision, off the axes, end on as many planes") {
  for (const double angle : {50.0, 179.0, 180.0}) {
    CAPTURE(angle);
    Patch pipe = Pipe{0, 23, 23 + angle}.patch();
    for (Vec3& p : pipe.points_world) p = p.cast<float>().cast<double>();
    const Surface surface = build_surface({pipe});
    CHECK(surface.boundaries->list().size() == (angle == 180 ? 3 : 4));
    int left = surface.free_edges();
    for (std::size_t b = 0; b < surface.boundaries->list().size(); ++b) {
      left -= surface.free_edges_on(static_cast<int>(b));
    }
    CHECK(left == 0);
  }
}

TEST_CASE("cut faces: of rectangular ducts") {
  const Walls box;
  const Walls half{0};
  CHECK(kinds({box.floor(), box.ceiling(), box.left(), box.right()}) ==
        Kinds{{"z = 0", "opening"}, {"z = 4", "opening"}});
  Kinds cut{{"x = 0", "symmetry"}, {"z = 0", "opening"}, {"z = 4", "opening"}};
  CHECK(kinds({half.floor(), half.ceiling(), half.left()}) == cut);
  cut["y = 1"] = "symmetry";
  CHECK(kinds({half.floor(), half.left()}) == cut);
  // Nothing tells the ends of two walls from their sides.
  CHECK(kinds({box.floor(), box.ceiling()}) == Kinds{{"x = -1", "opening"},
                                                     {"x = 1", "opening"},
                                                     {"z = 0", "opening"},
                                                     {"z = 4", "opening"}});
  // Rims that bend by less than passes as straight end on x = const and z = const, no other planes.
  Patch bumpy = box.floor();
  for (Vec3& p : bumpy.points_world) p.y() += 1e-7 * (p.x() * p.x() + p.z());
  const Surface nearly = build_surface({bumpy});
  for (const Boundary& boundary : nearly.boundaries->list()) {
    CHECK(boundary.plane().normal.cwiseAbs().maxCoeff() == 1);
  }
  // Beside one wall there is no end to the flow.
  CHECK(kinds({box.floor()}) == Kinds{{"x = -1", "symmetry"},
                                      {"x = 1", "symmetry"},
                                      {"z = 0", "symmetry"},
                                      {"z = 4", "symmetry"}});
}

TEST_CASE(
    "cut faces: around bodies, and where nothing tells one plane from the other, none is open") {
  const Kinds both{{"y = 0", "symmetry"}, {"z = 0", "symmetry"}};
  const Kinds all{{"x = 0", "symmetry"}, {"y = 0", "symmetry"}, {"z = 0", "symmetry"}};
  SurfaceOptions inside;
  inside.side = MarchSide::Against;
  CHECK(kinds({cap(0, 90, 360)}) == Kinds{{"z = 0", "symmetry"}});
  CHECK(kinds({cap(0, 90, 360)}, inside) == Kinds{{"z = 0", "opening"}});
  CHECK(kinds({cap(0, 90, 180)}) == both);
  CHECK(kinds({cap(0, 90, 180)}, inside) == both);
  CHECK(kinds({cap(0, 90, 90)}) == all);
  CHECK(kinds({cap(0, 90, 90)}, inside) == all);
  Kinds bar = kHalf;
  for (auto& [plane, kind] : bar) kind = "symmetry";
  CHECK(kinds({Pipe{.is_hub = true}.patch()}) == bar);
}

TEST_CASE("cut faces: half a tube with one end is open there, not where it is cut") {
  // A pipe of radius 1, and the half sphere that closes it at z = 0.
  const Patch bottom = cap(90, 180, 180);
  const Patch pipe = make_patch("pipe", 17, 9, [](double u, double v) -> Vec3 {
    return around((1 - u) * 180) + 3 * (1 - v) * Vec3::UnitZ();
  });
  SurfaceOptions inside;
  inside.side = MarchSide::Against;
  CHECK(kinds({bottom, pipe}, inside) == Kinds{{"y = 0", "symmetry"}, {"z = 3", "opening"}});
}

TEST_CASE("cut faces: bodies in a half duct go with what they are cut by") {
  // A sphere that the plane of symmetry halves, and a pipe off it from end to end.
  const Patch ball =
      mapped({cap(0, 180, 180)}, 0.2 * Eigen::Matrix3d::Identity(), Vec3(0, 0, 2))[0];
  const Patch tube = mapped({Pipe{0, 0, 360, 0.1, true}.patch()}, Eigen::Matrix3d::Identity(),
                            Vec3(0, 0.35, 0))[0];
  const Patch casing = Pipe{}.patch();
  CHECK(kinds({casing, ball, tube}) == kHalf);
  const Surface surface = build_surface({casing, ball, tube});
  for (std::size_t b = 0; b < 3; ++b) {
    const bool is_cut = describe(surface.boundaries->list()[b].plane()) == "y = 0";
    CHECK(surface.free_edges_on(static_cast<int>(b)) == (is_cut ? 2 * 32 + 2 * 8 : 16 + 16));
  }
}

TEST_CASE("cut faces: half of a channel is open where the whole is") {
  // The flow passes a cylinder, or half of one on the plane of symmetry.
  const auto cylinder = [](double last) {
    return make_patch("cylinder", 33, 9, [=](double u, double v) -> Vec3 {
      const Vec3 out = around(360 - u * last);
      return {2 * v - 1, 0.5 + 0.2 * out.y(), 2 + 0.2 * out.x()};
    });
  };
  Kinds whole = kinds({Walls{}.floor(), Walls{}.ceiling(), cylinder(360)});
  CHECK(whole["z = 0"] == "opening");
  whole["y = 0.5"] = "symmetry";
  CHECK(kinds({Walls{}.floor(), cylinder(180)}) == whole);

  const auto line = [](const char* name, const Vec3& from, const Vec3& to) {
    return make_patch(name, 9, 1, [=](double u, double) -> Vec3 { return from + u * (to - from); });
  };
  const Patch arc = make_patch("arc", 33, 1, [](double u, double) -> Vec3 {
    return Vec3(2, 0.5, 0) + 0.2 * around(180 + 180 * u);
  });
  Kinds flat = kinds({line("floor", {4, 0, 0}, {0, 0, 0}), arc});
  CHECK(flat["x = 0"] == "opening");
  CHECK(flat["x = 4"] == "opening");
  CHECK(flat["y = 0.5"] == "symmetry");
  // A plate on the ground, the flow above it: no plane of symmetry faces it.
  flat = kinds({line("plate", {4, 0, 0}, {0, 0, 0})});
  CHECK(flat["x = 0"] == "symmetry");
  CHECK(flat["x = 4"] == "symmetry");
}

TEST_CASE("cut faces: planes that are given without a name are of the same kind") {
  SurfaceOptions options;
  options.planes = {{"", {Vec3::Zero(), Vec3::UnitY()}}, {"", {Vec3(0, 0, 4), Vec3::UnitZ()}}};
  CHECK(kinds({Pipe{}.patch()}, options) == kHalf);
  options.planes.push_back({"", {Vec3::Zero(), Vec3::UnitZ()}});
  options.open_edges = OpenEdges::Splay;
  CHECK(kinds({Pipe{}.patch()}, options) == kHalf);
}

}  // namespace vdb_offset::test
