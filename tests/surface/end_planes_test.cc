// Several openings in one plane have names of their own; bends as a plumber makes them.

#include <doctest/doctest.h>

#include <bit>
#include <cmath>
#include <numbers>
#include <string>

#include "support/shapes.h"
#include "vdb_offset/core/error.h"
#include "vdb_offset/surface/example.h"
#include "vdb_offset/surface/surface.h"

namespace vdb_offset::test {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kBend = 1.5;  // radius of the line through the middle

/// The line through the middle: up along x = 0 from y = 0, round, and down along x = 2 kBend, on to
/// y = -`beyond`; and the way out of the bend there.
std::array<Vec3, 2> middle(double part, double beyond) {
  const double length = 4 + kPi * kBend + beyond;
  const double s = part * length;
  if (s <= 2) return {Vec3(0, s, 0), -Vec3::UnitX()};
  if (s >= 2 + kPi * kBend) return {Vec3(2 * kBend, 4 + kPi * kBend - s, 0), Vec3::UnitX()};
  const double angle = (s - 2) / kBend;
  const Vec3 out(-std::cos(angle), std::sin(angle), 0);
  return {Vec3(Vec3(kBend, 2, 0) + kBend * out), out};
}

/// A pipe of a radius along it, normals inward, or as a hub outward.
Patch pipe(const std::string& name, double radius, bool is_hub = false, double beyond = 0) {
  return make_patch(name, 17, 33, [=](double u, double v) -> Vec3 {
    const auto [centre, out] = middle(v, beyond);
    const double angle = (is_hub ? -2 : 2) * kPi * (u == 1 ? 0 : u);
    return centre + radius * (std::cos(angle) * out - std::sin(angle) * Vec3::UnitZ());
  });
}

using Names = std::vector<std::string>;

Names names(const Surface& surface) {
  Names result;
  for (const Boundary& boundary : surface.boundaries->list()) result.push_back(boundary.name());
  return result;
}

/// The name of the boundary that a rim about a place has, whole.
std::string name_at(const Surface& surface, const Vec3& place) {
  std::string name;
  for (std::size_t n = 0; n < surface.nodes_world.size(); ++n) {
    const Vec3& p = surface.nodes_world[n];
    if (std::abs(p.y() - place.y()) > 1e-9 || (p - place).norm() > 1) continue;
    const BoundarySet on = surface.boundaries_of(n);
    REQUIRE(std::has_single_bit(on));
    const std::string& here =
        surface.boundaries->list()[static_cast<std::size_t>(std::countr_zero(on))].name();
    const bool is_one = name.empty() || name == here;
    CHECK(is_one);
    name = here;
  }
  return name;
}

NamedPlane at(const std::string& name, const Vec3& point) { return {name, {point, Vec3::UnitY()}}; }

NamedPlane rest(const std::string& name) { return {name, {Vec3::Zero(), Vec3::UnitY()}, true}; }

const Vec3 kFirst = Vec3::Zero();
const Vec3 kSecond(2 * kBend, 0, 0);

std::string refusal(const Patches& patches, const SurfaceOptions& options) {
  try {
    build_surface(patches, options);
  } catch (const InputError& error) {
    return error.what();
  }
  return {};
}

}  // namespace

TEST_CASE("end planes: openings apart in one plane are boundaries of their own") {
  const Surface bend = build_surface({pipe("pipe", 0.6)});
  CHECK(names(bend) == Names{"opening", "opening 2"});
  CHECK(name_at(bend, kFirst) == "opening");
  CHECK(name_at(bend, kSecond) == "opening 2");
  CHECK(bend.free_edges_on(0) == 16);
  CHECK(bend.free_edges_on(1) == 16);
  // Turned round, the flow is around the pipe: one plane that it is cut by.
  SurfaceOptions outside;
  outside.side = MarchSide::Against;
  CHECK(names(build_surface({pipe("pipe", 0.6)}, outside)) == Names{"symmetry"});
}

TEST_CASE("end planes: a hub's rim goes with its casing's") {
  const Surface bend = build_surface({pipe("casing", 0.6), pipe("hub", 0.25, true)});
  CHECK(names(bend) == Names{"opening", "opening 2"});
  CHECK(name_at(bend, kFirst) == "opening");
  CHECK(name_at(bend, kSecond) == "opening 2");
}

TEST_CASE("end planes: bays of an opening, as between piers, are one") {
  const auto bay = [](double x) {
    return make_patch("bay", 17, 5, [=](double u, double v) -> Vec3 {
      const double angle = 2 * kPi * (u == 1 ? 0 : u);
      return {x + 0.5 * std::cos(angle), v, 0.5 * std::sin(angle)};
    });
  };
  const Surface near = build_surface({bay(0), bay(1.1), bay(2.2)});
  CHECK(names(near) == Names{"opening", "opening 2"});
  CHECK(near.free_edges_on(0) == 48);
  CHECK(names(build_surface({bay(0), bay(2), bay(4)})).size() == 6);
}

TEST_CASE("end planes: a plane that is given twice is shared by the points that are given") {
  SurfaceOptions options;
  for (const bool has_hub : {false, true}) {
    CAPTURE(has_hub);
    Patches bend{pipe("casing", 0.6)};
    if (has_hub) bend.push_back(pipe("hub", 0.25, true));
    for (const bool is_turned : {false, true}) {
      const Vec3 inlet = is_turned ? kSecond : kFirst;
      const Vec3 outlet = is_turned ? kFirst : kSecond;
      for (const std::vector<NamedPlane>& planes : {std::vector{at("in", inlet), at("out", outlet)},
                                                    std::vector{rest("in"), at("out", outlet)},
                                                    std::vector{at("in", inlet), rest("out")}}) {
        options.planes = planes;
        const Surface surface = build_surface(bend, options);
        CHECK(names(surface) == Names{"in", "out"});
        CHECK(name_at(surface, inlet) == "in");
        CHECK(name_at(surface, outlet) == "out");
      }
    }
  }
  options.planes = {at("both", kSecond)};
  CHECK(names(build_surface({pipe("pipe", 0.6)}, options)) == Names{"both"});
}

TEST_CASE("end planes: openings where the wall passes their plane elsewhere are named apart too") {
  // The second leg of a larger bend ends below; that within it ends in y = 0 with both.
  const Patches bends = {pipe("pipe", 0.6), pipe("longer", 0.2, true, 0.5)};
  SurfaceOptions options;
  options.planes = {at("in", kFirst), at("out", kSecond)};
  const Surface surface = build_surface(bends, options);
  CHECK(names(surface) == Names{"in", "out", "symmetry"});
  const Vec3 off(0.6, 0, 0);
  CHECK(name_at(surface, kFirst + off) == "in");
  CHECK(name_at(surface, kSecond + off) == "out");
}

TEST_CASE("end planes: none is found that a side of a body lies in") {
  // A plate over a cube of the same width: its edges are flush with the cube's sides.
  Patches patches = make_example("cube", {.points = 5});
  double half = 0;
  for (const Vec3& p : patches[0].points_world) half = std::max(half, p.cwiseAbs().maxCoeff());
  patches.push_back(rectangle("plate", {5, 5}, {-half, -half, 3 * half},
                              {Vec3(2 * half * Vec3::UnitX()), Vec3(2 * half * Vec3::UnitY())}));
  CHECK(build_surface(patches).boundaries == nullptr);
  // Narrower, it ends on planes that the cube goes through, wider the cube ends before them.
  for (Vec3& p : patches.back().points_world) p.x() *= 1.25;
  const Surface wider = build_surface(patches);
  REQUIRE(wider.boundaries);
  REQUIRE(wider.boundaries->list().size() == 2);
  for (const Boundary& boundary : wider.boundaries->list()) {
    CHECK(std::abs(boundary.plane().normal.x()) == 1);
  }
}

TEST_CASE("end planes: names that nothing tells apart are refused with the points that would") {
  const Patches bend{pipe("pipe", 0.6)};
  SurfaceOptions options;
  options.planes = {rest("in"), rest("out")};
  const std::string which = refusal(bend, options);
  CHECK(which.find("'in', 'out'") != std::string::npos);
  CHECK(which.find("0,0,0/0,1,0 or 3,0,0/0,1,0") != std::string::npos);
  options.planes = {at("in", kFirst), at("out", Vec3(0.1, 0, 0))};
  CHECK(refusal(bend, options).find("same part") != std::string::npos);
  options.planes = {at("a", kFirst), at("b", kSecond), rest("c")};
  CHECK(refusal(bend, options).find("nothing is left for 'c'") != std::string::npos);
}

}  // namespace vdb_offset::test
