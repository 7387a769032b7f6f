#pragma once

// Whether layers lie in each other, by the definition: points of one part in hexahedra of another.

#include <Eigen/LU>
#include <array>
#include <cstddef>
#include <vector>

#include "vdb_offset/blocks/multi_block.h"
#include "vdb_offset/core/vec.h"

namespace vdb_offset::test {

/// The corner at (i, j, k) in {0, 1}^3 is number i + 2 j + 4 k.
using Hexahedron = std::array<Vec3, 8>;

/// Whether the trilinear map of the unit cube has the point in its interior: by Newton's method.
inline bool is_inside(const Hexahedron& cell, const Vec3& point) {
  Box box;
  for (const Vec3& corner : cell) box.add(corner);
  if ((point.array() < box.lo.array()).any() || (point.array() > box.hi.array()).any()) {
    return false;
  }
  Vec3 x = Vec3::Constant(0.5);
  Vec3 miss = Vec3::Zero();
  for (int n = 0; n < 30; ++n) {
    miss = -point;
    Eigen::Matrix3d slope = Eigen::Matrix3d::Zero();
    for (std::size_t c = 0; c < 8; ++c) {
      const Vec3 up((c & 1U) != 0 ? 1 : 0, (c & 2U) != 0 ? 1 : 0, (c & 4U) != 0 ? 1 : 0);
      const Vec3 part = up.cwiseProduct(x) + (Vec3::Ones() - up).cwiseProduct(Vec3::Ones() - x);
      const Vec3 sign = 2 * up - Vec3::Ones();
      miss += part.prod() * cell[c];
      slope.col(0) += sign.x() * part.y() * part.z() * cell[c];
      slope.col(1) += sign.y() * part.x() * part.z() * cell[c];
      slope.col(2) += sign.z() * part.x() * part.y() * cell[c];
    }
    x -= Vec3(slope.fullPivLu().solve(miss)).cwiseMax(-0.5).cwiseMin(0.5);
  }
  constexpr double kBorder = 1e-6;
  return miss.norm() < 1e-9 * box.size() && x.minCoeff() > kBorder && x.maxCoeff() < 1 - kBorder;
}

inline std::vector<Hexahedron> hexahedra(const MultiBlock& mesh, const Block& block) {
  std::vector<Hexahedron> cells;
  for (int j = 0; j < block.stacks_j(); ++j) {
    for (int i = 0; i < block.stacks_i(); ++i) {
      const std::array<int, 4> ring = block.stack(i, j);
      for (int k = 0; k + 1 < block.nk; ++k) {
        Hexahedron& cell = cells.emplace_back();
        for (std::size_t c = 0; c < 8; ++c) {
          const std::size_t corner = (c >> 1U & 1U) != 0 ? 3 - (c & 1U) : c & 1U;
          cell[c] = mesh.layers.at(ring[corner], k + static_cast<int>(c >> 2U));
        }
      }
    }
  }
  return cells;
}

/// Points of levels, and of the wall and the outer level `per_edge` squared more on each face.
inline Vec3List samples(const MultiBlock& mesh, const Block& block, int per_edge) {
  Vec3List points;
  for (const int column : block.columns) {
    for (int k = 0; k < block.nk; ++k) points.push_back(mesh.layers.at(column, k));
  }
  for (int j = 0; j < block.stacks_j(); ++j) {
    for (int i = 0; i < block.stacks_i(); ++i) {
      const std::array<int, 4> ring = block.stack(i, j);
      for (const int k : {0, block.nk - 1}) {
        for (int n = 0; n < per_edge * per_edge; ++n) {
          const double u = (n % per_edge + 0.5) / per_edge;
          const double v = (n / per_edge + 0.5) / per_edge;
          points.push_back((1 - u) * (1 - v) * mesh.layers.at(ring[0], k) +
                           u * (1 - v) * mesh.layers.at(ring[1], k) +
                           u * v * mesh.layers.at(ring[2], k) +
                           (1 - u) * v * mesh.layers.at(ring[3], k));
        }
      }
    }
  }
  return points;
}

/// Samples of blocks in [first, end) within hexahedra of those that are not, and the other way
/// round.
inline int samples_inside(const MultiBlock& mesh, std::size_t first, std::size_t end) {
  constexpr int kPerEdge = 4;
  std::array<Vec3List, 2> points;
  std::array<std::vector<Hexahedron>, 2> cells;
  for (std::size_t b = 0; b < mesh.blocks.size(); ++b) {
    const std::size_t part = b >= first && b < end ? 1 : 0;
    for (const Vec3& point : samples(mesh, mesh.blocks[b], kPerEdge)) points[part].push_back(point);
    for (const Hexahedron& cell : hexahedra(mesh, mesh.blocks[b])) cells[part].push_back(cell);
  }
  int inside = 0;
  for (const std::size_t part : {0U, 1U}) {
    Box box;
    for (const Vec3& point : points[1 - part]) box.add(point);
    for (const Hexahedron& cell : cells[part]) {
      Box own;
      for (const Vec3& corner : cell) own.add(corner);
      if ((own.hi.array() < box.lo.array()).any() || (own.lo.array() > box.hi.array()).any()) {
        continue;
      }
      for (const Vec3& point : points[1 - part]) inside += is_inside(cell, point) ? 1 : 0;
    }
  }
  return inside;
}

}  // namespace vdb_offset::test
