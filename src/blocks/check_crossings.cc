#include "vdb_offset/blocks/check_crossings.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <set>
#include <span>
#include <utility>
#include <vector>

#include "blocks/part_crossed.h"
#include "core/hulls.h"
#include "core/parallel.h"
#include "vdb_offset/march/face_room.h"

namespace vdb_offset {
namespace {

constexpr double kShrink = 1 - 1e-6;  // of tetrahedra: those that touch do not cross

using Tetrahedron = std::array<Vec3, 4>;

/// One cell of a stack.
class Cell {
 public:
  /// `part` of it from below.
  Cell(const Layers& layers, const WallFace& face, int level, double part = 1)
      : count_(face.count()) {
    for (std::size_t c = 0; c < count_; ++c) {
      const Vec3& below = layers.at(face.node[c], level);
      const Vec3& above = layers.at(face.node[c], level + 1);
      corners_[c] = below;
      corners_[count_ + c] = part < 1 ? Vec3(below + part * (above - below)) : above;
    }
    for (const Vec3& corner : corners()) box_.add(corner);
  }

  std::span<const Vec3> corners() const { return {corners_.data(), 2 * count_}; }
  const Box& box() const { return box_; }

  /// `visit(tetrahedron)` until it gives true; those that are not positive are left out.
  template <typename Visit>
  bool any(const Visit& visit) const {
    const auto below = [&](std::size_t c) { return corners_[c % count_]; };
    const auto above = [&](std::size_t c) { return corners_[count_ + c % count_]; };
    std::array<Vec3, 4> ring;
    for (std::size_t c = 0; c < count_; ++c) ring[c] = below(count_ - 1 - c);
    if (any_on({ring.data(), count_}, visit)) return true;
    for (std::size_t c = 0; c < count_; ++c) ring[c] = above(c);
    if (any_on({ring.data(), count_}, visit)) return true;
    for (std::size_t c = 0; c < count_; ++c) {
      ring = {below(c), below(c + 1), above(c + 1), above(c)};
      if (any_on(ring, visit)) return true;
    }
    return false;
  }

 private:
  static Vec3 mean(std::span<const Vec3> points) {
    Vec3 sum = Vec3::Zero();
    for (const Vec3& point : points) sum += point;
    return sum / static_cast<double>(points.size());
  }

  /// Those on one side, whose corners go counter-clockwise seen from without.
  template <typename Visit>
  bool any_on(std::span<const Vec3> ring, const Visit& visit) const {
    const Vec3 middle = mean(corners());
    const Vec3 centre = mean(ring);
    for (std::size_t c = 0; c < ring.size(); ++c) {
      const Tetrahedron all{middle, centre, ring[c], ring[(c + 1) % ring.size()]};
      const Vec3 b = all[1] - all[0];
      if (b.dot((all[2] - all[0]).cross(all[3] - all[0])) > 0 && visit(all)) return true;
    }
    return false;
  }

  std::size_t count_;
  std::array<Vec3, 8> corners_;
  Box box_;
};

bool meet(const Box& a, const Box& b) {
  return (a.lo.array() <= b.hi.array()).all() && (b.lo.array() <= a.hi.array()).all();
}

Tetrahedron shrunk(const Tetrahedron& of) {
  const Vec3 middle = 0.25 * (of[0] + of[1] + of[2] + of[3]);
  Tetrahedron smaller;
  for (std::size_t c = 0; c < 4; ++c) smaller[c] = middle + kShrink * (of[c] - middle);
  return smaller;
}

bool cross(const Cell& a, const Cell& b) {
  if (!meet(a.box(), b.box()) || are_apart(a.corners(), b.corners())) return false;
  return a.any([&](const Tetrahedron& one) {
    const Tetrahedron first = shrunk(one);
    return b.any([&](const Tetrahedron& other) { return !are_apart(first, shrunk(other)); });
  });
}

/// Whether a point lies in a cell or on its faces.
bool holds(const Cell& cell, const Vec3& point) {
  if (!meet(cell.box(), {point, point})) return false;
  return cell.any([&](const Tetrahedron& part) { return !are_apart(part, {&point, 1}); });
}

std::vector<Cell> cells_over(const Layers& layers, const WallFace& face) {
  std::vector<Cell> cells;
  for (int k = 0; k + 1 < layers.levels(); ++k) cells.emplace_back(layers, face, k);
  return cells;
}

/// A cell by the face that it is over, and its level.
using CellName = std::pair<std::array<int, 4>, int>;

using Stacks = std::array<std::vector<Cell>, 2>;

Stacks stacks_of(const Layers& layers, const FacePair& pair) {
  return {cells_over(layers, pair.first), cells_over(layers, pair.second)};
}

/// Whether even what is next to the wall crosses: the wall does, and no height parts its layers.
bool is_hopeless(const Layers& layers, const FacePair& pair) {
  constexpr double kNext = 1e-3;  // of a first cell
  return cross({layers, pair.first, 0, kNext}, {layers, pair.second, 0, kNext});
}

/// The lowest cell of each of two stacks that crosses one of the other, unless that is hopeless.
std::vector<CellName> lowest_crossings(const Layers& layers, const FacePair& pair) {
  const Stacks cells = stacks_of(layers, pair);
  std::vector<CellName> found;
  for (std::size_t f = 0; f < 2; ++f) {
    const auto crosses = [&](const Cell& cell) {
      return std::any_of(cells[1 - f].begin(), cells[1 - f].end(), [&](const Cell& other) {
        return f == 0 ? cross(cell, other) : cross(other, cell);
      });
    };
    const auto lowest = std::find_if(cells[f].begin(), cells[f].end(), crosses);
    if (lowest == cells[f].end()) break;  // nor does any of the other
    found.emplace_back((f == 0 ? pair.first : pair.second).node,
                       static_cast<int>(lowest - cells[f].begin()));
  }
  const auto is_at_wall = [](const CellName& cell) { return cell.second == 0; };
  if (std::ranges::all_of(found, is_at_wall) && is_hopeless(layers, pair)) return {};
  return found;
}

struct Found {
  std::vector<CellName> cells;
  std::vector<int> wall_nodes;
};

Found crossings(const Layers& layers, const FacePair& pair) {
  const std::array<WallFace, 2> faces{pair.first, pair.second};
  const Stacks cells = stacks_of(layers, pair);
  Found found;
  const auto take = [&](std::size_t f, std::size_t level) {
    found.cells.emplace_back(faces[f].node, static_cast<int>(level));
    for (const int node : faces[1 - f].node) {
      if (holds(cells[f][level], layers.at(node, 0))) found.wall_nodes.push_back(node);
    }
  };
  for (std::size_t a = 0; a < cells[0].size(); ++a) {
    for (std::size_t b = 0; b < cells[1].size(); ++b) {
      if (!cross(cells[0][a], cells[1][b])) continue;
      take(0, a);
      take(1, b);
    }
  }
  return found;
}

/// `look(layers, pair)` at all pairs of stacks that may cross.
template <typename Look>
auto at_pairs(const Surface& surface, const Layers& layers, const Look& look) {
  const std::vector<FacePair> pairs = facing_stacks(surface, layers, 1);
  std::vector<decltype(look(layers, pairs.front()))> found(pairs.size());
  parallel::for_ranges(pairs.size(), 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t n = begin; n < end; ++n) found[n] = look(layers, pairs[n]);
  });
  return found;
}

}  // namespace

std::vector<CellName> lowest_crossed(const Surface& surface, const MultiBlock& mesh) {
  std::set<CellName> cells;
  for (const auto& some : at_pairs(surface, mesh.layers, lowest_crossings)) {
    cells.insert(some.begin(), some.end());
  }
  return {cells.begin(), cells.end()};
}

CrossingsReport check_crossings(const Surface& surface, const MultiBlock& mesh) {
  const Layers& layers = mesh.layers;
  const std::vector<Found> found = at_pairs(surface, layers, crossings);
  std::set<CellName> cells;
  std::set<int> wall_nodes;
  CrossingsReport report;
  for (const Found& some : found) {
    if (cells.empty() && !some.cells.empty()) {
      const auto& foot = some.cells.front().first;
      report.place_world = 0.5 * (layers.at(foot[0], 0) + layers.at(foot[2], 0));
    }
    cells.insert(some.cells.begin(), some.cells.end());
    for (const int node : some.wall_nodes) {
      if (!surface.is_copy(static_cast<std::size_t>(node))) wall_nodes.insert(node);
    }
  }
  report.cells = cells.size();
  report.wall_points = wall_nodes.size();
  return report;
}

}  // namespace vdb_offset
