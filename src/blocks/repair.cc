// Section 4.5 of Wang, Guibault, Camarero leaves collapsed elements to elliptic smoothing, which
// promises nothing; windows round them are made anew here instead (see untangle.cc).

#include "vdb_offset/blocks/repair.h"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <utility>

#include "blocks/face_state.h"
#include "blocks/keep_faces.h"
#include "blocks/lower_inverted.h"
#include "blocks/outer_faces.h"
#include "blocks/part_crossed.h"
#include "blocks/window.h"
#include "blocks/window_repair.h"
#include "core/machine.h"
#include "core/parallel.h"
#include "vdb_offset/core/error.h"
#include "vdb_offset/core/units.h"

namespace vdb_offset {
namespace {

/// Rings of faces around bad ones that move with them: as wide as the layers are high, and a
/// little, so that columns need not lean far.
constexpr int kFewestRings = 6;
constexpr int kMostRings = 48;
/// Columns that moved may have to be lowered, which may invert cells, which move in the next round.
constexpr int kRounds = 4;
constexpr double kRingsOfDistance = 1.2;
constexpr double kCollapsed = 0.05;  // spread below which columns have merged
/// Cells above it are positive: six tetrahedra are not inverted between corners as good as this.
constexpr double kSurelyPositive = 0.3;
constexpr std::size_t kGrain = 64;  // faces

std::size_t at(int index) { return static_cast<std::size_t>(index); }

/// Least scaled Jacobian over each face of the graph.
std::vector<float> worst_cells(const ColumnGraph& graph, const MultiBlock& mesh,
                               const QualityField& quality) {
  std::vector<float> worst(graph.faces.size(), std::numeric_limits<float>::infinity());
  for (std::size_t b = 0; b < mesh.blocks.size(); ++b) {
    const Block& block = mesh.blocks[b];
    const std::vector<float>& values = quality.scaled_jacobian[b];
    const std::size_t stacks = at(block.stacks_i()) * at(block.stacks_j());
    for (std::size_t cell = 0; cell < values.size(); ++cell) {
      const int face = graph.face_of[b][cell % stacks];
      if (face >= 0) worst[at(face)] = std::min(worst[at(face)], values[cell]);
    }
  }
  return worst;
}

/// What the cells over each face are to have, as the wall and the columns that leave it are now.
std::vector<float> wanted_qualities(const ColumnGraph& graph, const MultiBlock& mesh,
                                    double quality) {
  const auto point = [&](int column, std::size_t level) -> const Vec3& {
    return mesh.layers.at(column, static_cast<int>(level));
  };
  std::vector<float> wanted(graph.faces.size());
  parallel::for_ranges(wanted.size(), kGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t f = begin; f < end; ++f) {
      wanted[f] = static_cast<float>(wanted_quality(graph.faces[f], quality, point));
    }
  });
  return wanted;
}

/// Which faces need repair: those with inverted cells alone, or those worse than wanted too.
enum class Marks { Inverted, Poor };

/// Columns of faces that need repair.
std::vector<bool> mark(const ColumnGraph& graph, const MultiBlock& mesh, Marks marks,
                       const std::vector<float>& worst, const std::vector<float>& wanted) {
  const auto levels = at(mesh.layers.levels());
  const auto point = [&](int column, std::size_t level) -> const Vec3& {
    return mesh.layers.at(column, static_cast<int>(level));
  };
  const auto is_inverted = [&](std::size_t f) {
    return static_cast<double>(worst[f]) < kSurelyPositive &&
           !judge_face(graph.faces[f], levels - 1, point).positive;
  };
  const auto is_poor = [&](std::size_t f) {
    for (std::size_t part = 1; part <= 4; ++part) {
      const std::size_t level = std::max<std::size_t>(1, (levels - 1) * part / 4);
      if (spread(graph.faces[f], level, point) < kCollapsed) return true;
    }
    return worst[f] < wanted[f];
  };
  std::vector<char> bad(graph.faces.size(), 0);
  parallel::for_ranges(graph.faces.size(), kGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t f = begin; f < end; ++f) {
      bad[f] = (marks == Marks::Poor && is_poor(f)) || is_inverted(f) ? 1 : 0;
    }
  });
  std::vector<bool> marked(at(mesh.nodes()), false);
  for (std::size_t f = 0; f < bad.size(); ++f) {
    const ColumnFace& face = graph.faces[f];
    for (std::size_t c = 0; bad[f] != 0 && c < face.count; ++c) marked[at(face.column[c])] = true;
  }
  return marked;
}

/// In two dimensions: columns of the far plane are those of the near one, moved.
void copy_across(const Surface& surface, MultiBlock& mesh) {
  const auto levels = at(mesh.layers.levels());
  for (const Block& block : mesh.blocks) {
    for (int i = 0; i < block.ni; ++i) {
      const std::size_t from = at(block.column(i, 0));
      const std::size_t to = at(block.column(i, 1));
      const Vec3 shift = surface.nodes_world[to] - surface.nodes_world[from];
      for (std::size_t k = 1; k < levels; ++k) {
        mesh.layers.points_world[to * levels + k] =
            mesh.layers.points_world[from * levels + k] + shift;
      }
      mesh.layers.stop[to] = mesh.layers.stop[from];
      if (!mesh.layers.ends_on.empty()) mesh.layers.ends_on[to] = mesh.layers.ends_on[from];
      mesh.layers.height_world[to] = mesh.layers.height_world[from];
      mesh.layers.first_cell_world[to] = mesh.layers.first_cell_world[from];
    }
  }
}

void check_memory(const std::vector<Window>& windows, int levels, std::uint64_t limit_bytes) {
  constexpr double kPointBytes = 1400;
  double points = 0;
  for (const Window& window : windows) {
    points += static_cast<double>(window.nodes.size()) * static_cast<double>(levels);
  }
  const double limit = limit_bytes > 0 ? static_cast<double>(limit_bytes)
                                       : 0.75 * static_cast<double>(free_memory_bytes());
  if (points * kPointBytes <= limit) return;
  throw LimitError(fmt::format(
      "the repair of {:.0f} points in {} windows takes about {}, but the limit is {}: allow more "
      "memory, ask for fewer layers or a smaller distance, or leave blocks as marched "
      "(repair off)",
      points, windows.size(), format_bytes(points * kPointBytes), format_bytes(limit)));
}

int rings(const Surface& surface, const Layers& layers) {
  const double edge = surface.report.median_edge_world;
  const double wanted = edge > 0 ? kRingsOfDistance * layers.distance_world / edge : 0;
  return static_cast<int>(std::clamp<double>(wanted, kFewestRings, kMostRings));
}

RepairReport repair_windows(const Surface& surface, const std::vector<Window>& windows,
                            const RepairOptions& options, MultiBlock& mesh,
                            const Progress& progress) {
  std::vector<WindowRepair> repairs;
  const WindowGoal goal{options.quality, part_of_room(mesh.layers)};
  for (const Window& window : windows) repairs.emplace_back(surface, mesh, window, goal);
  parallel::for_ranges({progress, "repair"}, repairs.size(), 1,
                       [&](std::size_t begin, std::size_t end) {
                         for (std::size_t w = begin; w < end; ++w) repairs[w].run(progress);
                       });
  RepairReport report;
  for (std::size_t w = 0; w < repairs.size(); ++w) {
    report.beyond = std::max(report.beyond, repairs[w].write(mesh));
    report.steps = std::max(report.steps, repairs[w].steps());
    report.unmended += repairs[w].is_positive() ? 0 : 1;
  }
  return report;
}

/// Lowers columns that moved where their layers meet those over other faces. Returns how many.
int lower_crossed(const Surface& surface, const ColumnGraph& graph, MultiBlock& mesh) {
  int lowered = keep_faces_apart(surface, graph, mesh);
  lowered += part_crossed(surface, graph, mesh);
  return lowered == 0 ? 0 : lowered + lower_inverted(surface, graph, mesh);
}

/// What another round did.
void add(const RepairReport& round, RepairReport& all) {
  all.beyond = std::max(all.beyond, round.beyond);
  all.steps = std::max(all.steps, round.steps);
  all.unmended = round.unmended;
}

/// Columns that were in a window of any round, or are lower than they were marched.
void count_columns(const ColumnGraph& graph, const std::vector<double>& marched_world,
                   const std::vector<double>& height_world, std::vector<bool> moved,
                   RepairReport& report) {
  constexpr double kLower = 1 - 1e-3;
  for (std::size_t n = 0; n < moved.size(); ++n) {
    if (height_world[n] != marched_world[n]) moved[n] = true;
    report.columns += moved[n] ? 1 : 0;
    report.lowered += height_world[n] < kLower * marched_world[n] ? 1 : 0;
  }
  report.windows = static_cast<int>(find_windows(graph, moved).size());
}

}  // namespace

void RepairOptions::validate() const {
  if (!(quality >= 0 && quality < 1)) {
    throw InputError(fmt::format("quality = {}, but must be in [0, 1)", quality));
  }
}

RepairResult repair(const Surface& surface, MultiBlock& mesh, const RepairOptions& options,
                    const Progress& progress) {
  options.validate();
  RepairResult result;
  result.quality = judge(mesh, progress);
  if (!options.on) return result;
  const ColumnGraph graph(mesh);
  const std::vector<float> wanted = wanted_qualities(graph, mesh, options.quality);
  const std::vector<double> marched = mesh.layers.height_world;
  std::vector<bool> moved(marched.size(), false);
  for (int round = 0; round <= kRounds; ++round) {  // the last one lowers nothing
    std::vector<bool> marked = mark(graph, mesh, round == 0 ? Marks::Poor : Marks::Inverted,
                                    worst_cells(graph, mesh, result.quality), wanted);
    widen(graph, rings(surface, mesh.layers), marked);
    const std::vector<Window> windows = find_windows(graph, marked);
    if (windows.empty()) break;
    check_memory(windows, mesh.layers.levels(), options.memory_bytes);
    for (const Window& window : windows) {
      for (std::size_t s = 0; s < window.free; ++s) moved[at(window.nodes[s])] = true;
    }
    add(repair_windows(surface, windows, options, mesh, progress), result.report);
    if (surface.flat) copy_across(surface, mesh);
    const int lowered = round < kRounds ? lower_crossed(surface, graph, mesh) : 0;
    if (surface.flat && lowered > 0) copy_across(surface, mesh);
    if (surface.boundaries && surface.boundaries->has_internal()) part_outer_levels(surface, mesh);
    result.quality = judge(mesh, progress);
    if (lowered == 0) break;
  }
  count_columns(graph, marched, mesh.layers.height_world, std::move(moved), result.report);
  const std::vector<float> worst = worst_cells(graph, mesh, result.quality);
  for (std::size_t f = 0; f < worst.size(); ++f) {
    result.report.fall_short += worst[f] < wanted[f] ? 1 : 0;
  }
  return result;
}

}  // namespace vdb_offset
