// Columns over triangles and quads against those of structured patches, and against mathematics.

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <set>
#include <utility>
#include <vector>

#include "io/cell_mesh.h"
#include "support/marched.h"
#include "support/polygons.h"
#include "support/threads.h"
#include "vdb_offset/blocks/repair.h"
#include "vdb_offset/core/error.h"
#include "vdb_offset/surface/example.h"

namespace vdb_offset::test {
namespace {

struct Meshed {
  Surface surface;
  MultiBlock mesh;
  RepairResult repaired;
};

Meshed meshed(Patches patches, const Case& c) {
  Marched m = marched(std::move(patches), c);
  Meshed result{std::move(m.surface), {}, {}};
  result.mesh = build_blocks(result.surface, std::move(m.layers));
  result.repaired = repair(result.surface, result.mesh);
  return result;
}

double farthest(const Layers& a, const Layers& b) {
  double most = 0;
  for (std::size_t p = 0; p < a.points_world.size(); ++p) {
    most = std::max(most, (a.points_world[p] - b.points_world[p]).norm());
  }
  return most;
}

/// Faces of cells that lead to no other cell, and those that do; each must lead back.
struct Sides {
  std::int64_t open = 0;
  std::int64_t inner = 0;
  bool mutual = true;
};

Sides sides_of(const CellMesh& cells) {
  constexpr std::array<BlockFace, 6> kFaces{BlockFace::IMin, BlockFace::IMax, BlockFace::JMin,
                                            BlockFace::JMax, BlockFace::KMin, BlockFace::KMax};
  Sides sides;
  std::multiset<std::pair<std::int32_t, std::int32_t>> links;
  cells.for_cells([&](int block, const CellMesh::Place& place) {
    const std::array<Polygon, 6> faces = polygons(cells.corners(block, place));
    for (const BlockFace face : kFaces) {
      if (!faces[static_cast<std::size_t>(face)].has_area()) continue;
      const std::int32_t to = cells.beyond(block, place, face);
      ++(to < 0 ? sides.open : sides.inner);
      if (to >= 0) links.insert({cells.cell(block, place), to});
    }
  });
  for (const auto& [from, to] : links) {
    sides.mutual = sides.mutual && links.count({to, from}) == links.count({from, to});
  }
  return sides;
}

std::int64_t boundary_faces(const CellMesh& cells) {
  std::int64_t faces = 0;
  for (const CellPatch& patch : cells.patches()) faces += patch.faces;
  return faces;
}

/// A block of unit cubes, 4 x 4 x 2, with a tower of one on it and a hole of one beside that.
Patch tower_beside_hole() {
  const auto is_solid = [](int i, int j, int k) {
    const bool inside = i >= 0 && i < 4 && j >= 0 && j < 4 && k >= 0;
    return inside && k < (i == 2 && j == 1 ? 3 : (i == 2 && j == 2 ? 1 : 2));
  };
  Patch patch;
  patch.name = "tower beside hole";
  std::map<std::array<int, 3>, int> points;
  const auto point = [&](const std::array<int, 3>& p) {
    const auto [found, is_new] = points.try_emplace(p, static_cast<int>(points.size()));
    if (is_new) patch.points_world.emplace_back(p[0], p[1], p[2]);
    return found->second;
  };
  for (int n = 0; n < 4 * 4 * 3; ++n) {
    const std::array<int, 3> cube{n % 4, n / 4 % 4, n / 16};
    for (std::size_t axis = 0; is_solid(cube[0], cube[1], cube[2]) && axis < 3; ++axis) {
      for (const int up : {0, 1}) {
        std::array<int, 3> beside = cube;
        beside[axis] += up == 1 ? 1 : -1;
        if (is_solid(beside[0], beside[1], beside[2])) continue;
        std::array<std::array<int, 3>, 4> corner;
        corner.fill(cube);
        for (std::array<int, 3>& c : corner) c[axis] += up;
        const std::size_t a = (axis + (up == 1 ? 1 : 2)) % 3;
        const std::size_t b = (axis + (up == 1 ? 2 : 1)) % 3;
        for (const std::size_t c : {1U, 2U}) ++corner[c][a];
        for (const std::size_t c : {2U, 3U}) ++corner[c][b];
        patch.faces.push_back(
            {point(corner[0]), point(corner[1]), point(corner[2]), point(corner[3])});
      }
    }
  }
  patch.ni = static_cast<int>(patch.points_world.size());
  return patch;
}

const Case kSphere{.distance = 0.5, .layers = 8};

}  // namespace

TEST_CASE("polygons: quads of a structured surface get the columns that its patches get") {
  for (const char* name : {"sphere", "l-bar", "wing-on-cylinder"}) {
    CAPTURE(name);
    const Patches grids = make_example(name, {.points = 9});
    const Case c{.distance = 0.2, .layers = 8};
    const Meshed a = meshed(grids, c);
    const Meshed b = meshed(as_polygons(grids), c);
    REQUIRE(a.mesh.nodes() == b.mesh.nodes());
    CHECK(a.surface.faces() == b.surface.faces());
    CHECK(a.surface.free_edges() == b.surface.free_edges());
    CHECK(a.mesh.cells() == b.mesh.cells());
    CHECK(farthest(a.mesh.layers, b.mesh.layers) < 1e-9);
    CHECK(a.repaired.quality.report.min_scaled_jacobian ==
          doctest::Approx(b.repaired.quality.report.min_scaled_jacobian).epsilon(1e-6));
    CHECK(b.repaired.quality.report.nonpositive_cells == 0);
  }
}

TEST_CASE("polygons: prisms over a sphere of triangles stand on it at their heights") {
  const Patch sphere = icosphere(3);
  const Meshed m = meshed({sphere}, kSphere);
  CHECK(m.surface.closed);
  CHECK(m.mesh.cells() == sphere.faces.size() * 8);
  CHECK(m.repaired.quality.report.nonpositive_cells == 0);
  CHECK(m.repaired.quality.report.min_scaled_jacobian > 0.6);  // equilateral: sqrt(3) / 2
  const std::vector<double>& heights = m.mesh.layers.spacing.heights_world;
  for (int n = 0; n < m.mesh.nodes(); ++n) {
    for (int k = 1; k < m.mesh.layers.levels(); ++k) {
      const Vec3& p = m.mesh.layers.at(n, k);
      const double height = heights[static_cast<std::size_t>(k)];
      CHECK(m.surface.wall->closest(p).distance_world == doctest::Approx(height).epsilon(1e-6));
      // radial, to the facets' sagitta
      const Vec3& foot = m.mesh.layers.at(n, 0);
      CHECK(p.normalized().dot(foot.normalized()) > 1 - 1e-3);
    }
  }
}

TEST_CASE("polygons: every side of every cell leads to one neighbour or lies on a boundary") {
  Patches mixed = make_example("sphere", {.points = 5});
  mixed[1] = as_polygons(mixed[1]);
  mixed[4] = as_triangles(mixed[4]);
  Patches open = {as_triangles(make_example("quarter-cylinder", {.points = 5}).front())};
  for (const Patches& patches : {mixed, Patches{icosphere(1)}, open}) {
    const Meshed m = meshed(patches, {.distance = 0.2, .layers = 5});
    const CellMesh cells(m.mesh);
    const Sides sides = sides_of(cells);
    CHECK(sides.mutual);
    CHECK(sides.inner > 0);
    CHECK(sides.open == boundary_faces(cells));
    CHECK(m.repaired.quality.report.nonpositive_cells == 0);
  }
}

TEST_CASE("polygons: beside structured patches columns are shared") {
  Patches mixed = make_example("sphere", {.points = 9});
  const Meshed whole = meshed(mixed, kSphere);
  mixed[2] = as_polygons(mixed[2]);
  const Meshed m = meshed(mixed, kSphere);
  CHECK(m.surface.closed);
  CHECK(m.mesh.nodes() == whole.mesh.nodes());
  CHECK(!m.mesh.is_structured());
  CHECK(farthest(m.mesh.layers, whole.mesh.layers) < 1e-9);
}

TEST_CASE("polygons: the rim of triangles marches within the symmetry plane that is found") {
  Patch half = icosphere(3);
  std::erase_if(half.faces, [&](const std::array<int, 4>& face) {
    return std::ranges::any_of(
        face, [&](int n) { return half.points_world[static_cast<std::size_t>(n)].z() < -1e-12; });
  });
  // The lowest points come down to the plane, so that the rim is flat.
  std::vector<int> uses(half.points_world.size(), 0);
  SurfaceOptions splayed;
  splayed.open_edges = OpenEdges::Splay;
  const Surface open = build_surface({half}, splayed);
  for (const int point : open.patches.front().rim.points) {
    if (point >= 0) uses[static_cast<std::size_t>(point)] = 1;
  }
  half = open.patches.front();
  for (std::size_t n = 0; n < half.points_world.size(); ++n) {
    if (uses[n] == 0) continue;
    half.points_world[n].z() = 0;
    half.points_world[n].normalize();
  }
  const Meshed m = meshed({half}, {.distance = 0.3, .layers = 6});
  REQUIRE(m.surface.boundaries != nullptr);
  CHECK(m.surface.boundaries->list().front().name() == "symmetry");
  int on = 0;
  for (int n = 0; n < m.mesh.nodes(); ++n) {
    if (m.surface.boundaries_of(static_cast<std::size_t>(n)) == 0) continue;
    ++on;
    for (int k = 0; k < m.mesh.layers.levels(); ++k) CHECK(m.mesh.layers.at(n, k).z() == 0);
  }
  CHECK(on > 20);
  CHECK(m.repaired.quality.report.nonpositive_cells == 0);
}

TEST_CASE("polygons: inner corners are repaired, whatever the number of threads") {
  Patches bar;
  for (const Patch& grid : make_example("l-bar", {.points = 9})) bar.push_back(as_triangles(grid));
  const Case c{.distance = 0.3, .layers = 12};
  const Meshed one = on_threads(1, [&] { return meshed(bar, c); });
  CHECK(one.repaired.report.windows > 0);
  CHECK(one.repaired.quality.report.nonpositive_cells == 0);
  const Meshed two = on_threads(2, [&] { return meshed(bar, c); });
  CHECK(farthest(one.mesh.layers, two.mesh.layers) == 0);
}

TEST_CASE("polygons: a node that no direction leaves has no height, and all cells are positive") {
  // Walls face along x and against it where the tower's foot and the hole's rim meet.
  const Meshed m = meshed({tower_beside_hole()}, {.distance = 0.4, .layers = 8});
  CHECK(m.surface.closed);
  CHECK(m.repaired.quality.report.nonpositive_cells == 0);
  int without = 0;
  for (int n = 0; n < m.mesh.nodes(); ++n) {
    const Vec3 foot = m.mesh.layers.at(n, 0);
    const bool is_blind = foot.y() == 2 && foot.z() == 2 && (foot.x() == 2 || foot.x() == 3);
    const double height = m.mesh.layers.height_world[static_cast<std::size_t>(n)];
    CHECK((height == 0) == is_blind);
    without += height == 0 ? 1 : 0;
    if (height > 0) continue;
    for (int k = 1; k < m.mesh.layers.levels(); ++k) CHECK(m.mesh.layers.at(n, k) == foot);
  }
  CHECK(without == 2);
}

TEST_CASE("polygons: faces of points that are not there, and fans, are refused") {
  Patch patch = icosphere(0);
  patch.faces.front()[1] = 12;
  CHECK_THROWS_WITH_AS(build_surface({patch}), doctest::Contains("corner at point 12"), InputError);
  patch = icosphere(0);
  SurfaceOptions fans;
  fans.fans = 2;
  CHECK_THROWS_WITH_AS(build_surface({patch}, fans), doctest::Contains("polygons"), InputError);
  for (auto& face : patch.faces) face = {face[0], face[0], face[1], face[1]};
  CHECK_THROWS_WITH_AS(build_surface({patch}), doctest::Contains("no face"), InputError);
}

}  // namespace vdb_offset::test
