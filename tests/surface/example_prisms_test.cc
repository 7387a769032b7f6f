#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string>

#include "example_mesh.h"
#include "vdb_offset/surface/example.h"

using namespace vdb_offset;
using namespace vdb_offset::example_test;

namespace {

constexpr std::array<double, 6> kNotches{10, 30, 60, 90, 120, 170};
constexpr std::array<int, 4> kTips{3, 5, 8, 12};

/// Rounding of a sum over the quads of a mesh, of terms not above one.
double sum_rounding(const Mesh& mesh) { return kRounding * static_cast<double>(mesh.quads.size()); }

/// Sum of the quads' areas; all of them are plane.
double area(const Mesh& mesh) {
  double sum = 0;
  for (const auto& quad : mesh.quads) {
    const Vec3 diagonal = mesh.point(quad[2]) - mesh.point(quad[0]);
    sum += 0.5 * diagonal.cross(mesh.point(quad[3]) - mesh.point(quad[1])).norm();
  }
  return sum;
}

Vec3 normal(const Patch& patch) {
  const Vec3 i = patch.at(1, 0) - patch.at(0, 0);
  return i.cross(patch.at(0, 1) - patch.at(0, 0)).normalized();
}

/// Angle on the side of the normals between two plane patches: above pi at an outer edge of a body.
/// `second` is a point of the second patch off the edge.
double angle_between(const Patch& first, const Patch& second, const Vec3& on_second) {
  const double turn = std::acos(std::clamp(normal(first).dot(normal(second)), -1.0, 1.0));
  const bool inner = normal(first).dot(on_second - first.at(0, 0)) > 0;
  return inner ? kPi - turn : kPi + turn;
}

}  // namespace

TEST_CASE("wedge: the faces of the notch stand at the angle asked for, on the side of the flow") {
  for (const double degrees : kNotches) {
    CAPTURE(degrees);
    const Patches patches = make("wedge", 9, notch(degrees));
    const Patch& upper = named(patches, "notch upper");
    const Patch& lower = named(patches, "notch lower");
    // near 0 and pi an arc cosine loses half the digits
    CHECK(std::abs(angle_between(upper, lower, lower.at(0, 0)) - degrees * kPi / 180) <
          std::sqrt(kRounding));
    CHECK(upper.at(0, 0) == Vec3::Zero());  // they meet on the z axis
    CHECK(lower.at(lower.ni - 1, 0) == Vec3::Zero());
  }
}

TEST_CASE("wedge: only the notch is an inner edge") {
  for (const double degrees : kNotches) {
    const Patches patches = make("wedge", 5, notch(degrees));
    const std::array<const char*, 6> ring{"notch upper", "side 1", "side 2",
                                          "side 3",      "side 4", "notch lower"};
    for (std::size_t k = 0; k + 1 < ring.size(); ++k) {
      CAPTURE(ring[k]);
      const Patch& patch = named(patches, ring[k]);
      const Patch& next = named(patches, ring[k + 1]);
      CHECK(angle_between(patch, next, next.at(next.ni - 1, 0)) > 1.3 * kPi);
    }
  }
}

TEST_CASE("wedge: volume and area are those of a section of three kites round a circle") {
  for (const double degrees : kNotches) {
    CAPTURE(degrees);
    const Mesh mesh(make("wedge", 17, notch(degrees)));
    // each kite is two right triangles of legs r and r tan(part / 2)
    const double r = 0.5;
    const double tangent = std::tan((2 * kPi - degrees * kPi / 180) / 6);
    const double section = 3 * r * r * tangent;
    CHECK(std::abs(volume(mesh) - section) < sum_rounding(mesh));
    CHECK(std::abs(area(mesh) - (2 * section + 2 * r + 6 * r * tangent)) < sum_rounding(mesh));
  }
}

TEST_CASE("wedge: it is symmetric to the plane y = 0") {
  const Mesh mesh(make("wedge", 9, notch(50)));
  for (const Vec3& p : mesh.nodes) {
    const Vec3 mirrored(p.x(), -p.y(), p.z());
    CHECK(std::any_of(mesh.nodes.begin(), mesh.nodes.end(),
                      [&](const Vec3& q) { return (q - mirrored).norm() < kRounding; }));
  }
}

TEST_CASE("star: volume and area are those of a section of kites between its two circles") {
  for (const int count : kTips) {
    CAPTURE(count);
    const Mesh mesh(make("star", 17, tips(count)));
    const double tip = 0.5, valley = 0.25;
    const double half = kPi / count;
    const double section = count * tip * valley * std::sin(half);
    const double side = std::sqrt(tip * tip + valley * valley - 2 * tip * valley * std::cos(half));
    CHECK(std::abs(volume(mesh) - section) < sum_rounding(mesh));
    CHECK(std::abs(area(mesh) - (2 * section + 2 * count * side)) < 2 * sum_rounding(mesh));
  }
}

TEST_CASE("star: its tips are outer edges, its valleys inner ones, all of them alike") {
  for (const int count : kTips) {
    CAPTURE(count);
    const Patches patches = make("star", 5, tips(count));
    // half the tip's angle, in the triangle of centre, tip and valley
    const double half = kPi / count;
    const double tip = std::atan2(0.25 * std::sin(half), 0.5 - 0.25 * std::cos(half));
    for (int k = 1; k <= count; ++k) {
      const Patch& rise = named(patches, "rise " + std::to_string(k));
      const Patch& fall = named(patches, "fall " + std::to_string(k));
      const Patch& next = named(patches, "rise " + std::to_string(k % count + 1));
      const Vec3 end = next.at(next.ni - 1, 0);
      CHECK(angle_between(rise, fall, fall.at(fall.ni - 1, 0)) ==
            doctest::Approx(2 * kPi - 2 * tip).epsilon(1e-12));
      CHECK(angle_between(fall, next, end) == doctest::Approx(2 * (half + tip)).epsilon(1e-12));
      CHECK(std::abs(std::hypot(end.x(), end.y()) - 0.5) < kRounding);
    }
  }
}
