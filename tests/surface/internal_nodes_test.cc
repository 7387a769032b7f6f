// Internal surfaces beside the wall's nodes, and what boundaries may be called and made of.

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "support/shapes.h"
#include "vdb_offset/core/error.h"
#include "vdb_offset/surface/example.h"
#include "vdb_offset/surface/surface.h"

using namespace vdb_offset;
using namespace vdb_offset::test;

namespace {

/// A floor z = 0 and a wall x = 1 that stands on its edge, 1 x 1, normals inward.
Patches corner() {
  return {rectangle("floor", {9, 9}, Vec3(0, 0, 0), {Vec3::UnitX(), Vec3::UnitY()}),
          rectangle("side", {9, 9}, Vec3(1, 0, 0), {Vec3::UnitZ(), Vec3::UnitY()})};
}

SurfaceOptions with(const Patches& sheet) {
  SurfaceOptions options;
  options.open_edges = OpenEdges::Splay;
  options.internals = {{"sheet", sheet}};
  return options;
}

std::string refusal(const Patches& wall, const SurfaceOptions& options) {
  try {
    build_surface(wall, options);
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

bool holds(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

/// A sheet over the floor, from x = `from` to 1, between two heights at its ends.
Patches over_floor(double from, double low, double high) {
  return {rectangle("over", {5, 5}, Vec3(from, -1, low),
                    {Vec3(1 - from, 0, high - low), 3 * Vec3::UnitY()})};
}

Patch line(const std::string& name, const Vec3& from, const Vec3& to) {
  Patch curve{name, "", 9, 1, {}};
  for (int n = 0; n < 9; ++n) curve.points_world.emplace_back(from + n / 8.0 * (to - from));
  return curve;
}

}  // namespace

TEST_CASE("internal nodes: a sheet on the wall, or on part of it, is refused by both names") {
  const Patches all = corner();
  for (const Patches& sheet : {all, Patches{all[0]}, over_floor(0.6, 0, 0)}) {
    const std::string said = refusal(corner(), with(sheet));
    CAPTURE(said);
    CHECK(holds(said, "'sheet' lies on the wall"));
    CHECK((holds(said, "'floor'") || holds(said, "'side'")));
    CHECK(holds(said, "move it off"));
  }
  const Patches body = make_example("sphere", {.points = 9});
  CHECK(holds(refusal(body, with(body)), "'sheet' lies on the wall"));
  // Other facets of the same sphere go in and out of those of the wall.
  CHECK(holds(refusal(body, with(make_example("sphere", {.points = 33}))), "lies on the wall"));
}

TEST_CASE("internal nodes: a sheet that keeps clear of the wall, or stands on it, is none on it") {
  // Spacing 1/8: a twentieth of it is 6.25e-3.
  CHECK(refusal(corner(), with(over_floor(-0.5, 1e-3, 1e-3))).empty());
  CHECK(refusal(corner(), with(over_floor(-0.5, -1e-3, -1e-3))).empty());
  CHECK(refusal(corner(), with(over_floor(0.5, -0.2, 0.4))).empty());
}

TEST_CASE("internal nodes: where a sheet runs along one of two walls their edge stays") {
  // The side's last row of edges is as near to the sheet as the floor is, and at a right angle.
  const Surface surface = build_surface(corner(), with(over_floor(-0.5, 1e-3, 1e-3)));
  CHECK(std::ranges::count(surface.node_boundaries, BoundarySet{0}) ==
        static_cast<std::ptrdiff_t>(surface.node_boundaries.size()));
  CHECK(surface.report.boundary_distance_max_world == 0);
}

TEST_CASE("internal nodes: edges that a sheet stands on, or goes on from, lie on it") {
  const double off = 0.02 / 8;  // of the spacing
  for (const Vec3& up : {Vec3(0, 0, 1), Vec3(1, 0, 2), Vec3(-1, 0, 1)}) {
    const Surface surface = build_surface(
        {corner()[0]}, with({rectangle("up", {5, 5}, Vec3(0.5 + off, -1, 0) - 0.1 * up,
                                       {3 * Vec3::UnitY(), up})}));
    const auto on = std::ranges::count(surface.node_boundaries, BoundarySet{1});
    CHECK(on == 9);
    CHECK(surface.report.boundary_distance_max_world <= off);
    CHECK(surface.report.boundary_distance_max_world > 0);
  }
  // Straight on from the floor's edge.
  const Surface wake = build_surface(
      {corner()[0]},
      with({rectangle("on", {5, 5}, Vec3(1, -1, 0), {Vec3::UnitX(), 3 * Vec3::UnitY()})}));
  CHECK(std::ranges::count(wake.node_boundaries, BoundarySet{1}) == 9);
}

TEST_CASE("internal nodes: curves and surfaces do not bound each other") {
  const Patch curve = line("curve", Vec3(0, 0, 0), Vec3(1, 0, 0));
  const Patch other = line("other", Vec3(0, 0.3, 0), Vec3(1, 0.3, 0));
  CHECK(holds(refusal(corner(), with({other})), "'sheet' is made of curves"));
  CHECK(holds(refusal({curve}, with(over_floor(0, 0.3, 0.3))), "'sheet' is made of surfaces"));
  CHECK(refusal({curve}, with({other})).empty());
  SurfaceOptions shapes;
  shapes.shapes = {{"shape", {other}}};
  CHECK(holds(refusal(corner(), shapes), "'shape' is made of curves"));
}

TEST_CASE("internal nodes: boundaries are not called as parts of the wall are, given or found") {
  Patches channel = make_example("channel", {.points = 5});
  SurfaceOptions options;
  for (const char* name : {"upper", "step", "lower", "lower upstream"}) {
    CAPTURE(name);
    options = {};
    options.planes = {{name, {Vec3(0, 0, 0), Vec3::UnitX()}}};
    CHECK(holds(refusal(channel, options), "cannot be called"));
    options = {};
    options.internals = {{name, over_floor(0, 0.5, 0.5)}};
    CHECK(holds(refusal(channel, options), "of the wall; give it another"));
  }
  channel[3].family = "symmetry";
  const Surface surface = build_surface(channel);
  for (const Boundary& boundary : surface.boundaries->list()) CHECK(boundary.name() != "symmetry");
}
