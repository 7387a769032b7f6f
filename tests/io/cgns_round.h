#pragma once

// What a mesh must be once it has been written and read.

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <string>
#include <tuple>
#include <vector>

#include "support/hand_made.h"
#include "support/shapes.h"
#include "vdb_offset/blocks/conditions.h"
#include "vdb_offset/blocks/zone_mesh.h"
#include "vdb_offset/surface/surface.h"

namespace vdb_offset::test {

inline bool same_bits(const Vec3List& a, const Vec3List& b) {
  return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(Vec3)) == 0;
}

/// The mesh of a surface whose points are of no meaning, no two alike.
inline MultiBlock any_mesh(const Surface& surface, int cells = 3) {
  return build_blocks(surface, any_layers(static_cast<int>(surface.nodes_world.size()), cells));
}

/// A ball of one patch: two poles, and closed on itself.
inline Patches polar_ball() {
  constexpr double kPi = 3.14159265358979323846;
  Patch ball = make_patch("ball", 9, 7, [](double u, double v) -> Vec3 {
    const double around = u == 1 ? 0 : 2 * kPi * u;
    const double down = kPi * v;
    if (v == 0 || v == 1) return {0, 0, v == 0 ? -1.0 : 1.0};
    return {std::cos(around) * std::sin(down), std::sin(around) * std::sin(down), -std::cos(down)};
  });
  ball.family = "ball's skin";
  return {ball};
}

using Numbers = std::vector<int>;

inline Numbers numbers_of(const Interface& given) {
  const Interface one = ascending(given);
  Numbers out{one.first.block, one.second.block, static_cast<int>(one.first.face),
              static_cast<int>(one.second.face)};
  for (const auto& part :
       {one.first.begin, one.first.end, one.second.begin, one.second.end, one.transform}) {
    out.insert(out.end(), part.begin(), part.end());
  }
  return out;
}

/// Interfaces in an order of their own, each from the side that comes first.
inline std::vector<Numbers> all_of(const std::vector<Interface>& interfaces) {
  std::vector<Numbers> out;
  for (const Interface& one : interfaces) {
    out.push_back(std::min(numbers_of(one), numbers_of(reversed(one))));
  }
  std::ranges::sort(out);
  return out;
}

using FaceFacts = std::tuple<Numbers, std::string, std::string, int>;

/// A file knows free faces by their conditions alone.
inline BoundaryKind kind_in_file(const BoundaryFace& face) {
  if (face.kind != BoundaryKind::Free) return face.kind;
  const ConditionKind kind = face.condition.kind;
  const bool is_outer = kind == ConditionKind::Farfield || kind == ConditionKind::Overset;
  return is_outer ? BoundaryKind::Outer : BoundaryKind::Boundary;
}

/// Names of degenerate faces are those of their nodes, which are numbered.
inline std::vector<FaceFacts> all_of(const std::vector<BoundaryFace>& faces) {
  std::vector<FaceFacts> out;
  for (const BoundaryFace& face : faces) {
    const BlockRange range = ascending(face.range);
    Numbers numbers{range.block, static_cast<int>(range.face)};
    numbers.insert(numbers.end(), range.begin.begin(), range.begin.end());
    numbers.insert(numbers.end(), range.end.begin(), range.end.end());
    const BoundaryKind kind = kind_in_file(face);
    out.emplace_back(numbers, kind == BoundaryKind::Degenerate ? "" : face.name,
                     describe(face.condition), static_cast<int>(kind));
  }
  std::ranges::sort(out);
  return out;
}

inline void check_same(const ZoneMesh& meant, const ZoneMesh& read) {
  CHECK(read.faults == std::vector<std::string>{});
  REQUIRE(read.zones.size() == meant.zones.size());
  for (std::size_t z = 0; z < meant.zones.size(); ++z) {
    // A family may have the name already.
    CHECK(read.zones[z].name.starts_with(meant.zones[z].name));
    CHECK(read.zones[z].ni == meant.zones[z].ni);
    CHECK(read.zones[z].nj == meant.zones[z].nj);
    CHECK(read.zones[z].nk == meant.zones[z].nk);
    CHECK(same_bits(read.zones[z].points_world, meant.zones[z].points_world));
  }
  CHECK(all_of(read.interfaces) == all_of(meant.interfaces));
  CHECK(all_of(read.boundary_faces) == all_of(meant.boundary_faces));
}

}  // namespace vdb_offset::test
