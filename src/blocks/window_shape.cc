#include "blocks/window_shape.h"

#include <algorithm>
#include <limits>

#include "blocks/face_state.h"

namespace vdb_offset {
namespace {

/// Levels lower than this part of the shortest edge beside them stay where the march put them, at
/// their true distance; the first level, that solvers ask for, up to the second.
constexpr double kNearWall = 0.05;
constexpr double kFirstNearWall = 0.5;

/// What a window can do when it is made anew: so many times the quality asked for, but no more than
/// the wall's own, rounding apart.
constexpr double kAim = 2;
constexpr double kOfWallAim = 0.999;

std::size_t at(int index) { return static_cast<std::size_t>(index); }

/// As long as on the wall; where columns spread far, as behind a thin trailing edge, as they have.
/// Lesser fans are to share what they spread with their neighbours. Columns that leave one place,
/// those of a fan block, are to keep the angle between them.
std::vector<double> edge_lengths(const WindowShape& shape, int a, int b) {
  constexpr double kFar = 40;  // times the wall's edge
  constexpr double kShare = 0.25;
  const ColumnVector& x = shape.points_world;
  std::vector<double> lengths(x.levels());
  if (a != b && x.get(at(a), 0) == x.get(at(b), 0)) {
    const auto way = [&](int s) { return (x.get(at(s), 1) - x.get(at(s), 0)).normalized(); };
    const double chord = (way(a) - way(b)).norm();
    for (std::size_t k = 1; k < lengths.size(); ++k) {
      lengths[k] = 0.5 * chord * (shape.heights_world[at(a)][k] + shape.heights_world[at(b)][k]);
    }
    return lengths;
  }
  for (std::size_t k = 0; k < lengths.size(); ++k) {
    const double length = (x.get(at(a), k) - x.get(at(b), k)).norm();
    lengths[k] = length;
    if (k == 0 || !(lengths[0] > 0)) continue;
    lengths[k] =
        std::max(lengths[0], length * std::clamp(length / (kFar * lengths[0]), kShare, 1.0));
  }
  return lengths;
}

/// Levels at the wall that need not move: low beside the edges there, and their cells good.
std::vector<std::size_t> first_free_levels(const WindowShape& shape) {
  const std::size_t levels = shape.points_world.levels();
  std::vector<double> edge(shape.window.nodes.size(), std::numeric_limits<double>::infinity());
  for (std::size_t f = 0; f < shape.goals.size(); ++f) {
    const ColumnFace& face = shape.window.faces[f];
    for (std::size_t c = 0; c < face.count; ++c) {
      const double length = shape.goals[f].edges_world[c].front();
      if (!(length > 0)) continue;
      edge[at(face.column[c])] = std::min(edge[at(face.column[c])], length);
      edge[at(face.next(c))] = std::min(edge[at(face.next(c))], length);
    }
  }
  std::vector<std::size_t> first(edge.size(), 1);
  for (std::size_t s = 0; s < first.size(); ++s) {
    const std::vector<double>& heights = shape.heights_world[s];
    if (levels > 2 && heights[1] < kFirstNearWall * edge[s]) first[s] = 2;
    while (first[s] + 1 < levels && heights[first[s]] < kNearWall * edge[s]) ++first[s];
  }
  const auto point = [&](int slot, std::size_t level) {
    return shape.points_world.get(at(slot), level);
  };
  for (std::size_t f = 0; f < shape.goals.size(); ++f) {
    const ColumnFace& face = shape.window.faces[f];
    std::size_t good = 0;
    while (good + 1 < levels &&
           is_good(cell_quality(cell_of(face, good, point)), shape.goals[f].least_quality)) {
      ++good;
    }
    for (std::size_t c = 0; c < face.count; ++c) {
      std::size_t& own = first[at(face.column[c])];
      own = std::min(own, std::max<std::size_t>(1, good));
    }
  }
  for (std::size_t s = 0; s < first.size(); ++s) {
    if (!(shape.heights_world[s].back() > 0)) first[s] = levels;  // of no height: none moves
  }
  return first;
}

}  // namespace

WindowShape make_shape(const MultiBlock& mesh, Window window, double quality) {
  WindowShape shape;
  const auto levels = at(mesh.layers.levels());
  shape.window = std::move(window);
  shape.points_world = ColumnVector(shape.window.nodes.size(), levels);
  for (std::size_t s = 0; s < shape.window.nodes.size(); ++s) {
    const int node = shape.window.nodes[s];
    for (std::size_t k = 0; k < levels; ++k) {
      shape.points_world.set(s, k, mesh.layers.at(node, static_cast<int>(k)));
    }
    shape.heights_world.push_back(mesh.layers.heights(at(node)));
    shape.ends_on.push_back(mesh.layers.ended_on(node));
  }
  const auto point = [&](int slot, std::size_t level) {
    return shape.points_world.get(at(slot), level);
  };
  for (const ColumnFace& face : shape.window.faces) {
    FaceGoal& goal = shape.goals.emplace_back();
    goal.least_quality = std::min(kAim * quality, kOfWallAim * wall_quality(face, point));
    for (std::size_t c = 0; c < face.count; ++c) {
      goal.edges_world[c] = edge_lengths(shape, face.column[c], face.next(c));
    }
  }
  shape.first_free = first_free_levels(shape);
  shape.kept_from.assign(shape.window.nodes.size(), 0);
  return shape;
}

WindowShape cut_out(const WindowShape& whole, const Window& part) {
  WindowShape cut;
  const std::size_t levels = whole.points_world.levels();
  cut.window = part;
  cut.points_world = ColumnVector(part.nodes.size(), levels);
  for (std::size_t s = 0; s < part.nodes.size(); ++s) {
    const std::size_t slot = at(part.nodes[s]);
    cut.window.nodes[s] = whole.window.nodes[slot];
    cut.heights_world.push_back(whole.heights_world[slot]);
    cut.first_free.push_back(whole.first_free[slot]);
    cut.ends_on.push_back(whole.ends_on[slot]);
    cut.kept_from.push_back(whole.kept_from[slot]);
    for (std::size_t k = 0; k < levels; ++k) {
      cut.points_world.set(s, k, whole.points_world.get(slot, k));
    }
  }
  for (const int face : part.face_index) cut.goals.push_back(whole.goals[at(face)]);
  return cut;
}

void put_back(const WindowShape& cut, const Window& part, WindowShape& whole) {
  for (std::size_t s = 0; s < part.free; ++s) {
    for (std::size_t k = 1; k < cut.points_world.levels(); ++k) {
      whole.points_world.set(at(part.nodes[s]), k, cut.points_world.get(s, k));
    }
  }
}

}  // namespace vdb_offset
