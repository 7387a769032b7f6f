#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

#include "vdb_offset/surface/overlaps.h"

namespace vdb_offset::test {
namespace {

constexpr int kEdges = 64;

/// A circle with the flow outside, or, `inward`, inside.
Patch circle(const std::string& name, double radius, double x, bool inward = false) {
  Patch patch;
  patch.name = name;
  patch.ni = kEdges + 1;
  patch.nj = 1;
  for (int i = 0; i <= kEdges; ++i) {
    const double angle = 2 * std::numbers::pi * (i % kEdges) / kEdges;
    patch.points_world.emplace_back(x + radius * std::cos(angle), radius * std::sin(angle), 0);
  }
  if (inward) std::reverse(patch.points_world.begin(), patch.points_world.end());
  return patch;
}

}  // namespace

TEST_CASE("flat overlaps: circles apart have none, those that cross share an arc each") {
  const Patch a = circle("a", 1, 0);
  CHECK(find_overlaps(build_surface({a, circle("b", 1, 2.5)})).empty());
  const double apart = 1.2;
  const auto found = find_overlaps(build_surface({a, circle("b", 1, apart)}));
  REQUIRE(found.size() == 2);
  for (const Overlap& overlap : found) {
    CHECK(overlap.other == 1 - overlap.patch);
    // The arc within the other circle spans acos(apart / 2) to both sides.
    const double edges = kEdges * std::acos(apart / 2) / std::numbers::pi;
    CHECK(std::abs(static_cast<double>(overlap.faces) - edges) <= 2);
  }
}

TEST_CASE("flat overlaps: a body within another is one; in a duct or a hollow it is none") {
  const Patch outer = circle("outer", 2, 0);
  const auto found = find_overlaps(build_surface({outer, circle("inner", 1, 0.1)}));
  REQUIRE(found.size() == 1);
  CHECK(found[0].patch == 1);
  CHECK(found[0].other == 0);
  CHECK(found[0].faces == kEdges);
  CHECK(find_overlaps(build_surface({outer, circle("hollow", 1, 0.1, true)})).empty());
  CHECK(find_overlaps(build_surface({circle("duct", 2, 0, true), circle("body", 1, 0.1)})).empty());
}

}  // namespace vdb_offset::test
