#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <set>
#include <string>
#include <vector>

#include "example_mesh.h"
#include "support/shapes.h"
#include "vdb_offset/surface/example.h"
#include "vdb_offset/surface/surface.h"

// Surfaces whose free edges lie in planes or on a cylinder.

using namespace vdb_offset;
using namespace vdb_offset::example_test;

namespace {

/// Flux along the normals of the field p -> (w.x p.x, w.y p.y, w.z p.z). With weights that sum to 1
/// it is the volume behind a surface, if the field runs along the faces that are missing.
double flux(const Mesh& mesh, const Vec3& weights) {
  double sum = 0;
  for (const auto& quad : mesh.quads) {
    Vec3 mean = Vec3::Zero();
    for (const int id : quad) mean += 0.25 * mesh.point(id);
    for (std::size_t k = 0; k < 4; ++k) {
      const Vec3& a = mesh.point(quad[k]);
      const Vec3& b = mesh.point(quad[(k + 1) % 4]);
      const Vec3 area = 0.5 * (b - a).cross(mean - a);
      sum += weights.cwiseProduct((a + b + mean) / 3).dot(area);
    }
  }
  return sum;
}

/// Nodes on free edges.
std::set<int> rim(const Mesh& mesh) {
  std::set<int> nodes;
  for (const auto& [a, b] : mesh.free_edges()) nodes.insert({a, b});
  return nodes;
}

constexpr double kFuselage = 0.5;

/// Volume between the wing's section, the fuselage and the tip: over the section, the integral of
/// 2 - sqrt(R^2 - z^2); across the thickness in closed form, along the chord by the midpoint rule
/// in s = sqrt(x), where the integrand is smooth.
double exposed_volume() {
  constexpr int kSteps = 4000;
  double sum = 0;
  for (int k = 0; k < kSteps; ++k) {
    const double s = (k + 0.5) / kSteps;
    const double t = naca_half_thickness(s * s);
    const double inner = t * std::sqrt(kFuselage * kFuselage - t * t) +
                         kFuselage * kFuselage * std::asin(t / kFuselage);
    sum += (2 * (2 * t) - inner) * 2 * s / kSteps;
  }
  return sum;
}

}  // namespace

TEST_CASE("open examples: twice the cells a side are four times the quads") {
  for (const char* name : {"quarter-cylinder", "wing-on-cylinder", "fuselage", "channel"}) {
    CAPTURE(name);
    CHECK(Mesh(make(name, 33)).quads.size() == 4 * Mesh(make(name, 17)).quads.size());
  }
}

TEST_CASE("quarter cylinder: the free edges lie in x = 0 and y = 0, and nothing else does") {
  for (const int points : kPoints) {
    CAPTURE(points);
    const Mesh mesh(make("quarter-cylinder", points));
    const std::set<int> free = rim(mesh);
    std::set<double> on_axis;
    std::array<int, 2> on_plane{};
    for (int id = 0; id < static_cast<int>(mesh.nodes.size()); ++id) {
      const Vec3& p = mesh.point(id);
      REQUIRE(p.minCoeff() >= 0);
      REQUIRE_FALSE((std::signbit(p.x()) || std::signbit(p.y())));
      REQUIRE(free.contains(id) == (p.x() == 0 || p.y() == 0));
      // off the planes by more than rounding: cells are wider than this
      if (p.x() != 0) REQUIRE(p.x() > 0.25 / points);
      if (p.y() != 0) REQUIRE(p.y() > 0.25 / points);
      if (p.x() == 0 && p.y() == 0) on_axis.insert(p.z());
      on_plane[0] += p.x() == 0 ? 1 : 0;
      on_plane[1] += p.y() == 0 ? 1 : 0;
    }
    CHECK(on_axis == std::set<double>{0, 1});
    CHECK(on_plane[0] == on_plane[1]);
  }
}

TEST_CASE("quarter cylinder: the side has radius 0.5, the caps lie in z = 0 and z = 1") {
  for (const Patch& patch : make("quarter-cylinder", 33)) {
    for (const Vec3& p : patch.points_world) {
      const double radius = std::hypot(p.x(), p.y());
      if (patch.family == "side") REQUIRE(std::abs(radius - 0.5) < kRounding);
      if (patch.family == "top") REQUIRE(p.z() == 1);
      if (patch.family == "bottom") REQUIRE(p.z() == 0);
      REQUIRE(radius < 0.5 + kRounding);
      REQUIRE(p.z() <= 1);
    }
  }
}

TEST_CASE("quarter cylinder: its volume rises to pi / 16 at second order") {
  // the faces that are missing lie in x = 0 and y = 0: they add nothing
  const auto value = [](int points) { return volume(Mesh(make("quarter-cylinder", points))); };
  CHECK(value(33) < kPi / 16);
  CHECK(order(value, kPi / 16) == doctest::Approx(2).epsilon(0.05));
}

TEST_CASE("wing on cylinder: the root lies on the fuselage, the rest is the wing's") {
  for (const int points : kPoints) {
    const Patches wing = make("wing-on-cylinder", points);
    for (const Patch& patch : wing) {
      for (const Vec3& p : patch.points_world) {
        if (patch.family == "wing") {
          REQUIRE(std::abs(std::abs(p.z()) - naca_half_thickness(p.x())) < kRounding);
        }
        if (patch.family == "tip") REQUIRE(p.y() == 2);
        if (patch.family == "trailing edge") REQUIRE(p.x() == 1);
        REQUIRE(std::hypot(p.y(), p.z()) > kFuselage - kRounding);
      }
    }
    const Mesh mesh(wing);
    for (const int id : rim(mesh)) {
      const Vec3& p = mesh.point(id);
      REQUIRE(std::abs(std::hypot(p.y(), p.z()) - kFuselage) < kRounding);
      REQUIRE(p.y() > 0);
    }
  }
}

TEST_CASE("wing on cylinder: lines along the span differ from the straight ones by ever less") {
  // (1 - t) root(z) + t 2 less (1 - t) R + t 2, at the same t: their distance falls linearly
  const Patch upper = named(make("wing-on-cylinder", 33), "upper");
  const Patch straight = named(make("naca0012-wing", 33), "upper");
  for (int i = 0; i < upper.ni; ++i) {
    const double z = upper.at(i, 0).z();
    const double root = std::sqrt(kFuselage * kFuselage - z * z);
    for (int j = 0; j < upper.nj; ++j) {
      const double t = straight.at(i, j).y() / 2;
      REQUIRE(std::abs(upper.at(i, j).y() - t * 2 - (1 - t) * root) < kRounding);
    }
  }
}

TEST_CASE("wing on cylinder: the volume tends to the section's, from the fuselage to the tip") {
  // the field (x, 0, 0) runs along the fuselage, which is missing
  const auto value = [](int points) {
    return flux(Mesh(make("wing-on-cylinder", points)), Vec3::UnitX());
  };
  const double exact = exposed_volume();
  CHECK(value(33) < exact);
  CHECK(order(value, exact) == doctest::Approx(2).epsilon(0.15));
}

TEST_CASE("fuselage: points lie on the cylinder, its ends in x = -4 and x = 5") {
  for (const int points : kPoints) {
    const Mesh mesh(make("fuselage", points));
    for (const Vec3& p : mesh.nodes) {
      REQUIRE(std::abs(std::hypot(p.y(), p.z()) - kFuselage) < kRounding);
    }
    for (const int id : rim(mesh)) {
      const double x = mesh.point(id).x();
      REQUIRE((x == -4 || x == 5));
    }
  }
}

TEST_CASE("fuselage: quads leave the cylinder by less than 1e-4 of its radius from 29 points on") {
  const auto least_radius = [](int points) {
    const Mesh mesh(make("fuselage", points));
    double least = 1;
    for (const auto& quad : mesh.quads) {
      Vec3 mean = Vec3::Zero();
      for (const int id : quad) mean += 0.25 * mesh.point(id);
      least = std::min(least, std::hypot(mean.y(), mean.z()));
    }
    return least;
  };
  CHECK(least_radius(29) > (1 - 1e-4) * kFuselage);
  CHECK(least_radius(33) > (1 - 1e-4) * kFuselage);
  CHECK(order(least_radius, kFuselage) == doctest::Approx(2).epsilon(0.01));
}

TEST_CASE("fuselage: the volume behind its normals rises to that of the cylinder") {
  // the field (0, y, z) / 2 runs along the ends, which are missing
  const auto value = [](int points) {
    return flux(Mesh(make("fuselage", points)), Vec3(0, 0.5, 0.5));
  };
  const double exact = kPi * kFuselage * kFuselage * 9;
  CHECK(value(33) < exact);
  CHECK(order(value, exact) == doctest::Approx(2).epsilon(0.01));
}

TEST_CASE("channel: the free edges lie in x = 0, x = 4, y = 0 and y = 0.5, and nothing else does") {
  for (const int points : kPoints) {
    CAPTURE(points);
    const Mesh mesh(make("channel", points));
    const std::set<int> free = rim(mesh);
    for (int id = 0; id < static_cast<int>(mesh.nodes.size()); ++id) {
      const Vec3& p = mesh.point(id);
      const bool on_plane = p.x() == 0 || p.x() == 4 || p.y() == 0 || p.y() == 0.5;
      REQUIRE(free.contains(id) == on_plane);
      REQUIRE((p.x() >= 0 && p.x() <= 4 && p.y() >= 0 && p.y() <= 0.5));
    }
    for (const auto& [a, b] : mesh.free_edges()) {  // each in one plane, not across a corner
      const Vec3 step = mesh.point(b) - mesh.point(a);
      REQUIRE((step.x() == 0 || step.y() == 0));
    }
  }
}

TEST_CASE("channel: floor, step and roof lie in their planes") {
  for (const Patch& patch : make("channel", 33)) {
    for (const Vec3& p : patch.points_world) {
      if (patch.family == "upper") REQUIRE(p.z() == 1);
      if (patch.family == "step") REQUIRE((p.x() == 1 && p.z() >= 0 && p.z() <= 0.2));
      if (patch.family == "lower")
        REQUIRE(((p.x() <= 1 && p.z() == 0.2) || (p.x() >= 1 && p.z() == 0)));
    }
  }
}

TEST_CASE("channel: its normals point into a volume of 4 * 1 * 0.5 less the step's") {
  // the field (0, 0, z) runs along the sides, the inlet and the outlet, which are missing
  for (const int points : kPoints) {
    const Mesh mesh(make("channel", points));
    const double tolerance = kRounding * static_cast<double>(mesh.quads.size());
    CHECK(std::abs(flux(mesh, Vec3::UnitZ()) + (4 * 1 - 1 * 0.2) * 0.5) < tolerance);
  }
}

TEST_CASE("channel: the floor falls at a convex edge and goes on from a concave one") {
  const Patches walls = make("channel", 9);
  const auto normal = [&](const char* name) -> Vec3 {
    const Patch& wall = named(walls, name);
    return (wall.at(1, 0) - wall.at(0, 0)).cross(wall.at(0, 1) - wall.at(0, 0)).normalized();
  };
  CHECK(normal("lower upstream") == Vec3::UnitZ());
  CHECK(normal("step") == Vec3::UnitX());
  CHECK(normal("lower downstream") == Vec3::UnitZ());
  CHECK(normal("upper") == Vec3(-Vec3::UnitZ()));
}

TEST_CASE("open examples: the surface built from them is the one made") {
  for (const char* name : {"quarter-cylinder", "wing-on-cylinder", "fuselage", "channel"}) {
    CAPTURE(name);
    const Patches patches = make(name, 17);
    const Mesh mesh(patches);
    const Surface surface = build_surface(patches);
    CHECK(surface.report.flipped.empty());
    CHECK(surface.report.weld_distance_max_world == 0);
    CHECK(surface.nodes_world.size() == mesh.nodes.size());
    CHECK(surface.free_edges() == static_cast<int>(mesh.free_edges().size()));
  }
}

TEST_CASE("wall at a plane: it starts in x = 0, and the corner in the fluid has the angle") {
  for (const double degrees : {60.0, 90.0, 120.0}) {
    CAPTURE(degrees);
    const double angle = degrees * kPi / 180;
    const Patch wall = test::wall_at_plane({9, 5}, angle).front();
    const Vec3 along = wall.at(8, 0) - wall.at(0, 0);
    const Vec3 normal = along.cross(Vec3(wall.at(0, 4) - wall.at(0, 0)));
    for (int j = 0; j < 5; ++j) CHECK(wall.at(0, j).x() == 0);
    CHECK(along.x() > 0);
    // in the plane the fluid is where the normal, cut off its part across the plane, points
    const Vec3 into_fluid = Vec3(0, normal.y(), normal.z()).normalized();
    CHECK(std::abs(std::acos(along.dot(into_fluid)) - angle) < kRounding);
    CHECK(std::abs(normal.norm() - 1) < kRounding);
  }
}
