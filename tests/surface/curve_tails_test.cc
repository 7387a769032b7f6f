// What the ends of open curves end on.

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

#include "support/shapes.h"
#include "vdb_offset/core/error.h"
#include "vdb_offset/surface/surface.h"

namespace vdb_offset::test {
namespace {

Patch curve(const Vec3List& points) {
  Patch patch;
  patch.name = "curve";
  patch.ni = static_cast<int>(points.size());
  patch.nj = 1;
  patch.points_world = points;
  return patch;
}

/// Of a circle about (x, y), by degrees; sines and cosines of right angles to the bit.
Vec3List arc(double from, double to, const Vec3& middle = Vec3::Zero(), double radius = 1) {
  Vec3List points;
  for (int n = 0; n <= 24; ++n) {
    const double angle = (from + (to - from) * n / 24) * std::numbers::pi / 180;
    const auto tidy = [](double x) { return std::abs(x) < 1e-15 ? 0.0 : x; };
    points.emplace_back(middle + radius * Vec3(tidy(std::cos(angle)), tidy(std::sin(angle)), 0));
  }
  return points;
}

/// From the trailing edge over the top to the trailing edge, thick as t there.
Vec3List airfoil(double t) {
  Vec3List points;
  for (int n = -30; n <= 30; ++n) {
    const double x = std::pow(n / 30.0, 2);
    const double y = 0.3 * std::sqrt(x) * (1 - x) + 0.5 * t * x;
    points.emplace_back(x, n < 0 ? y : -y, 0);
  }
  return points;
}

/// Names and lines, "symmetry x = 0; ", of what is found.
std::string ends(const Patches& curves, MarchSide side = MarchSide::Along) {
  SurfaceOptions options;
  options.side = side;
  const Surface surface = build_surface(curves, options);
  std::string text;
  const std::vector<Boundary>& list = surface.boundaries->list();
  for (std::size_t b = Surface::kFlatPlanes; b < list.size(); ++b) {
    text += list[b].name() + " " + describe(list[b].plane(), true) + "; ";
  }
  return text;
}

std::string refusal(const Patches& curves, const SurfaceOptions& options) {
  try {
    build_surface(curves, options);
  } catch (const InputError& error) {
    return error.what();
  }
  return {};
}

}  // namespace

TEST_CASE("curve ends: models of a half and a quarter end on their lines of symmetry") {
  CHECK(ends({curve(arc(0, 180))}) == "symmetry y = 0; ");
  CHECK(ends({curve(arc(0, 90))}) == "symmetry x = 0; symmetry 2 y = 0; ");
  CHECK(ends({curve(arc(-90, 90))}) == "symmetry x = 0; ");
  // Sharp at the one end.
  Vec3List half = airfoil(0);
  half.resize(31);
  CHECK(ends({curve(half)}) == "symmetry y = 0; ");
}

TEST_CASE("curve ends: a corner ends across its sides, not along its diagonal") {
  const Patch corner = curve({{1, 0, 0}, {0.5, 0, 0}, {0, 0, 0}, {0, 0.5, 0}, {0, 1, 0}});
  CHECK(ends({corner}) == "symmetry x = 1; symmetry 2 y = 1; ");
  CHECK(ends({curve({{0, 0, 0}, {0.5, 0, 0}, {1, 0, 0}})}) == "symmetry x = 0; symmetry 2 x = 1; ");
}

TEST_CASE("curve ends: two walls that face each other are open at both ends") {
  Vec3List floor;
  Vec3List roof;
  for (int n = 0; n <= 20; ++n) {
    const double x = 0.2 * n;
    floor.emplace_back(x, -0.25 * x, 0);
    roof.emplace_back(4 - x, 1, 0);
  }
  CHECK(ends({curve(floor), curve(roof)}, MarchSide::Against) ==
        "opening x = 0; opening 2 x = 4; ");
}

TEST_CASE("curve ends: the two ends of a bend in one line are two openings, and named apart") {
  const auto leg = [](double radius, bool turned) {
    Vec3List points = arc(180, 0, Vec3(1.5, 1, 0), radius);
    points.insert(points.begin(), Vec3(1.5 - radius, 0, 0));
    points.emplace_back(1.5 + radius, 0, 0);
    if (turned) std::reverse(points.begin(), points.end());
    return curve(points);
  };
  const Patches bend{leg(0.9, false), leg(1.5, true)};
  CHECK(ends(bend, MarchSide::Against) == "opening y = 0; opening 2 y = 0; ");
  SurfaceOptions options;
  options.side = MarchSide::Against;
  options.planes = {{"in", {Vec3(2.7, 0, 0), Vec3::UnitY()}},
                    {"out", {Vec3::Zero(), Vec3::UnitY()}, true}};
  const Surface surface = build_surface(bend, options);
  for (std::size_t n = 0; n < surface.nodes_world.size(); ++n) {
    const Vec3& p = surface.nodes_world[n];
    if (p.y() != 0) continue;
    const BoundarySet named = surface.boundaries_of(n) >> Surface::kFlatPlanes;
    CHECK(named == (p.x() > 1.5 ? 1U : 2U));
  }
  // Between two bodies on a line of symmetry is no opening.
  const Patches bumps{curve(arc(0, 180)), curve(arc(0, 180, Vec3(3, 0, 0)))};
  CHECK(ends(bumps) == "symmetry y = 0; ");
}

TEST_CASE("curve ends: an open trailing edge splays, or is refused, as a free edge is") {
  for (const double thick : {1e-3, 0.0025, 0.1}) {
    CAPTURE(thick);
    const Patch foil = curve(airfoil(thick));
    CHECK(ends({foil}) == "");
    SurfaceOptions options;
    const Surface surface = build_surface({foil}, options);
    REQUIRE(surface.report.open_tails.size() == 1);
    const auto& [a, b] = surface.report.open_tails[0];
    CHECK((a - b).norm() == doctest::Approx(thick).epsilon(1e-12));
    CHECK(surface.free_edges() == 2);
    options.open_edges = OpenEdges::Refuse;
    const std::string said = refusal({foil}, options);
    CHECK(said.find("'curve', its first point, at (1, ") != std::string::npos);
    CHECK(said.find("close the trailing edge") != std::string::npos);
    CHECK(said.find("imin") == std::string::npos);
    options.planes = {{"base", {Vec3(1, 0, 0), Vec3::UnitX()}}};
    CHECK(refusal({foil}, options).empty());
  }
}

TEST_CASE("curve ends: a line has two numbers, and the curves' own plane bounds nothing") {
  SurfaceOptions options;
  options.planes = {{"side", {Vec3::Zero(), Vec3::UnitZ()}}};
  const Patch half = curve(arc(0, 180));
  CHECK(refusal({half}, options).find("z = 0, 'side': in two dimensions") != std::string::npos);
  options.planes = {{"line", {Vec3::Zero(), Vec3::UnitY()}, false, true}};
  CHECK(refusal({half}, options).empty());
  const Patch sheet = rectangle("sheet", {3, 3}, Vec3::Zero(), {Vec3::UnitX(), Vec3::UnitY()});
  CHECK(refusal({sheet}, options).find("for curves; for surfaces") != std::string::npos);
}

}  // namespace vdb_offset::test
