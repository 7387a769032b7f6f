#pragma once

// What must hold for the interfaces and boundary faces of any mesh.

#include <doctest/doctest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <set>

#include "vdb_offset/blocks/multi_block.h"

namespace vdb_offset::test {

using Index3 = std::array<int, 3>;

/// Index2 = T (Index1 - Begin1) + Begin2, T(m, n) = sgn(a_n) if |a_n| = m: the SIDS' own words.
inline Index3 to_donor(const Interface& face, const Index3& index) {
  Index3 donor = face.second.begin;
  for (std::size_t n = 0; n < 3; ++n) {
    const int a = face.transform[n];
    donor[static_cast<std::size_t>(std::abs(a) - 1)] +=
        (a > 0 ? 1 : -1) * (index[n] - face.first.begin[n]);
  }
  return donor;
}

inline bool inside(const Block& block, const Index3& p) {
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
inline Index3 outward(BlockFace face) {
  Index3 step{0, 0, 0};
  const int f = static_cast<int>(face);
  step[static_cast<std::size_t>(f / 2)] = f % 2 == 0 ? -1 : 1;
  return step;
}

inline bool lies_on(const BlockRange& r, const Block& block) {
  const int f = static_cast<int>(r.face);
  const auto axis = static_cast<std::size_t>(f / 2);
  const Index3 last{block.ni - 1, block.nj - 1, block.nk - 1};
  const int level = f % 2 == 0 ? 0 : last[axis];
  return r.begin[axis] == level && r.end[axis] == level && inside(block, r.begin) &&
         inside(block, r.end);
}

inline int determinant(const Interface& face) {
  Eigen::Matrix3d t = Eigen::Matrix3d::Zero();
  for (int n = 0; n < 3; ++n) {
    const int a = face.transform[static_cast<std::size_t>(n)];
    t(std::abs(a) - 1, n) = a > 0 ? 1 : -1;
  }
  return static_cast<int>(std::lround(t.determinant()));
}

/// Every cell face in a range, once each: (block, face, lower corner).
using FaceCells = std::multiset<std::array<int, 5>>;
inline void add_face_cells(const BlockRange& r, FaceCells& cells) {
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
inline void check_covered_once(const MultiBlock& mesh) {
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
inline void check_interface(const MultiBlock& mesh, const Interface& face) {
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

}  // namespace vdb_offset::test
