// Section 4.5 of Wang, Guibault, Camarero leaves collapsed elements to elliptic smoothing, which
// cannot promise anything; windows round them are made anew here (see untangle.cc).

#include "vdb_offset/blocks/repair.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <chrono>

#include "blocks/face_state.h"
#include "blocks/untangle.h"
#include "blocks/window.h"
#include "core/parallel.h"
#include "vdb_offset/core/error.h"

namespace vdb_offset {
namespace {

int env(const char* name, int preset) {
  const char* text = std::getenv(name);
  return text ? std::atoi(text) : preset;
}
int kRings = env("VO_RINGS", 6);      // of faces around bad ones that move with them
int kRounds = env("VO_ROUNDS", 6);
constexpr double kCollapsed = 0.05;   // spread below which columns have merged
constexpr double kLower = 0.8;        // of a height, where there is no valid place at it
constexpr double kCare = 4;           // how much more a face counts in the next round
constexpr double kMostCare = 64;
constexpr double kLeastGrading = 1.2;
constexpr double kSteepest = 1;
/// Part of the wall's own quality that its cells have to keep.
constexpr double kOfWall = 0.7;

std::size_t at(int index) { return static_cast<std::size_t>(index); }

/// Faces that need repair, by their columns.
std::vector<bool> mark(const ColumnGraph& graph, const MultiBlock& mesh, double quality) {
  const auto levels = at(mesh.layers.levels());
  const auto point = [&](int column, std::size_t level) -> const Vec3& {
    return mesh.layers.at(column, static_cast<int>(level));
  };
  std::vector<char> bad(graph.faces.size(), 0);
  parallel::for_ranges(graph.faces.size(), 64, [&](std::size_t begin, std::size_t end) {
    for (std::size_t f = begin; f < end; ++f) {
      const ColumnFace& face = graph.faces[f];
      for (std::size_t part = 1; part <= 4; ++part) {
        if (spread(face, (levels - 1) * part / 4, point) < kCollapsed) bad[f] = 1;
      }
      if (bad[f] != 0) continue;
      const double wanted = std::min(quality, kOfWall * wall_quality(face, point));
      const FaceState state = judge_face(face, levels - 1, point);
      if (!state.positive || state.scaled_jacobian < wanted) bad[f] = 1;
    }
  });
  std::vector<bool> marked(at(mesh.nodes()), false);
  for (std::size_t f = 0; f < bad.size(); ++f) {
    if (bad[f] == 0) continue;
    for (std::size_t c = 0; c < graph.faces[f].count; ++c) marked[at(graph.faces[f].column[c])] = true;
  }
  return marked;
}

/// As long as on the wall; where columns spread far, as behind a thin trailing edge, as they have.
/// Lesser fans are to share what they spread with their neighbours.
std::vector<double> edge_lengths(const ColumnVector& x, int a, int b) {
  constexpr double kFar = 40;  // times the wall's edge
  constexpr double kShare = 0.25;
  std::vector<double> lengths(x.levels());
  for (std::size_t k = 0; k < lengths.size(); ++k) {
    const double length = (x.get(at(a), k) - x.get(at(b), k)).norm();
    lengths[k] = length;
    if (k == 0 || !(lengths[0] > 0)) continue;
    lengths[k] = std::max(lengths[0],
                          length * std::clamp(length / (kFar * lengths[0]), kShare, 1.0));
  }
  return lengths;
}

/// One window on its way to a valid mesh.
class WindowRepair {
 public:
  WindowRepair(const Surface& surface, const MultiBlock& mesh, const Window& window,
               double quality);
  void run(const Progress& progress);
  void write(MultiBlock& mesh) const;

  UntangleReport last;
  int steps = 0;
  int rounds = 0;
  bool valid = false;
  bool positive = false;

 private:
  bool take_care();
  void lower(const std::vector<bool>& columns);
  void set_height(std::size_t slot, double height);

  const Surface& surface_;
  const Layers& layers_;
  const Window& window_;
  WindowShape shape_;
  std::vector<double> wanted_;  // least scaled Jacobian of each face
};

WindowRepair::WindowRepair(const Surface& surface, const MultiBlock& mesh, const Window& window,
                           double quality)
    : surface_(surface), layers_(mesh.layers), window_(window) {
  const auto levels = at(layers_.levels());
  shape_.points_world = ColumnVector(window.nodes.size(), levels);
  for (std::size_t s = 0; s < window.nodes.size(); ++s) {
    for (std::size_t k = 0; k < levels; ++k) {
      shape_.points_world.set(s, k, layers_.at(window.nodes[s], static_cast<int>(k)));
    }
    shape_.heights_world.push_back(layers_.heights(at(window.nodes[s])));
  }
  const auto point = [&](int slot, std::size_t level) {
    return shape_.points_world.get(at(slot), level);
  };
  for (const ColumnFace& face : window.faces) {
    wanted_.push_back(std::min(quality, kOfWall * wall_quality(face, point)));
    shape_.care.emplace_back();
    auto& edges = shape_.edges_world.emplace_back();
    for (std::size_t c = 0; c < face.count; ++c) {
      edges[c] = edge_lengths(shape_.points_world, face.column[c], face.next(c));
    }
  }
}

/// Looks at all faces, and raises the care for those that fail; where care did not help their
/// heights sink. Whether none fails.
bool WindowRepair::take_care() {
  std::vector<FaceState> states(window_.faces.size());
  parallel::for_ranges(states.size(), 64, [&](std::size_t begin, std::size_t end) {
    for (std::size_t f = begin; f < end; ++f) {
      states[f] = judge_face(
          window_.faces[f], shape_.points_world.levels() - 1,
          [&](int slot, std::size_t level) { return shape_.points_world.get(at(slot), level); });
    }
  });
  std::vector<bool> sinking(window_.free, false);
  bool sink = false;
  bool fails = false;
  positive = true;
  int nbad = 0, nlow = 0;
  for (std::size_t f = 0; f < states.size(); ++f) {
    WindowShape::Care& care = shape_.care[f];
    positive = positive && states[f].positive;
    if (states[f].positive && states[f].scaled_jacobian >= wanted_[f]) continue;
    fails = true;
    nbad += !states[f].positive; ++nlow;
    const bool had_care = care.tetrahedra;
    care.tetrahedra = true;
    care.weight = std::min(care.weight * kCare, kMostCare);
    if (states[f].positive || !had_care) continue;
    for (std::size_t c = 0; c < window_.faces[f].count; ++c) {
      const std::size_t slot = at(window_.faces[f].column[c]);
      if (slot < window_.free) sinking[slot] = sink = true;
    }
  }
  if (sink && rounds < kRounds) lower(sinking);
  if (std::getenv("VO_TALK")) std::fprintf(stderr, "  round %d: steps %d failing %d of them bad %d, least %.3g\n", rounds, last.steps, nlow, nbad, last.least);
  return !fails;
}

/// Puts a column's levels to a lesser height, along the column as it is.
void WindowRepair::set_height(std::size_t slot, double height) {
  std::vector<double>& heights = shape_.heights_world[slot];
  if (!(height < heights.back())) return;
  const double first = layers_.first_asked_world[at(window_.nodes[slot])];
  const std::vector<double> lower = rescale(layers_.spacing, height, first);
  std::vector<Vec3> points;
  std::size_t k = 0;
  for (const double h : lower) {
    while (k + 2 < heights.size() && heights[k + 1] < h) ++k;
    const double part = std::clamp((h - heights[k]) / (heights[k + 1] - heights[k]), 0.0, 1.0);
    points.emplace_back((1 - part) * shape_.points_world.get(slot, k) +
                        part * shape_.points_world.get(slot, k + 1));
  }
  for (std::size_t n = 1; n < points.size(); ++n) shape_.points_world.set(slot, n, points[n]);
  heights = lower;
}

/// Lowers the heights of columns, and of their neighbours until they do not step.
void WindowRepair::lower(const std::vector<bool>& columns) {
  std::vector<double> height;
  for (const std::vector<double>& levels : shape_.heights_world) height.push_back(levels.back());
  for (std::size_t s = 0; s < window_.free; ++s) {
    if (columns[s]) height[s] *= kLower;
  }
  const double ratio = std::max(kLeastGrading, layers_.spacing.growth);
  for (bool changed = true; changed;) {
    changed = false;
    for (const ColumnFace& face : window_.faces) {
      for (std::size_t c = 0; c < face.count; ++c) {
        const std::size_t a = at(face.column[c]);
        const std::size_t b = at(face.next(c));
        const double length =
            (shape_.points_world.get(a, 0) - shape_.points_world.get(b, 0)).norm();
        if (!(length > 0)) continue;
        const std::size_t low = height[a] < height[b] ? a : b;
        const std::size_t high = low == a ? b : a;
        const double most = std::min(ratio * height[low], height[low] + kSteepest * length);
        if (high >= window_.free || height[high] <= most * (1 + 1e-12)) continue;
        height[high] = most;
        changed = true;
      }
    }
  }
  for (std::size_t s = 0; s < window_.free; ++s) set_height(s, height[s]);
}

void WindowRepair::run(const Progress& progress) {
  for (rounds = 0;; ++rounds) {
    last = untangle(surface_, window_, shape_, progress);
    steps += last.steps;
    valid = take_care();
    if (valid || rounds == kRounds) break;
  }
}

void WindowRepair::write(MultiBlock& mesh) const {
  Layers& layers = mesh.layers;
  const auto levels = at(layers.levels());
  for (std::size_t s = 0; s < window_.free; ++s) {
    const std::size_t node = at(window_.nodes[s]);
    Vec3* const points = layers.points_world.data() + node * levels;
    for (std::size_t k = 1; k < levels; ++k) points[k] = shape_.points_world.get(s, k);
    layers.first_cell_world[node] = surface_.wall->closest_place(points[1]).distance_world;
    layers.height_world[node] = surface_.wall->closest_place(points[levels - 1]).distance_world;
  }
}

}  // namespace

void RepairOptions::validate() const {
  if (!(quality >= 0 && quality < 1)) {
    throw InputError(fmt::format("quality = {}, but must be in [0, 1)", quality));
  }
}

RepairReport repair(const Surface& surface, const RepairOptions& options, MultiBlock& mesh,
                    const Progress& progress) {
  RepairReport report;
  if (!options.on || std::getenv("VO_OFF")) return report;
  const ColumnGraph graph(mesh);
  std::vector<bool> marked = mark(graph, mesh, options.quality);
  widen(graph, kRings, marked);
  const std::vector<Window> windows = find_windows(graph, marked);
  report.windows = static_cast<int>(windows.size());
  std::vector<WindowRepair> repairs;
  for (const Window& window : windows) repairs.emplace_back(surface, mesh, window, options.quality);
  parallel::for_ranges({progress, "blocks"}, repairs.size(), 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t w = begin; w < end; ++w) {
      const auto start = std::chrono::steady_clock::now();
      repairs[w].run(progress);
    const double s = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    std::fprintf(stderr, "window: %zu free columns, %d rounds %d steps, %d inner, energy %.4f least %.3e valid %d, %.2f s, %.0f nodes/s\n",
                 windows[w].free, repairs[w].rounds, repairs[w].steps, repairs[w].last.inner_steps, repairs[w].last.energy, repairs[w].last.least, repairs[w].valid, s, double(windows[w].free * (at(mesh.layers.levels()) - 1)) / s);
    }
  });
  for (std::size_t w = 0; w < repairs.size(); ++w) {
    repairs[w].write(mesh);
    report.columns += static_cast<int>(windows[w].free);
    report.steps = std::max(report.steps, repairs[w].steps);
  }
  return report;
}

}  // namespace vdb_offset
