// Columns and internal surfaces.

#include <doctest/doctest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>

#include "support/marched.h"
#include "support/shapes.h"
#include "vdb_offset/surface/example.h"

using namespace vdb_offset;
using namespace vdb_offset::test;

namespace {

constexpr double kPi = std::numbers::pi;

/// Over a flat wall z = 0 columns are straight up, and distances heights.
Patches floor_of(int points) {
  return {rectangle("floor", {points, points}, Vec3(-1, -1, 0),
                    {2 * Vec3::UnitX(), 2 * Vec3::UnitY()})};
}

Case with_sheet(const Patches& sheet, double distance = 0.5) {
  Case c{.distance = distance, .voxel = 0.05, .march = {.splay = 0}};
  c.surface.open_edges = OpenEdges::Splay;
  c.surface.internals = {{"sheet", sheet}};
  return c;
}

/// A closed curve.
Patch closed_curve(int points, const std::function<Vec3(double)>& at) {
  Patch curve{"curve", "", points, 1, {}};
  for (int n = 0; n < points; ++n) curve.points_world.push_back(at(2 * kPi * n / (points - 1)));
  curve.points_world.back() = curve.points_world.front();
  return curve;
}

Vec3 on_circle(double radius, double angle) {
  return {radius * std::cos(angle), radius * std::sin(angle), 0};
}

}  // namespace

TEST_CASE(
    "internal march: columns end where they go through a sheet, not where its plane goes on") {
  // z = 0.2 + x over 0.1 < x < 0.25 alone: beside it columns pass, and are on the sheet's other
  // side afterwards.
  const Vec3 along(0.15, 0, 0.15);
  Case c = with_sheet({rectangle("sheet", {4, 5}, Vec3(0.1, -2, 0.3), {along, 4 * Vec3::UnitY()})});
  c.surface.open_edges = OpenEdges::Auto;  // four planes
  const Marched m = marched(floor_of(41), c);
  int ended = 0;
  for (int n = 0; n < m.layers.report.nodes; ++n) {
    const Vec3 foot = m.layers.at(n, 0);
    const bool is_under = foot.x() > 0.1 - 1e-9 && foot.x() < 0.25 + 1e-9;
    const double meant = is_under ? 0.2 + foot.x() : 0.5;
    const double room = m.layers.room_world[static_cast<std::size_t>(n)];
    CAPTURE(foot.transpose());
    CHECK(room == doctest::Approx(meant).epsilon(1e-6));
    ended += is_under ? 1 : 0;
  }
  CHECK(ended == 4 * 41);
}

TEST_CASE("internal march: a lone node on a sheet takes the side that its column goes to") {
  // The sheets meet the wall along a line through the one node (0, 0) alone, and lean.
  const Vec3 line = Vec3(std::sqrt(2.0), std::sqrt(3.0), 0).normalized();
  for (const double lean : {0.5, 0.0, -0.5}) {
    CAPTURE(lean);
    const Vec3 up = Vec3(lean * line.y(), -lean * line.x(), 1);
    const Vec3 corner = -3 * line - up;
    const Marched m = marched(
        floor_of(9), with_sheet({rectangle("sheet", {7, 3}, corner, {6 * line, 2 * up})}, 0.2));
    int ended = 0;
    for (int n = 0; n < m.layers.report.nodes; ++n) {
      const Vec3 foot = m.layers.at(n, 0);
      // (x, y, z) is on the sheet at z = across / lean.
      const double across = foot.dot(Vec3(line.y(), -line.x(), 0));
      const bool is_lone = foot.norm() < 1e-12;
      const double at = lean == 0 || is_lone ? 1 : across / lean;
      const double meant = at > 0 ? std::min(at, 0.2) : 0.2;
      const double room = m.layers.room_world[static_cast<std::size_t>(n)];
      CAPTURE(foot.transpose());
      CHECK(room == doctest::Approx(meant).epsilon(1e-6));
      ended += meant < 0.2 ? 1 : 0;
      CHECK(m.on(n) == 0);
    }
    CHECK((ended > 0) == (lean != 0));
  }
}

TEST_CASE("internal march: no column leaks through the vertices of a curve in two dimensions") {
  constexpr int kSides = 40;
  constexpr double kRing = 1.05;
  const Patch circle = closed_curve(257, [](double t) { return on_circle(1, t); });
  const Patch ring = closed_curve(kSides + 1, [](double t) { return on_circle(kRing, t); });
  Case c{.distance = 0.5, .voxel = 0.1};  // steps that end far beyond the ring
  c.surface.internals = {{"ring", {ring}}};
  const Marched m = marched({circle}, c);
  CHECK(m.layers.report.internal == m.layers.report.nodes);
  for (int n = 0; n < m.layers.report.nodes; ++n) {
    const Vec3 end = m.end(n);
    // On the side of the polygon whose middle direction is nearest.
    const double side = 2 * kPi / kSides;
    const double angle = std::atan2(end.y(), end.x());
    const double middle = (std::floor(angle / side) + 0.5) * side;
    const double off =
        end.x() * std::cos(middle) + end.y() * std::sin(middle) - kRing * std::cos(0.5 * side);
    CHECK(std::abs(off) < 1e-12);
  }
}

TEST_CASE("internal march: no column leaks through edges and vertices of a sheet round a sphere") {
  Case c{.distance = 0.5, .voxel = 0.1};
  Patches shell = make_example("sphere", {.points = 9});
  for (Patch& patch : shell) {
    for (Vec3& p : patch.points_world) p *= 1.05;
  }
  c.surface.internals = {{"shell", shell}};
  // Over every fourth grid line of the wall's patches the shell has one: vertices over vertices.
  const Marched m = marched(make_example("sphere", {.points = 33}), c);
  CHECK(m.layers.report.internal == m.layers.report.nodes);
  const Boundary& boundary = m.surface.boundaries->list()[0];
  for (int n = 0; n < m.layers.report.nodes; ++n) {
    CHECK(std::abs(boundary.side(m.end(n))) < 1e-12);
  }
}

TEST_CASE("internal march: what a wall's own sheet goes on as is marched within") {
  // A wake: the sheet goes on straight behind the edge of two walls that meet at 20 degrees.
  const double half = kPi / 18;
  const Vec3 back(-std::cos(half), 0, std::sin(half));
  const Vec3 low(-std::cos(half), 0, -std::sin(half));
  const Patches wedge{rectangle("upper", {9, 9}, back, {Vec3(-back), Vec3::UnitY()}),
                      rectangle("lower", {9, 9}, Vec3(0, 0, 0), {low, Vec3::UnitY()})};
  Case c{.distance = 0.3, .voxel = 0.03};
  c.surface.internals = {
      {"wake", {rectangle("wake", {9, 9}, Vec3(0, -1, 0), {Vec3::UnitX(), 3 * Vec3::UnitY()})}}};
  const Marched m = marched(wedge, c);
  int on = 0;
  for (int n = 0; n < m.layers.report.nodes; ++n) {
    const bool is_edge = m.layers.at(n, 0).norm() < 1.01 && std::abs(m.layers.at(n, 0).x()) < 1e-12;
    const std::size_t wake = m.surface.boundaries->list().size() - 1;
    CHECK(is_edge == ((m.on(n) >> wake & 1U) != 0));
    if (!is_edge) continue;
    ++on;
    for (int k = 0; k < m.layers.levels(); ++k) CHECK(std::abs(m.layers.at(n, k).z()) < 1e-12);
    const double height = m.surface.wall->closest(m.end(n)).distance_world;
    CHECK(height == doctest::Approx(0.3).epsilon(1e-6));
  }
  CHECK(on == 9);
}
