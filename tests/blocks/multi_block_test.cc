#include "vdb_offset/blocks/multi_block.h"

#include <doctest/doctest.h>

#include <array>
#include <memory>
#include <random>
#include <set>
#include <utility>
#include <vector>

#include "support/face_ranges.h"
#include "support/hand_made.h"

namespace vdb_offset::test {
namespace {

constexpr int kLong = 5;   // points along the first patch's shared side
constexpr int kShort = 3;  // points along the second's: it meets a part of the first
constexpr int kDeep = 4;   // points across both
constexpr int kOffset = 1;
constexpr int kCells = 2;

/// +1 where the counter-clockwise boundary of a patch runs with the side's index.
int loop_sense(Side side) { return side == Side::JMin || side == Side::IMax ? 1 : -1; }

/// Point `n` along a side, `depth` points away from it, as an index into the patch's points.
std::size_t along_side(Side side, Index3 size, int n, int depth) {
  const int last_i = size[0] - 1;
  const int last_j = size[1] - 1;
  const int i = side == Side::IMin ? depth : side == Side::IMax ? last_i - depth : n;
  const int j = side == Side::JMin ? depth : side == Side::JMax ? last_j - depth : n;
  return static_cast<std::size_t>(j * size[0] + i);
}

Index3 patch_size(Side side, int length) {
  const bool along_j = side == Side::IMin || side == Side::IMax;
  return along_j ? Index3{kDeep, length, 1} : Index3{length, kDeep, 1};
}

void add_free_sides(Surface& surface, int patch, Side but, Index3 size) {
  for (const Side side : {Side::IMin, Side::IMax, Side::JMin, Side::JMax}) {
    const int points = side == Side::IMin || side == Side::IMax ? size[1] : size[0];
    if (side != but) surface.topology.edges.push_back(free_edge(patch, side, 0, points - 1));
  }
}

/// Two patches; the second's whole side meets points 1..3 of the first's, with or against it.
Surface two_patches(Side first, Side second, bool reversed) {
  const Index3 size_a = patch_size(first, kLong);
  const Index3 size_b = patch_size(second, kShort);
  Surface surface;
  std::vector<int> a(kLong * kDeep);
  for (std::size_t n = 0; n < a.size(); ++n) a[n] = static_cast<int>(n);
  std::vector<int> b(kShort * kDeep);
  for (std::size_t n = 0; n < b.size(); ++n) b[n] = static_cast<int>(a.size() + n);
  for (int n = 0; n < kShort; ++n) {
    const int m = reversed ? kShort - 1 - n : n;
    b[along_side(second, size_b, m, 0)] = a[along_side(first, size_a, kOffset + n, 0)];
  }
  add_patch(surface, "a", size_a[0], size_a[1], a);
  add_patch(surface, "b", size_b[0], size_b[1], b);
  surface.topology.edges = {free_edge(0, first, 0, kOffset),
                            {EdgeKind::Interface,
                             {0, first, kOffset, kOffset + kShort - 1},
                             {1, second, reversed ? kShort - 1 : 0, reversed ? 0 : kShort - 1},
                             {}},
                            free_edge(0, first, kOffset + kShort - 1, kLong - 1)};
  add_free_sides(surface, 0, first, size_a);
  add_free_sides(surface, 1, second, size_b);
  return surface;
}

TEST_CASE("blocks: an interface joins the same points for every pair of sides and directions") {
  const std::array<Side, 4> sides{Side::IMin, Side::IMax, Side::JMin, Side::JMax};
  for (const Side first : sides) {
    for (const Side second : sides) {
      for (const bool reversed : {false, true}) {
        CAPTURE(static_cast<int>(first));
        CAPTURE(static_cast<int>(second));
        CAPTURE(reversed);
        const Surface surface = two_patches(first, second, reversed);
        const int nodes = static_cast<int>(surface.nodes_world.size());
        const MultiBlock mesh = build_blocks(surface, any_layers(nodes, kCells));
        REQUIRE(mesh.interfaces.size() == 1);
        check_interface(mesh, mesh.interfaces[0]);
        check_covered_once(mesh);
        // Of one orientation, both blocks are right-handed and the transform turns; else it
        // mirrors.
        const int sense = loop_sense(first) * loop_sense(second) * (reversed ? -1 : 1);
        CHECK(determinant(mesh.interfaces[0]) == -sense);
      }
    }
  }
}

TEST_CASE("blocks: a ring meets itself, and its pole and open end are told apart") {
  const int ni = 4;
  const int nj = 5;
  Surface surface;
  std::vector<int> nodes;
  for (int j = 0; j < nj; ++j) {
    for (int i = 0; i < ni; ++i)
      nodes.push_back(i == 0 ? 0 : 1 + (j % (nj - 1)) * (ni - 1) + i - 1);
  }
  add_patch(surface, "cap", ni, nj, nodes);
  surface.patches[0].family = "nose";
  surface.topology.edges = {
      {EdgeKind::Degenerate, {0, Side::IMin, 0, nj - 1}, {}, {}},
      free_edge(0, Side::IMax, 0, nj - 1),
      {EdgeKind::Interface, {0, Side::JMin, 0, ni - 1}, {0, Side::JMax, 0, ni - 1}, {}}};
  const int count = static_cast<int>(surface.nodes_world.size());
  const MultiBlock mesh = build_blocks(surface, any_layers(count, 3));

  check_covered_once(mesh);
  REQUIRE(mesh.interfaces.size() == 1);
  check_interface(mesh, mesh.interfaces[0]);
  CHECK(mesh.interfaces[0].transform == Index3{1, 2, 3});
  CHECK(determinant(mesh.interfaces[0]) == 1);

  std::set<std::pair<BlockFace, std::string>> names;
  for (const BoundaryFace& face : mesh.boundary_faces) {
    CHECK(lies_on(face.range, mesh.blocks[0]));
    names.insert({face.range.face, face.name});
    const BoundaryKind expected = face.range.face == BlockFace::KMin   ? BoundaryKind::Wall
                                  : face.range.face == BlockFace::KMax ? BoundaryKind::Outer
                                  : face.range.face == BlockFace::IMin ? BoundaryKind::Degenerate
                                                                       : BoundaryKind::Free;
    CHECK(face.kind == expected);
  }
  CHECK(names == std::set<std::pair<BlockFace, std::string>>{{BlockFace::KMin, "nose"},
                                                             {BlockFace::KMax, "outer"},
                                                             {BlockFace::IMin, "pole"},
                                                             {BlockFace::IMax, "free"}});
}

TEST_CASE("blocks: sizes, names and points follow from patch and layers") {
  const MultiBlock mesh = wavy_plate(4, 3, 5);
  REQUIRE(mesh.blocks.size() == 1);
  const Block& block = mesh.blocks[0];
  CHECK(block.name == "plate");
  CHECK(block.nk == 6);
  CHECK(block.point_count() == 4 * 3 * 6);
  CHECK(mesh.cells() == 3 * 2 * 5);
  CHECK(mesh.nodes() == 12);
  CHECK(mesh.point(block, 3, 2, 4) == mesh.layers.at(11, 4));
  CHECK(mesh.boundary_faces[0].name == "wall");
}

/// A patch of 8 x 7 points, or of the same faces as polygons, with two internal surfaces.
Surface below_sheets(bool as_polygons) {
  const int ni = 8;
  const int nj = 7;
  Surface surface;
  std::vector<int> nodes;
  for (int n = 0; n < ni * nj; ++n) nodes.push_back(n);
  add_patch(surface, "floor", ni, nj, nodes);
  surface.topology.edges = {
      free_edge(0, Side::IMin, 0, nj - 1), free_edge(0, Side::IMax, 0, nj - 1),
      free_edge(0, Side::JMin, 0, ni - 1), free_edge(0, Side::JMax, 0, ni - 1)};
  if (as_polygons) {
    Patch& patch = surface.patches[0];
    patch.ni = ni * nj;
    patch.nj = 0;
    for (int j = 0; j + 1 < nj; ++j) {
      for (int i = 0; i + 1 < ni; ++i) {
        const int n = j * ni + i;
        patch.faces.push_back({n, n + 1, n + ni + 1, n + ni});
      }
    }
    surface.topology.edges.clear();
  }
  Boundaries boundaries;
  for (const char* name : {"roof", "disk"}) {
    boundaries.add(Boundary(name, std::shared_ptr<const Wall>(), ShapeRole::Internal));
  }
  surface.boundaries = std::make_shared<const Boundaries>(std::move(boundaries));
  return surface;
}

TEST_CASE("blocks: faces whose columns all end on one internal surface have its name, each once") {
  std::mt19937 random(11);
  for (const bool as_polygons : {false, true}) {
    const Surface surface = below_sheets(as_polygons);
    for (int round = 0; round < 40; ++round) {
      CAPTURE(round);
      Layers layers = any_layers(static_cast<int>(surface.nodes_world.size()), kCells);
      // All alike at first, then two in three on the one, and any.
      const unsigned kinds = round < 3 ? 1U : 6U;
      for (std::size_t n = 0; n < layers.stop.size(); ++n) {
        const auto any = random() % kinds;
        layers.ends_on.push_back(round < 3 ? round - 1 : any == 0 ? -1 : any == 1 ? 1 : 0);
      }
      const MultiBlock mesh = build_blocks(surface, std::move(layers));
      const Block& block = mesh.blocks[0];
      std::set<std::pair<int, int>> seen;
      std::size_t parts = 0;
      for (const BoundaryFace& face : mesh.boundary_faces) {
        if (face.range.face != BlockFace::KMax) continue;
        ++parts;
        for (int j = face.range.begin[1]; j < face.range.end[1]; ++j) {
          for (int i = face.range.begin[0]; i < face.range.end[0]; ++i) {
            std::set<int> on;
            for (const int c : block.stack(i, j)) on.insert(mesh.layers.ended_on(c));
            const int one = on.size() == 1 ? *on.begin() : -1;
            CHECK(face.name == (one < 0 ? "outer" : one == 0 ? "roof" : "disk"));
            CHECK(face.kind == (one < 0 ? BoundaryKind::Outer : BoundaryKind::Boundary));
            CHECK(face.condition.kind ==
                  (one < 0 ? ConditionKind::Farfield : ConditionKind::Unspecified));
            CHECK(seen.insert({i, j}).second);
          }
        }
      }
      CHECK(seen.size() == 7 * 6);
      CHECK((parts == 1) == (round < 3));
      if (!as_polygons) check_covered_once(mesh);
    }
  }
}

TEST_CASE("blocks: layers of another surface are refused") {
  const Surface surface = two_patches(Side::IMax, Side::IMin, false);
  const int nodes = static_cast<int>(surface.nodes_world.size());
  CHECK_THROWS_AS(build_blocks(surface, any_layers(nodes - 1, 2)), InputError);
  Layers cut = any_layers(nodes, 2);
  cut.points_world.pop_back();
  CHECK_THROWS_AS(build_blocks(surface, std::move(cut)), InputError);
}

TEST_CASE("blocks: building them can be cancelled") {
  const Surface surface = two_patches(Side::IMax, Side::IMin, false);
  const std::atomic<bool> stop{true};
  Progress progress;
  progress.cancel = &stop;
  const int nodes = static_cast<int>(surface.nodes_world.size());
  CHECK_THROWS_AS(build_blocks(surface, any_layers(nodes, 2), progress), Cancelled);
}

}  // namespace
}  // namespace vdb_offset::test
