#include "vdb_offset/blocks/multi_block.h"

#include <doctest/doctest.h>

#include <Eigen/Dense>
#include <array>
#include <set>
#include <vector>

#include "support/hand_made.h"

namespace vdb_offset::test {
namespace {

using Index3 = std::array<int, 3>;

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

/// Index2 = T (Index1 - Begin1) + Begin2, T(m, n) = sgn(a_n) if |a_n| = m: the SIDS' own words.
Index3 to_donor(const Interface& face, const Index3& index) {
  Index3 donor = face.second.begin;
  for (std::size_t n = 0; n < 3; ++n) {
    const int a = face.transform[n];
    donor[static_cast<std::size_t>(std::abs(a) - 1)] +=
        (a > 0 ? 1 : -1) * (index[n] - face.first.begin[n]);
  }
  return donor;
}

bool inside(const Block& block, const Index3& p) {
  return p[0] >= 0 && p[0] < block.ni && p[1] >= 0 && p[1] < block.nj && p[2] >= 0 &&
         p[2] < block.nk;
}

/// Calls `visit` for each point of a range, from begin to end.
template <typename Visit>
void for_points(const BlockRange& r, const Visit& visit) {
  const auto step = [&](std::size_t a) { return r.begin[a] <= r.end[a] ? 1 : -1; };
  for (int i = r.begin[0];; i += step(0)) {
    for (int j = r.begin[1];; j += step(1)) {
      for (int k = r.begin[2];; k += step(2)) {
        visit(Index3{i, j, k});
        if (k == r.end[2]) break;
      }
      if (j == r.end[1]) break;
    }
    if (i == r.end[0]) break;
  }
}

/// The outward step through a block's face.
Index3 outward(BlockFace face) {
  Index3 step{0, 0, 0};
  const int f = static_cast<int>(face);
  step[static_cast<std::size_t>(f / 2)] = f % 2 == 0 ? -1 : 1;
  return step;
}

bool lies_on(const BlockRange& r, const Block& block) {
  const int f = static_cast<int>(r.face);
  const auto axis = static_cast<std::size_t>(f / 2);
  const Index3 last{block.ni - 1, block.nj - 1, block.nk - 1};
  const int level = f % 2 == 0 ? 0 : last[axis];
  return r.begin[axis] == level && r.end[axis] == level && inside(block, r.begin) &&
         inside(block, r.end);
}

int determinant(const Interface& face) {
  Eigen::Matrix3d t = Eigen::Matrix3d::Zero();
  for (int n = 0; n < 3; ++n) {
    const int a = face.transform[static_cast<std::size_t>(n)];
    t(std::abs(a) - 1, n) = a > 0 ? 1 : -1;
  }
  return static_cast<int>(std::lround(t.determinant()));
}

/// Every cell face in a range, once each: (block, face, lower corner).
using FaceCells = std::multiset<std::array<int, 5>>;
void add_face_cells(const BlockRange& r, FaceCells& cells) {
  BlockRange lower = r;
  for (std::size_t a = 0; a < 3; ++a) {
    lower.begin[a] = std::min(r.begin[a], r.end[a]);
    lower.end[a] = std::max(r.begin[a], r.end[a]);
    if (a != static_cast<std::size_t>(r.face) / 2) --lower.end[a];
  }
  for_points(lower, [&](const Index3& p) {
    cells.insert({r.block, static_cast<int>(r.face), p[0], p[1], p[2]});
  });
}

/// Each cell face of each block's surface is in exactly one range.
void check_covered_once(const MultiBlock& mesh) {
  FaceCells cells;
  for (const Interface& face : mesh.interfaces) {
    add_face_cells(face.first, cells);
    add_face_cells(face.second, cells);
  }
  for (const BoundaryFace& face : mesh.boundary_faces) add_face_cells(face.range, cells);
  std::size_t expected = 0;
  for (const Block& b : mesh.blocks) {
    const int i = b.ni - 1;
    const int j = b.nj - 1;
    const int k = b.nk - 1;
    expected += static_cast<std::size_t>(2 * (i * j + j * k + i * k));
  }
  CHECK(cells.size() == expected);
  CHECK(std::set<std::array<int, 5>>(cells.begin(), cells.end()).size() == expected);
}

/// Same columns and levels on both sides, begin to begin, end to end, and through the face one
/// comes from the inside of one block to the inside of the other.
void check_interface(const MultiBlock& mesh, const Interface& face) {
  const Block& a = mesh.blocks[static_cast<std::size_t>(face.first.block)];
  const Block& b = mesh.blocks[static_cast<std::size_t>(face.second.block)];
  REQUIRE(lies_on(face.first, a));
  REQUIRE(lies_on(face.second, b));
  CHECK(to_donor(face, face.first.end) == face.second.end);
  for_points(face.first, [&](const Index3& p) {
    const Index3 q = to_donor(face, p);
    REQUIRE(inside(b, q));
    CHECK(a.column(p[0], p[1]) == b.column(q[0], q[1]));
    CHECK(p[2] == q[2]);
    const Index3 step = outward(face.first.face);
    const Index3 beyond = to_donor(face, {p[0] + step[0], p[1] + step[1], p[2] + step[2]});
    CHECK(inside(b, beyond));
    CHECK(beyond != q);
  });
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
