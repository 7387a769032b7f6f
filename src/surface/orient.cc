// Every grid edge is used by at most two cells; two that share it must run along it in opposite
// senses. Patches are the nodes of a graph, shared edges its links: a flood fill orients them.

#include "surface/orient.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <deque>
#include <tuple>
#include <utility>

#include "core/parallel.h"
#include "core/sets.h"
#include "surface/corner_touch.h"
#include "vdb_offset/core/error.h"
#include "vdb_offset/surface/turn_round.h"

namespace vdb_offset {

namespace {

struct EdgeUse {
  int lo, hi;  // nodes
  int patch;
  int corner;    // index over all cells' corners: 4 * cell + side
  bool forward;  // the cell runs from lo to hi
};

struct CellGrid {
  std::vector<EdgeUse> uses;
  std::vector<int> corner_node;         // node of each cell corner, -1 for cells without area
  std::vector<std::size_t> first_cell;  // of each patch
};

int distinct(std::array<int, 4> n) {
  std::sort(n.begin(), n.end());
  return static_cast<int>(std::unique(n.begin(), n.end()) - n.begin());
}

void add_cell(CellGrid& grid, const std::array<int, 4>& n, int patch) {
  const auto corner = static_cast<int>(grid.corner_node.size());
  if (distinct(n) < 3) {
    grid.corner_node.insert(grid.corner_node.end(), 4, -1);
    return;
  }
  for (std::size_t s = 0; s < 4; ++s) {
    grid.corner_node.push_back(n[s]);
    const int a = n[s];
    const int b = n[(s + 1) % 4];
    if (a == b) continue;
    grid.uses.push_back(
        {std::min(a, b), std::max(a, b), patch, corner + static_cast<int>(s), a < b});
  }
}

CellGrid make_cells(NodeGrids grids) {
  CellGrid grid;
  for (std::size_t p = 0; p < grids.patches.size(); ++p) {
    const Patch& patch = grids.patches[p];
    grid.first_cell.push_back(grid.corner_node.size() / 4);
    for_cells(patch, [&](std::array<int, 4> corners) {
      for (int& corner : corners) corner = grids.nodes[p][static_cast<std::size_t>(corner)];
      add_cell(grid, corners, static_cast<int>(p));
    });
  }
  parallel::sort(grid.uses.begin(), grid.uses.end(), [](const EdgeUse& a, const EdgeUse& b) {
    return std::tie(a.lo, a.hi, a.corner) < std::tie(b.lo, b.hi, b.corner);
  });
  return grid;
}

/// The point of its patch that a cell's corner is.
int point_of(NodeGrids grids, const CellGrid& grid, int patch, int corner) {
  const auto p = static_cast<std::size_t>(patch);
  const Patch& of = grids.patches[p];
  const int cell = corner / 4 - static_cast<int>(grid.first_cell[p]);
  const int side = corner % 4;
  if (!of.is_grid())
    return of.faces[static_cast<std::size_t>(cell)][static_cast<std::size_t>(side)];
  return (cell / (of.ni - 1) + (side >= 2 ? 1 : 0)) * of.ni + cell % (of.ni - 1) +
         (side == 1 || side == 2 ? 1 : 0);
}

int next_corner(int corner) { return corner / 4 * 4 + (corner + 1) % 4; }

/// Names the start of an edge as a place on its patch.
std::string place_of(NodeGrids grids, const CellGrid& grid, const EdgeUse& use) {
  const Patch& patch = grids.patches[static_cast<std::size_t>(use.patch)];
  const int point = point_of(grids, grid, use.patch, use.corner);
  if (grids.is_flat) return curve_place(patch, use.patch, point % patch.ni);
  return place(patch, use.patch, point % patch.ni, point / patch.ni);
}

struct Link {
  int patch;
  bool agrees;
  std::size_t use;  // an edge that says so
};

/// Four cells on an edge are two of each of two bodies, if there are two.
constexpr const char* kBodies =
    "or, of two bodies that touch or overlap there, unite them, move them apart, or mesh each in "
    "a run of its own (of bodies that overlap other sizes of cells may do: no points coincide "
    "then)";

/// Calls pair(first_use, second_use) for every edge of two cells; refuses three.
template <typename Pair>
void for_pairs(NodeGrids grids, const CellGrid& grid, const Pair& pair) {
  for (std::size_t u = 0; u < grid.uses.size();) {
    std::size_t last = u + 1;
    while (last < grid.uses.size() && grid.uses[last].lo == grid.uses[u].lo &&
           grid.uses[last].hi == grid.uses[u].hi) {
      ++last;
    }
    if (last - u > 2) {
      throw InputError(
          fmt::format("{}, at {}, {} and {}; remove the doubled or inner {}; {}",
                      grids.is_flat
                          ? fmt::format("{} segments of curves meet in one point, and two at most "
                                        "bound a flow",
                                        last - u)
                          : fmt::format("the surface is not a manifold: {} cells meet on one edge",
                                        last - u),
                      place_of(grids, grid, grid.uses[u]), place_of(grids, grid, grid.uses[u + 1]),
                      place_of(grids, grid, grid.uses[u + 2]), grids.is_flat ? "curve" : "patch",
                      last - u == 4   ? kBodies
                      : grids.is_flat ? "or mesh them in runs of their own"
                                      : kStandsThere),
          {grid.uses[u].patch, grid.uses[u + 1].patch, grid.uses[u + 2].patch});
    }
    if (last - u == 2) pair(u, u + 1);
    u = last;
  }
}

std::vector<std::vector<Link>> link_patches(NodeGrids grids, const CellGrid& grid) {
  std::vector<std::vector<Link>> links(grids.patches.size());
  for_pairs(grids, grid, [&](std::size_t u, std::size_t v) {
    const EdgeUse& a = grid.uses[u];
    const EdgeUse& b = grid.uses[v];
    const bool agrees = a.forward != b.forward;
    if (a.corner / 4 == b.corner / 4) {
      throw InputError(fmt::format("a cell is folded onto itself at {}; mend the patch there",
                                   place_of(grids, grid, a)),
                       {a.patch});
    }
    if (a.patch == b.patch && agrees) return;
    links[static_cast<std::size_t>(a.patch)].push_back({b.patch, agrees, u});
    links[static_cast<std::size_t>(b.patch)].push_back({a.patch, agrees, v});
  });
  return links;
}

/// An edge of one cell that ends in a node, as seen from there.
struct Spoke {
  const EdgeUse* use;
  Vec3 direction;  // unit, away from the node
};

std::vector<Spoke> free_spokes(NodeGrids grids, const CellGrid& grid, int node) {
  std::vector<Spoke> spokes;
  const auto same = [&](std::size_t u, std::size_t v) {
    return v < grid.uses.size() && grid.uses[u].lo == grid.uses[v].lo &&
           grid.uses[u].hi == grid.uses[v].hi;
  };
  for (std::size_t u = 0; u < grid.uses.size(); ++u) {
    const EdgeUse& use = grid.uses[u];
    if ((use.lo != node && use.hi != node) || same(u, u + 1) || (u > 0 && same(u, u - 1))) continue;
    const Patch& patch = grids.patches[static_cast<std::size_t>(use.patch)];
    const auto point = [&](int corner) -> const Vec3& {
      const int index = point_of(grids, grid, use.patch, corner);
      return patch.points_world[static_cast<std::size_t>(index)];
    };
    const bool starts = (use.lo == node) == use.forward;
    const Vec3 way = (starts ? 1.0 : -1.0) * (point(next_corner(use.corner)) - point(use.corner));
    spokes.push_back({&use, way.normalized()});
  }
  return spokes;
}

/// "side jmax of patch 2 'b' (5 points)"
std::string side_of(NodeGrids grids, const EdgeUse& use) {
  constexpr std::array<const char*, 4> kSides{"jmin", "imax", "jmax", "imin"};
  const Patch& patch = grids.patches[static_cast<std::size_t>(use.patch)];
  if (!patch.is_grid()) return "the rim of " + name_of(patch, use.patch);
  const int side = use.corner % 4;
  return fmt::format("side {} of {} ({} points)", kSides[static_cast<std::size_t>(side)],
                     name_of(patch, use.patch), side % 2 == 0 ? patch.ni : patch.nj);
}

/// Where one part stands on the cells of another, which do not have its edge.
void refuse_standing(NodeGrids grids, const CellGrid& grid, const std::vector<Spoke>& spokes,
                     int node) {
  for (const EdgeUse& use : grid.uses) {
    for (const int corner : {use.corner, next_corner(use.corner)}) {
      if (grid.corner_node[static_cast<std::size_t>(corner)] != node) continue;
      const Patch& patch = grids.patches[static_cast<std::size_t>(use.patch)];
      const auto way = [&](int to) -> Vec3 {
        const auto point = [&](int c) -> const Vec3& {
          return patch.points_world[static_cast<std::size_t>(point_of(grids, grid, use.patch, c))];
        };
        return point(corner / 4 * 4 + (to + 4) % 4) - point(corner);
      };
      const auto found = std::ranges::find_if(spokes, [&](const Spoke& spoke) {
        return corner_touch(spoke.direction, way(corner % 4 + 1), way(corner % 4 - 1)) ==
               CornerTouch::OnFace;
      });
      if (found == spokes.end()) continue;
      throw InputError(
          fmt::format("the surface is not a manifold: {} lies across cells of {} from {} on: three "
                      "faces meet there, and a wall has one or two at an edge; {}",
                      side_of(grids, *found->use), name_of(patch, use.patch),
                      place_of(grids, grid, *found->use), kStandsThere),
          {found->use->patch, use.patch});
    }
  }
}

/// Two free edges that leave a node the same way belong to sides that were meant to be one.
[[noreturn]] void refuse_touch(NodeGrids grids, const CellGrid& grid, const EdgeUse& use,
                               int node) {
  constexpr double kAlong = 0.95;  // cosine of 18 degrees
  const std::vector<Spoke> spokes = free_spokes(grids, grid, node);
  for (std::size_t a = 0; a < spokes.size(); ++a) {
    for (std::size_t b = a + 1; b < spokes.size(); ++b) {
      if (!(spokes[a].direction.dot(spokes[b].direction) > kAlong)) continue;
      const auto [first, second] = std::pair(spokes[a].use, spokes[b].use);
      throw InputError(
          fmt::format("points do not match where {} and {} run along each other, near {}; give "
                      "both sides the same points there",
                      side_of(grids, *first), side_of(grids, *second),
                      place_of(grids, grid, *first)),
          {first->patch, second->patch});
    }
  }
  refuse_standing(grids, grid, spokes, node);
  throw InputError(
      fmt::format("the surface is not a manifold: parts of it touch in a single node only, "
                  "near {}; move them apart or join them along an edge",
                  place_of(grids, grid, use)),
      {use.patch});
}

/// Fans: the corners at a node must be connected through shared edges.
void check_fans(NodeGrids grids, const CellGrid& grid) {
  Sets corners(grid.corner_node.size());
  const auto node = [&](int c) { return grid.corner_node[static_cast<std::size_t>(c)]; };
  for (int c = 0; c < static_cast<int>(grid.corner_node.size()); c += 4) {
    for (int s = 0; s < 4; ++s) {
      if (node(c) >= 0 && node(c + s) == node(c + (s + 1) % 4))
        corners.join(c + s, c + (s + 1) % 4);
    }
  }
  for_pairs(grids, grid, [&](std::size_t u, std::size_t v) {
    const int a = grid.uses[u].corner;
    const int b = grid.uses[v].corner;
    const bool same = node(a) == node(b);
    corners.join(a, same ? b : next_corner(b));
    corners.join(next_corner(a), same ? next_corner(b) : b);
  });
  std::vector<int> fan;
  for (const EdgeUse& use : grid.uses) {
    for (const int c : {use.corner, next_corner(use.corner)}) {
      if (static_cast<std::size_t>(node(c)) >= fan.size()) {
        fan.resize(static_cast<std::size_t>(node(c)) + 1, -1);
      }
      int& first = fan[static_cast<std::size_t>(node(c))];
      if (first < 0) first = corners.root(c);
      if (first != corners.root(c)) refuse_touch(grids, grid, use, node(c));
    }
  }
}

/// Visit the component of `seed`: set component and turn of each of its patches.
void flood(NodeGrids grids, const CellGrid& grid, const std::vector<std::vector<Link>>& links,
           std::size_t seed, Orientation& result, std::vector<char>& turned) {
  std::deque<std::size_t> queue{seed};
  result.component[seed] = result.components;
  while (!queue.empty()) {
    const std::size_t p = queue.front();
    queue.pop_front();
    for (const Link& link : links[p]) {
      const auto q = static_cast<std::size_t>(link.patch);
      const char turn = link.agrees ? turned[p] : static_cast<char>(1 - turned[p]);
      if (result.component[q] < 0) {
        result.component[q] = result.components;
        turned[q] = turn;
        queue.push_back(q);
      } else if (turned[q] != turn) {
        throw InputError(
            fmt::format("the surface cannot be oriented: normals contradict each other where patch "
                        "'{}' meets patch '{}', at {}; it has one side only, like a Moebius strip",
                        grids.patches[p].name, grids.patches[q].name,
                        place_of(grids, grid, grid.uses[link.use])),
            {static_cast<std::int64_t>(p), link.patch});
      }
    }
  }
  ++result.components;
}

}  // namespace

std::string name_of(const Patch& patch, int number) {
  const std::string name = fmt::format("patch {} '{}'", number + 1, patch.name);
  return patch.file.empty() ? name : name + " of " + patch.file;
}

std::string curve_place(const Patch& patch, int number, int i) {
  const Vec3& x = patch.at(i, 0);
  return fmt::format("{}, point {} at ({:g}, {:g})", name_of(patch, number), i + 1, x.x(), x.y());
}

std::string place(const Patch& patch, int number, int i, int j) {
  const Vec3& x = patch.at(i, j);
  if (patch.nj == 1) return curve_place(patch, number, i);
  if (!patch.is_grid()) {
    return fmt::format("{}, at ({:g}, {:g}, {:g})", name_of(patch, number), x.x(), x.y(), x.z());
  }
  return fmt::format("{}, point ({}, {}) at ({:g}, {:g}, {:g})", name_of(patch, number), i + 1,
                     j + 1, x.x(), x.y(), x.z());
}

void flip(NodeGrids grids, std::size_t patch) {
  const Patch& p = grids.patches[patch];
  turn_round(grids.patches[patch]);
  if (!p.is_grid()) return;
  std::vector<int>& nodes = grids.nodes[patch];
  for (auto row = nodes.begin(); row != nodes.end(); row += p.ni) std::reverse(row, row + p.ni);
}

Orientation orient(NodeGrids grids) {
  const CellGrid grid = make_cells(grids);
  const std::vector<std::vector<Link>> links = link_patches(grids, grid);
  check_fans(grids, grid);
  Orientation result;
  result.component.assign(grids.patches.size(), -1);
  std::vector<char> turned(grids.patches.size(), 0);
  for (std::size_t p = 0; p < grids.patches.size(); ++p) {
    if (result.component[p] < 0) flood(grids, grid, links, p, result, turned);
  }
  for (std::size_t p = 0; p < grids.patches.size(); ++p) {
    if (turned[p] == 0) continue;
    flip(grids, p);
    result.flipped.push_back(static_cast<int>(p));
  }
  return result;
}

}  // namespace vdb_offset
