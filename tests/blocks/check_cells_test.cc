// Meshes without blocks: what is found, on cells put together by hand.

#include <doctest/doctest.h>

#include <array>
#include <cmath>
#include <string>
#include <vector>

#include "vdb_offset/blocks/check_cells.h"

namespace vdb_offset::test {
namespace {

using List = std::vector<std::int32_t>;

/// `n` unit cubes in a row along x, with all their outer faces in the boundary "all".
CellZone row(int n) {
  CellZone mesh;
  for (int i = 0; i <= n; ++i) {
    for (const auto& [y, z] : {std::array{0, 0}, {1, 0}, {1, 1}, {0, 1}}) {
      mesh.points_world.emplace_back(i, y, z);
    }
  }
  CellBoundary all{"all"};
  for (std::int32_t i = 0; i < n; ++i) {
    const std::int32_t a = 4 * i;
    const std::int32_t b = a + 4;
    mesh.add(CellKind::Hexahedron, List{a, b, b + 1, a + 1, a + 3, b + 3, b + 2, a + 2});
    for (std::int32_t s = 0; s < 4; ++s) {
      all.faces.add(List{a + s, a + (s + 1) % 4, b + (s + 1) % 4, b + s});
    }
  }
  all.faces.add(List{0, 1, 2, 3});
  all.faces.add(List{4 * n, 4 * n + 1, 4 * n + 2, 4 * n + 3});
  mesh.boundaries.push_back(all);
  return mesh;
}

/// The only fault there is.
FaultKind only_fault(const CellZone& mesh) {
  const CellCheck check = check_cells(mesh);
  REQUIRE(check.fault_count == 1);
  CHECK(!check.is_sound());
  return check.faults[0].kind;
}

}  // namespace

TEST_CASE("check cells: cubes are sound, of scaled Jacobian 1 and volume 1") {
  const CellCheck check = check_cells(row(3));
  CHECK(check.is_sound());
  CHECK(check.quality.cells == 3);
  CHECK(check.quality.min_scaled_jacobian == doctest::Approx(1));
  CHECK(check.mean_scaled_jacobian == doctest::Approx(1));
  CHECK(check.quality.min_volume == doctest::Approx(1));
  CHECK(check.inner_faces == 2);
  CHECK(check.boundary_faces == 14);
}

TEST_CASE("check cells: each way not to fit is named") {
  CellZone uncovered = row(2);
  uncovered.boundaries[0].faces.points.resize(4 * 9);
  uncovered.boundaries[0].faces.first.pop_back();
  CHECK(only_fault(uncovered) == FaultKind::Uncovered);

  CellZone twice = row(2);
  twice.boundaries.push_back({"again"});
  twice.boundaries[1].faces.add(List{3, 2, 1, 0});
  CHECK(only_fault(twice) == FaultKind::DoublyCovered);

  CellZone nowhere = row(2);
  nowhere.boundaries[0].faces.add(List{0, 2, 11});
  CHECK(only_fault(nowhere) == FaultKind::Range);

  CellZone unused = row(2);
  unused.points_world.emplace_back(9, 9, 9);
  CHECK(only_fault(unused) == FaultKind::Unused);

  CellZone within = row(2);
  within.boundaries[0].faces.add(List{4, 5, 6, 7});
  CHECK(only_fault(within) == FaultKind::DoublyCovered);
}

TEST_CASE("check cells: faces in one place with points of their own are a gap") {
  CellZone mesh = row(2);
  for (int p = 4; p < 8; ++p) mesh.points_world.push_back(mesh.points_world[4]);
  for (int s = 0; s < 4; ++s) {
    mesh.points_world[static_cast<std::size_t>(12 + s)] =
        mesh.points_world[static_cast<std::size_t>(4 + s)];
  }
  const auto apart = [](std::int32_t& p) { p += p >= 4 && p < 8 ? 8 : 0; };
  for (std::size_t n = 8; n < 16; ++n) apart(mesh.cells.points[n]);  // the second cell
  for (std::size_t n = 16; n < 32; ++n) apart(mesh.boundaries[0].faces.points[n]);
  CHECK(only_fault(mesh) == FaultKind::Gap);
}

TEST_CASE("check cells: a mesh in the mirror is left-handed, and judged as its image") {
  CellZone mesh = row(3);
  for (Vec3& p : mesh.points_world) p.z() = -p.z();
  const CellCheck check = check_cells(mesh);
  REQUIRE(check.fault_count == 1);
  CHECK(check.faults[0].kind == FaultKind::LeftHanded);
  CHECK(check.quality.nonpositive_cells == 0);
  CHECK(check.quality.min_volume == doctest::Approx(1));
}

TEST_CASE("check cells: one cell turned over is not positive, and sees its faces from within") {
  CellZone mesh = row(3);
  for (std::size_t n = 0; n < 4; ++n) std::swap(mesh.cells.points[n], mesh.cells.points[n + 4]);
  const CellCheck check = check_cells(mesh);
  CHECK(check.quality.nonpositive_cells == 1);
  REQUIRE(check.nonpositive.size() == 1);
  CHECK(check.nonpositive[0].cell == 0);
  CHECK((check.nonpositive[0].middle_world - Vec3(0.5, 0.5, 0.5)).norm() < 1e-12);
  REQUIRE(check.fault_count == 1);
  CHECK(check.faults[0].kind == FaultKind::Misoriented);
}

TEST_CASE("check cells: shapes other than hexahedra have their volumes and scaled Jacobians") {
  CellZone mesh;
  mesh.points_world = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {0, 0, 1}, {1, 0, 1}, {0, 1, 1}};
  mesh.add(CellKind::Tetrahedron, List{0, 1, 3, 4});
  mesh.add(CellKind::Pyramid, List{0, 1, 2, 3, 4});
  mesh.add(CellKind::Prism, List{0, 1, 3, 4, 5, 6});
  // The tetrahedron again, by its faces.
  mesh.add(CellKind::Polyhedron, List{4, 3, 0, 3, 1, 3, 0, 1, 4, 3, 1, 3, 4, 3, 3, 0, 4});
  const CellCheck check = check_cells(mesh);
  const auto of = [&](CellKind kind) { return check.kinds[static_cast<std::size_t>(kind)]; };
  CHECK(of(CellKind::Tetrahedron).min_volume == doctest::Approx(1.0 / 6));
  CHECK(of(CellKind::Pyramid).min_volume == doctest::Approx(1.0 / 3));
  CHECK(of(CellKind::Prism).min_volume == doctest::Approx(1.0 / 2));
  CHECK(of(CellKind::Polyhedron).min_volume == doctest::Approx(1.0 / 6));
  CHECK(check.quality.nonpositive_cells == 0);
  // Right-angled prisms: the corners of 45 degrees are the least.
  CHECK(of(CellKind::Prism).min_scaled_jacobian == doctest::Approx(std::sqrt(0.5)));
}

TEST_CASE("check cells: prisms of the other convention are positive, and fit beside hexahedra") {
  for (const bool is_other : {false, true}) {
    CellZone mesh = row(1);
    for (const double y : {0.0, 1.0}) mesh.points_world.emplace_back(1.5, y, 0.5);
    List corners{4, 8, 7, 5, 9, 6};  // triangles in the planes y = 0 and y = 1
    if (!is_other) corners = {5, 9, 6, 4, 8, 7};
    mesh.add(CellKind::Prism, corners);
    mesh.boundaries[0].faces.points.resize(4 * 5);
    mesh.boundaries[0].faces.first.pop_back();
    for (const List& face : {List{4, 8, 7}, List{5, 9, 6}, List{4, 5, 9, 8}, List{7, 6, 9, 8}}) {
      mesh.boundaries[0].faces.add(face);
    }
    CAPTURE(is_other);
    CHECK(check_cells(mesh).is_sound());
  }
}

}  // namespace vdb_offset::test
