#include "surface/sharp_edges.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "surface/topology.h"

namespace vdb_offset {

namespace {

// Over a wall without thickness there is no way to turn.
constexpr double kLargestTurn = std::numbers::pi * 179 / 180;

std::size_t at(int index) { return static_cast<std::size_t>(index); }

/// Of a cell's quad; its length is twice the area.
Vec3 cell_normal(const Patch& patch, int i, int j) {
  const Vec3 up = patch.at(i + 1, j + 1) - patch.at(i, j);
  return up.cross(patch.at(i, j + 1) - patch.at(i + 1, j));
}

/// `along`: the edge, counter-clockwise about the first cell.
double turn(const Vec3& normal, const Vec3& next, const Vec3& along) {
  if (!(normal.squaredNorm() > 0 && next.squaredNorm() > 0 && along.squaredNorm() > 0)) return 0;
  return std::atan2(normal.cross(next).dot(along.normalized()), normal.dot(next));
}

Vec3 normal_beside(const Patch& patch, Side side, int s) {
  switch (side) {
    case Side::IMin:
      return cell_normal(patch, 0, s);
    case Side::IMax:
      return cell_normal(patch, patch.ni - 2, s);
    case Side::JMin:
      return cell_normal(patch, s, 0);
    case Side::JMax:
      break;
  }
  return cell_normal(patch, s, patch.nj - 2);
}

/// A grid edge within a patch, from point `at` of a line to the next.
struct InnerEdge {
  bool along_j;  // on a line i = const
  int line;
  int at;
  double turn;
};

template <typename Visit>
void for_inner_edges(const Patch& patch, const Visit& visit) {
  for (int j = 0; j < patch.nj; ++j) {
    for (int i = 0; i < patch.ni; ++i) {
      if (i > 0 && i + 1 < patch.ni && j + 1 < patch.nj) {
        const Vec3 along = patch.at(i, j + 1) - patch.at(i, j);
        visit(InnerEdge{true, i, j,
                        turn(cell_normal(patch, i - 1, j), cell_normal(patch, i, j), along)});
      }
      if (j > 0 && j + 1 < patch.nj && i + 1 < patch.ni) {
        const Vec3 along = patch.at(i, j) - patch.at(i + 1, j);
        visit(InnerEdge{false, j, i,
                        turn(cell_normal(patch, i, j - 1), cell_normal(patch, i, j), along)});
      }
    }
  }
}

/// The lines at which a patch is cut, its first and last among them.
struct Cuts {
  std::vector<int> i, j;
};

Cuts find_cuts(const Patch& patch) {
  struct Line {
    std::vector<char> sharp;
  };
  std::vector<Line> lines_i(at(patch.ni), Line{std::vector<char>(at(patch.nj - 1), 0)});
  std::vector<Line> lines_j(at(patch.nj), Line{std::vector<char>(at(patch.ni - 1), 0)});
  for_inner_edges(patch, [&](const InnerEdge& edge) {
    if (!is_sharp(edge.turn)) return;
    (edge.along_j ? lines_i : lines_j)[at(edge.line)].sharp[at(edge.at)] = 1;
  });
  const auto cuts = [](const std::vector<Line>& lines) {
    std::vector<int> result{0};
    for (std::size_t n = 1; n + 1 < lines.size(); ++n) {
      const std::vector<char>& sharp = lines[n].sharp;
      bool is_cut = sharp.size() == 1 && sharp[0] != 0;
      for (std::size_t s = 1; s < sharp.size(); ++s) {
        is_cut = is_cut || (sharp[s - 1] != 0 && sharp[s] != 0);
      }
      if (is_cut) result.push_back(static_cast<int>(n));
    }
    result.push_back(static_cast<int>(lines.size()) - 1);
    return result;
  };
  return {cuts(lines_i), cuts(lines_j)};
}

struct Piece {
  Patch patch;
  std::vector<int> nodes;
};

/// The points of a patch from `from` to `to`, inclusive.
Piece cut_out(const Surface& surface, std::size_t p, std::array<int, 2> from,
              std::array<int, 2> to) {
  const Patch& whole = surface.patches[p];
  Piece piece;
  piece.patch.family = whole.family;
  piece.patch.file = whole.file;
  piece.patch.part_of = whole.name;
  piece.patch.body = whole.body;
  piece.patch.loose = whole.loose;
  piece.patch.ni = to[0] - from[0] + 1;
  piece.patch.nj = to[1] - from[1] + 1;
  for (int j = from[1]; j <= to[1]; ++j) {
    for (int i = from[0]; i <= to[0]; ++i) {
      piece.patch.points_world.push_back(whole.at(i, j));
      piece.nodes.push_back(surface.node(static_cast<int>(p), i, j));
    }
  }
  return piece;
}

}  // namespace

bool is_sharp(double turn) { return turn > kSharpTurn && turn < kLargestTurn; }

bool runs_along(const SideRange& range) {
  const bool along_index = range.side == Side::JMin || range.side == Side::IMax;
  return along_index == (range.begin < range.end);
}

double turn_across(const Patches& patches, const Edge& edge, int s) {
  const Patch& first = patches[at(edge.first.patch)];
  const Patch& second = patches[at(edge.second.patch)];
  const int a = edge.first.begin + s;
  const bool along = edge.second.end > edge.second.begin;
  const int b = along ? edge.second.begin + s : edge.second.begin - s - 1;
  const Vec3& from = first.points_world[at(side_point(first, edge.first.side, a))];
  const Vec3& to = first.points_world[at(side_point(first, edge.first.side, a + 1))];
  const Vec3 normal = normal_beside(first, edge.first.side, a);
  const Vec3 next = normal_beside(second, edge.second.side, b);
  return turn(normal, next, runs_along(edge.first) ? Vec3(to - from) : Vec3(from - to));
}

void split_at_sharp_edges(Surface& surface, std::vector<int>& component) {
  Surface split;
  std::vector<int> new_component;
  std::vector<int> new_flipped;
  for (std::size_t p = 0; p < surface.patches.size(); ++p) {
    const Cuts cuts = find_cuts(surface.patches[p]);
    const std::size_t pieces = (cuts.i.size() - 1) * (cuts.j.size() - 1);
    const auto first = static_cast<int>(split.patches.size());
    for (std::size_t n = 0; n < pieces; ++n) {
      const std::size_t i = n % (cuts.i.size() - 1);
      const std::size_t j = n / (cuts.i.size() - 1);
      Piece piece = cut_out(surface, p, {cuts.i[i], cuts.j[j]}, {cuts.i[i + 1], cuts.j[j + 1]});
      piece.patch.name = fmt::format("{} part {}", surface.patches[p].name, n + 1);
      if (pieces == 1) piece.patch = std::move(surface.patches[p]);
      split.patches.push_back(std::move(piece.patch));
      split.patch_nodes.push_back(std::move(piece.nodes));
      new_component.push_back(component[p]);
    }
    surface.report.split_patches += static_cast<int>(pieces) - 1;
    const std::vector<int>& flipped = surface.report.flipped;
    if (std::find(flipped.begin(), flipped.end(), static_cast<int>(p)) == flipped.end()) continue;
    for (std::size_t n = 0; n < pieces; ++n) new_flipped.push_back(first + static_cast<int>(n));
  }
  surface.patches = std::move(split.patches);
  surface.patch_nodes = std::move(split.patch_nodes);
  surface.report.flipped = std::move(new_flipped);
  component = std::move(new_component);
}

std::vector<char> concave_nodes(const Surface& surface, const Topology& topology) {
  std::vector<char> concave(surface.nodes_world.size(), 0);
  for (std::size_t p = 0; p < surface.patches.size(); ++p) {
    for_inner_edges(surface.patches[p], [&](const InnerEdge& edge) {
      if (edge.turn > -kSharpTurn) return;
      const auto mark = [&](int i, int j) {
        concave[at(surface.node(static_cast<int>(p), i, j))] = 1;
      };
      for (const int step : {0, 1}) {
        if (edge.along_j) {
          mark(edge.line, edge.at + step);
        } else {
          mark(edge.at + step, edge.line);
        }
      }
    });
  }
  for (const Edge& edge : topology.edges) {
    if (edge.kind != EdgeKind::Interface) continue;
    const Patch& patch = surface.patches[at(edge.first.patch)];
    for (int s = 0; s < edge.first.cells(); ++s) {
      if (turn_across(surface.patches, edge, s) > -kSharpTurn) continue;
      for (const int step : {s, s + 1}) {
        const int point = side_point(patch, edge.first.side, edge.first.begin + step);
        concave[at(surface.patch_nodes[at(edge.first.patch)][at(point)])] = 1;
      }
    }
  }
  return concave;
}

}  // namespace vdb_offset
