#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <set>
#include <string>
#include <vector>

#include "example_mesh.h"
#include "vdb_offset/surface/example.h"

using namespace vdb_offset;
using namespace vdb_offset::example_test;

TEST_CASE("draft tube: free edges lie in the inlet's and the outlet's plane") {
  for (const int points : kPoints) {
    const Mesh mesh(make("draft-tube", points));
    int inlet = 0, outlet = 0;
    for (const auto& [a, b] : mesh.free_edges()) {
      const Vec3& p = mesh.point(a);
      const Vec3& q = mesh.point(b);
      const bool at_inlet = p.z() == -0.1 && q.z() == -0.1;
      const bool at_outlet = p.x() == 3.6 && q.x() == 3.6;
      REQUIRE(at_inlet != at_outlet);
      if (at_inlet) REQUIRE(std::abs(std::hypot(p.x(), p.y()) - 0.2365) < kRounding);
      ++(at_inlet ? inlet : outlet);
    }
    CHECK(inlet > 0);
    CHECK(outlet > 0);
  }
}

TEST_CASE("draft tube: inlet and outlet faces lie in their planes") {
  for (const Patch& patch : make("draft-tube", 17, with(true, 0))) {
    for (const Vec3& p : patch.points_world) {
      if (patch.family == "inlet") REQUIRE(p.z() == -0.1);
      if (patch.family == "outlet") REQUIRE(p.x() == 3.6);
    }
  }
}

TEST_CASE("draft tube: it has the figures of Turbine-99") {
  const Patches patches = make("draft-tube", 33);
  for (const char* side : {"floor", "roof", "left", "right"}) {
    const Patch& cone = named(patches, std::string("cone ") + side);
    const Patch& elbow = named(patches, std::string("elbow ") + side);
    for (int j = 0; j < cone.nj; ++j) {
      for (int i = 0; i < cone.ni; ++i) {
        const Vec3& p = cone.at(i, j);
        const double radius = 0.2365 + (0.309 - 0.2365) * (-0.1 - p.z()) / 0.4;
        REQUIRE(std::abs(std::hypot(p.x(), p.y()) - radius) < kRounding);
      }
    }
    double last = -1;
    for (const Vec3& p : elbow.points_world) last = std::max(last, p.x());
    CHECK(std::abs(last - 0.48) < kRounding);
  }
  double floor = 0, outlet_floor = 0, width = 0;
  for (const Patch& patch : patches) {
    for (const Vec3& p : patch.points_world) {
      floor = std::min(floor, p.z());
      if (p.x() == 3.6) outlet_floor = std::min(outlet_floor, p.z());
      if (p.x() == 3.6) width = std::max(width, 2 * p.y());
    }
  }
  CHECK(std::abs(floor + 1.15) < kRounding);
  CHECK(std::abs(outlet_floor + 0.74) < kRounding);
  CHECK(std::abs(width - 1.1) < kRounding);
}

TEST_CASE("draft tube: piers start a third down the diffuser, are upright, and end at x = 3.6") {
  const Patches patches = make("draft-tube", 33);
  for (const std::string pier : {"pier 1", "pier 2"}) {
    double first = 1e9;
    const Patch& nose = named(patches, pier + " nose");
    for (const Vec3& p : nose.points_world) first = std::min(first, p.x());
    CHECK(std::abs(first - (0.48 + 3.12 / 3)) < kRounding);
    for (const char* part : {" left side", " right side"}) {
      const Patch& side = named(patches, pier + part);
      double last = 0;
      for (int i = 0; i < side.ni; ++i) {
        last = std::max(last, side.at(i, 0).x());
        for (int j = 1; j < side.nj; ++j) {
          REQUIRE(std::abs(side.at(i, j).x() - side.at(i, 0).x()) < kRounding);
          REQUIRE(std::abs(side.at(i, j).y() - side.at(i, 0).y()) < kRounding);
        }
      }
      CHECK(last == 3.6);
    }
  }
}

TEST_CASE("draft tube: it mirrors itself in y = 0") {
  const Mesh mesh(make("draft-tube", 17, with(true, 0)));
  Vec3List mirror = mesh.nodes;
  for (Vec3& p : mirror) p.y() = -p.y();
  const auto rounded = [](const Vec3& p) {
    constexpr double kGrain = 1e-9;
    return std::array<long long, 3>{std::llround(p.x() / kGrain), std::llround(p.y() / kGrain),
                                    std::llround(p.z() / kGrain)};
  };
  std::set<std::array<long long, 3>> nodes;
  for (const Vec3& p : mesh.nodes) nodes.insert(rounded(p));
  std::size_t found = 0;
  for (const Vec3& p : mirror) found += nodes.count(rounded(p));
  CHECK(found == mesh.nodes.size());
}

TEST_CASE("draft tube: its section grows along the flow, but for the piers") {
  const Patches patches = make("draft-tube", 33);
  // area of the polygon through station i of four walls, seen along its normal
  const auto areas = [&](const char* part) {
    std::vector<double> result;
    std::array<Patch, 4> wall;
    const char* sides[] = {"floor", "left", "roof", "right"};
    for (std::size_t k = 0; k < 4; ++k) {
      wall[k] = named(patches, std::string(part) + " " + sides[k]);
    }
    // stations run along i, but against it where the patch is turned
    const auto at = [&](std::size_t k, int station, int j) {
      return wall[k].at(k < 2 ? station : wall[k].ni - 1 - station, j);
    };
    for (int i = 0; i < wall[0].ni; ++i) {
      Vec3 twice = Vec3::Zero();
      Vec3 last = at(3, i, 0);
      for (std::size_t k = 0; k < 4; ++k) {
        for (int n = 0; n < wall[k].nj; ++n) {
          const Vec3 next = at(k, i, k < 2 ? n : wall[k].nj - 1 - n);
          twice += last.cross(next);
          last = next;
        }
      }
      result.push_back(0.5 * twice.norm());
    }
    return result;
  };
  double before = 0;
  for (const char* part : {"cone", "elbow", "diffuser"}) {
    for (const double area : areas(part)) {
      CAPTURE(part);
      CAPTURE(area);
      CHECK(area > before * 0.98);
      before = std::max(before, area);
    }
  }
  CHECK(areas("cone").front() == doctest::Approx(kPi * 0.2365 * 0.2365).epsilon(0.005));
}

TEST_CASE("draft tube: its volume is negative, for the normals point into the flow") {
  const auto value = [](int points) {
    return -volume(Mesh(make("draft-tube", points, with(true, 0))));
  };
  const double limit = value(65);
  CHECK(value(33) > 0.1757 * 3.6);    // more than a pipe of the inlet's section
  CHECK(value(33) < 1.1 * 0.59 * 5);  // less than one of the outlet's
  CHECK(order(value, limit) > 1.7);
}
