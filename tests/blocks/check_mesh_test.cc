#include "vdb_offset/blocks/check_mesh.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>
#include <tuple>

#include "support/hand_made.h"
#include "support/threads.h"

namespace vdb_offset::test {
namespace {

constexpr double kStep = 0.25;  // of all boxes, a power of two: sums are exact

/// A box of cells of kStep; `place(i, j, k)` in steps.
template <typename Place>
Zone box(const char* name, std::array<int, 3> points, const Place& place) {
  Zone zone{name, "", points[0], points[1], points[2]};
  for (int k = 0; k < zone.nk; ++k) {
    for (int j = 0; j < zone.nj; ++j) {
      for (int i = 0; i < zone.ni; ++i) zone.points_world.push_back(kStep * place(i, j, k));
    }
  }
  return zone;
}

BlockRange whole_face(const ZoneMesh& mesh, int zone, BlockFace face) {
  const Zone& z = mesh.zones[static_cast<std::size_t>(zone)];
  BlockRange range{zone, face, {0, 0, 0}, {z.ni - 1, z.nj - 1, z.nk - 1}};
  const std::size_t a = axis_of(face);
  (is_max(face) ? range.begin : range.end)[a] = (is_max(face) ? range.end : range.begin)[a];
  return range;
}

void close(ZoneMesh& mesh, int zone, const std::set<BlockFace>& but = {}) {
  for (int f = 0; f < 6; ++f) {
    const auto face = static_cast<BlockFace>(f);
    if (but.contains(face)) continue;
    mesh.boundary_faces.push_back({BoundaryKind::Wall, "wall", whole_face(mesh, zone, face)});
  }
}

/// 'left' of 4 x 3 x 2 cells, and 'right' of 2 x 4 x 3 behind its i max, whose i, j, k run along z,
/// x and y.
ZoneMesh two_boxes() {
  ZoneMesh mesh;
  mesh.zones.push_back(box("left", {5, 4, 3}, [](int i, int j, int k) { return Vec3(i, j, k); }));
  mesh.zones.push_back(
      box("right", {3, 5, 4}, [](int i, int j, int k) { return Vec3(4 + j, k, i); }));
  mesh.interfaces.push_back({whole_face(mesh, 0, BlockFace::IMax),
                             whole_face(mesh, 1, BlockFace::JMin),
                             {2, 3, 1},
                             "middle"});
  close(mesh, 0, {BlockFace::IMax});
  close(mesh, 1, {BlockFace::JMin});
  return mesh;
}

std::vector<FaultKind> kinds_of(const MeshCheck& check) {
  std::vector<FaultKind> kinds;
  for (const MeshFault& fault : check.faults) kinds.push_back(fault.kind);
  CHECK(check.fault_count == kinds.size());
  return kinds;
}

using Kinds = std::vector<FaultKind>;

TEST_CASE("check: two boxes that meet turned round have no fault, and cells that are cubes") {
  const MeshCheck check = check_mesh(two_boxes());
  CHECK(check.is_sound());
  CHECK(kinds_of(check).empty());
  CHECK(check.has_connectivity);
  CHECK(check.quality.cells == 4 * 3 * 2 + 2 * 4 * 3);
  CHECK(check.quality.min_volume == doctest::Approx(kStep * kStep * kStep).epsilon(1e-14));
  CHECK(check.quality.min_scaled_jacobian == doctest::Approx(1).epsilon(1e-14));
  CHECK(check.quality.max_aspect_ratio == doctest::Approx(1).epsilon(1e-14));
  CHECK(check.mean_scaled_jacobian == doctest::Approx(1).epsilon(1e-14));
  CHECK(check.zones.at(1).cells == 24);
  CHECK(check.interface_points == 4 * 3);
  CHECK(check.interface_distance_world == 0);
}

TEST_CASE("check: a point of an interface that is apart is found, with its place and distance") {
  ZoneMesh mesh = two_boxes();
  const double off = 0.125 * kStep;
  mesh.zones[1].at(2, 0, 1).z() += off;  // of the left: i = 4, j = 1, k = 2, from 0
  const MeshCheck check = check_mesh(mesh);
  CHECK_FALSE(check.is_sound());
  REQUIRE(kinds_of(check) == Kinds{FaultKind::Mismatch});
  const MeshFault& fault = check.faults[0];
  CHECK(fault.count == 1);
  CHECK(fault.distance_world == off);
  CHECK(fault.at == std::array<int, 3>{4, 1, 2});
  CHECK(fault.text.find("'middle'") != std::string::npos);
  CHECK(fault.text.find("i = 5, j = 2, k = 3") != std::string::npos);
}

TEST_CASE("check: points nearer than the tolerance match, and their distance is told") {
  ZoneMesh mesh = two_boxes();
  const double off = 0x1p-11 * kStep;
  static_assert(0x1p-11 < kMatchTolerance);
  mesh.zones[1].at(2, 0, 1).z() += off;
  const MeshCheck check = check_mesh(mesh);
  CHECK(check.is_sound());
  CHECK(check.interface_distance_world == off);
  mesh.zones[1].at(1, 0, 1).x() = std::numeric_limits<double>::quiet_NaN();
  CHECK(check_mesh(mesh).faults.at(0).kind == FaultKind::Mismatch);
}

TEST_CASE("check: a hole in what covers a face is found as the rectangle that it is") {
  ZoneMesh mesh = two_boxes();
  BoundaryFace& face = mesh.boundary_faces[0];
  REQUIRE(face.range.face == BlockFace::IMin);
  face.range.end[1] = 1;  // of 3 cells along j one is left
  const MeshCheck check = check_mesh(mesh);
  REQUIRE(kinds_of(check) == Kinds{FaultKind::Uncovered});
  CHECK(check.faults[0].count == 2 * 2);
  const BlockRange& range = check.faults[0].ranges.at(0);
  CHECK(range.block == 0);
  CHECK(range.face == BlockFace::IMin);
  CHECK(range.begin == std::array<int, 3>{0, 1, 0});
  CHECK(range.end == std::array<int, 3>{0, 3, 2});
}

TEST_CASE("check: a face that two boundaries cover is found, where they do") {
  ZoneMesh mesh = two_boxes();
  mesh.boundary_faces.push_back(
      {BoundaryKind::Wall, "twice", {1, BlockFace::JMax, {2, 4, 3}, {1, 4, 1}}});
  const MeshCheck check = check_mesh(mesh);
  REQUIRE(kinds_of(check) == Kinds{FaultKind::DoublyCovered});
  CHECK(check.faults[0].count == 1 * 2);
  CHECK(check.faults[0].ranges.at(0).begin == std::array<int, 3>{1, 4, 1});
  CHECK(check.faults[0].ranges.at(0).end == std::array<int, 3>{2, 4, 3});
}

TEST_CASE("check: faces that meet without an interface are gaps, seen from both sides") {
  ZoneMesh mesh = two_boxes();
  mesh.interfaces.clear();
  const MeshCheck check = check_mesh(mesh);
  REQUIRE(kinds_of(check) == Kinds{FaultKind::Gap, FaultKind::Gap});
  CHECK(check.faults[0].count == 6);
  CHECK(check.faults[0].text.find("zone 'left', i max") != std::string::npos);
  CHECK(check.faults[0].text.find("at faces of zone 'right'") != std::string::npos);
  CHECK(check.faults[1].ranges.at(0).face == BlockFace::JMin);
  for (Vec3& p : mesh.zones[1].points_world) p.x() += 0.5 * kStep;
  CHECK(kinds_of(check_mesh(mesh)) == Kinds{FaultKind::Uncovered, FaultKind::Uncovered});
}

/// A box whose j runs backward, of points that are not on a lattice.
ZoneMesh wavy_box(bool left_handed) {
  ZoneMesh mesh;
  mesh.zones.push_back(box("wavy", {6, 5, 7}, [&](int i, int j, int k) {
    const double y = left_handed ? 4 - j : j;
    return Vec3(i + 0.1 * std::sin(3 * y + k), y + 0.1 * std::cos(2 * i),
                k + 0.1 * std::sin(i * y));
  }));
  close(mesh, 0);
  return mesh;
}

TEST_CASE("check: a left-handed zone is one fault, and its cells are judged in the mirror") {
  const MeshCheck right = check_mesh(wavy_box(false));
  const MeshCheck left = check_mesh(wavy_box(true));
  CHECK(right.is_sound());
  REQUIRE(kinds_of(left) == Kinds{FaultKind::LeftHanded});
  CHECK(left.quality.nonpositive_cells == 0);
  CHECK(left.quality.min_volume == doctest::Approx(right.quality.min_volume).epsilon(1e-12));
  CHECK(left.quality.min_scaled_jacobian ==
        doctest::Approx(right.quality.min_scaled_jacobian).epsilon(1e-12));
}

using Place = std::tuple<int, int, int>;

/// Cells that are not positive, one by one; i is turned round for left-handed zones.
std::set<Place> bad_cells(const Zone& zone, bool left_handed) {
  std::set<Place> bad;
  for (int k = 0; k + 1 < zone.nk; ++k) {
    for (int j = 0; j + 1 < zone.nj; ++j) {
      for (int i = 0; i + 1 < zone.ni; ++i) {
        const int a = left_handed ? i + 1 : i;
        const int b = left_handed ? i : i + 1;
        const bool positive =
            cell_quality({zone.at(a, j, k), zone.at(b, j, k), zone.at(b, j + 1, k),
                          zone.at(a, j + 1, k), zone.at(a, j, k + 1), zone.at(b, j, k + 1),
                          zone.at(b, j + 1, k + 1), zone.at(a, j + 1, k + 1)})
                .positive;
        if (!positive) bad.insert({i, j, k});
      }
    }
  }
  return bad;
}

TEST_CASE("check: cells that are not positive are named, in left-handed zones too") {
  for (const bool left_handed : {false, true}) {
    CAPTURE(left_handed);
    ZoneMesh mesh = wavy_box(left_handed);
    mesh.zones[0].at(3, 2, 3).x() += 1.4 * kStep;  // over its neighbour
    const std::set<Place> bad = bad_cells(mesh.zones[0], left_handed);
    REQUIRE(bad.size() > 1);
    const MeshCheck check = check_mesh(mesh);
    CHECK_FALSE(check.is_sound());
    std::set<Place> named;
    for (const CellPlace& cell : check.nonpositive) {
      CHECK(cell.block == 0);
      named.insert({cell.i, cell.j, cell.k});
    }
    CHECK(named == bad);
    CHECK(check.quality.nonpositive_cells == bad.size());
    CHECK(check.faults.size() == (left_handed ? 1 : 0));
  }
}

TEST_CASE("check: a transform that does not go with its ranges is named") {
  const auto refused = [](const std::array<int, 3>& transform) {
    ZoneMesh mesh = two_boxes();
    mesh.interfaces[0].transform = transform;
    const Kinds kinds = kinds_of(check_mesh(mesh));
    return kinds == Kinds{FaultKind::Transform};
  };
  CHECK(refused({2, 2, 1}));
  CHECK(refused({2, 3, 0}));
  CHECK(refused({2, 3, 4}));
  CHECK(refused({-2, 3, 1}));  // back into the zone that it comes from
  CHECK(refused({2, 1, 3}));   // 3 cells to 2
  CHECK(refused({2, -3, 1}));  // begin to end
  CHECK(refused({3, 2, 1}));
  CHECK_FALSE(refused({2, 3, 1}));
}

TEST_CASE("check: ranges on no face of a zone are named, and leave holes") {
  ZoneMesh mesh = two_boxes();
  mesh.boundary_faces[0].range.end[2] = 9;
  mesh.boundary_faces.push_back({BoundaryKind::Wall, "line", {0, BlockFace::JMin, {}, {0, 0, 2}}});
  mesh.boundary_faces.push_back(
      {BoundaryKind::Wall, "nowhere", {7, BlockFace::JMin, {}, {1, 0, 1}}});
  const MeshCheck check = check_mesh(mesh);
  CHECK(kinds_of(check) ==
        Kinds{FaultKind::Range, FaultKind::Range, FaultKind::Range, FaultKind::Uncovered});
  CHECK(check.faults[2].text.find("zone 8, which is none") != std::string::npos);
}

TEST_CASE("check: what reading left out is a fault, and a mesh that says nothing has none") {
  ZoneMesh mesh = two_boxes();
  mesh.faults.emplace_back("zone 'left': is odd");
  CHECK(kinds_of(check_mesh(mesh)) == Kinds{FaultKind::Unreadable});
  mesh = two_boxes();
  mesh.interfaces.clear();
  mesh.boundary_faces.clear();
  const MeshCheck check = check_mesh(mesh);
  CHECK_FALSE(check.has_connectivity);
  CHECK(check.is_sound());
}

TEST_CASE("check: a block that we made is judged as 'judge' does, on any number of threads") {
  const MultiBlock mesh = wavy_plate(40, 30, 12);
  const QualityReport judged = judge(mesh).report;
  const ZoneMesh zones = zone_mesh(mesh);
  for (const std::size_t threads : {1U, 2U, 5U}) {
    const MeshCheck check = on_threads(threads, [&] { return check_mesh(zones); });
    CHECK(check.is_sound());
    CHECK(check.quality.cells == judged.cells);
    CHECK(check.quality.min_scaled_jacobian == judged.min_scaled_jacobian);
    CHECK(check.mean_scaled_jacobian ==
          doctest::Approx(judged.mean_scaled_jacobian).epsilon(1e-14));
    CHECK(check.quality.min_jacobian == judged.min_jacobian);
    CHECK(check.quality.min_volume == judged.min_volume);
    CHECK(check.quality.max_skewness == judged.max_skewness);
    CHECK(check.quality.max_aspect_ratio == judged.max_aspect_ratio);
    CHECK(check.quality.min_orthogonality == judged.min_orthogonality);
    CHECK(check.quality.growth_max == judged.growth_max);
    CHECK(check.quality.side_growth_max == judged.side_growth_max);
  }
}

}  // namespace
}  // namespace vdb_offset::test
