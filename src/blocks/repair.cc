#include "vdb_offset/blocks/repair.h"

#include <Eigen/Geometry>
#include <chrono>
#include <cstdio>
#include <cstdlib>

#include "blocks/untangle.h"
#include "blocks/window.h"
#include "vdb_offset/blocks/quality.h"
#include "vdb_offset/core/error.h"

namespace vdb_offset {
namespace {

std::size_t at(int index) { return static_cast<std::size_t>(index); }

/// Columns of cells that are not positive, or worse than asked.
std::vector<bool> bad_columns(const MultiBlock& mesh, double quality) {
  std::vector<bool> bad(at(mesh.nodes()), false);
  for (const Block& block : mesh.blocks) {
    for (int k = 0; k + 1 < block.nk; ++k)
      for (int j = 0; j + 1 < block.nj; ++j)
        for (int i = 0; i + 1 < block.ni; ++i) {
          const std::array<Vec3, 8> corners{
              mesh.point(block, i, j, k),         mesh.point(block, i + 1, j, k),
              mesh.point(block, i + 1, j + 1, k), mesh.point(block, i, j + 1, k),
              mesh.point(block, i, j, k + 1),     mesh.point(block, i + 1, j, k + 1),
              mesh.point(block, i + 1, j + 1, k + 1), mesh.point(block, i, j + 1, k + 1)};
          const CellQuality q = cell_quality(corners);
          if (q.positive && q.scaled_jacobian >= quality) continue;
          bad[at(block.column(i, j))] = bad[at(block.column(i + 1, j))] = true;
          bad[at(block.column(i, j + 1))] = bad[at(block.column(i + 1, j + 1))] = true;
        }
  }
  return bad;
}

void mark_collapsed(const ColumnGraph& graph, const MultiBlock& mesh, double least, std::vector<bool>& bad) {
  for (const ColumnFace& face : graph.faces) {
    for (std::size_t c = 0; c < face.count; ++c) {
      const int own = face.column[c], next = face.next(c), prev = face.previous(c);
      const auto frame = [&](int k) {
        const Vec3 a = mesh.layers.at(next, k) - mesh.layers.at(own, k);
        const Vec3 b = mesh.layers.at(prev, k) - mesh.layers.at(own, k);
        return Vec3(a.cross(b));
      };
      const double area = frame(0).norm();
      const std::vector<double> heights = mesh.layers.heights(at(own));
      for (int k = 0; k + 1 < mesh.layers.levels(); ++k) {
        const Vec3 e3 = mesh.layers.at(own, k + 1) - mesh.layers.at(own, k);
        const double ideal = area * (heights[at(k + 1)] - heights[at(k)]);
        const double d = std::min(frame(k).dot(e3), frame(k + 1).dot(e3));
        if (d >= least * ideal) continue;
        bad[at(own)] = bad[at(next)] = bad[at(prev)] = true;
        break;
      }
    }
  }
}

WindowShape shape_of(const MultiBlock& mesh, const Window& window) {
  WindowShape shape;
  const auto levels = at(mesh.layers.levels());
  shape.points_world = ColumnVector(window.nodes.size(), levels);
  for (std::size_t s = 0; s < window.nodes.size(); ++s) {
    for (std::size_t k = 0; k < levels; ++k) {
      shape.points_world.set(s, k, mesh.layers.at(window.nodes[s], static_cast<int>(k)));
    }
    shape.heights_world.push_back(mesh.layers.heights(at(window.nodes[s])));
    shape.surface_node.push_back(window.nodes[s]);
  }
  return shape;
}

}  // namespace

RepairReport repair(const Surface& surface, const RepairOptions& options, MultiBlock& mesh,
                    const Progress& progress) {
  RepairReport report;
  if (!options.on || std::getenv("VO_OFF")) return report;
  const ColumnGraph graph(mesh);
  std::vector<bool> marked = bad_columns(mesh, options.quality);
  mark_collapsed(graph, mesh, 0.05, marked);
  int bad = 0;
  for (bool b : marked) bad += b;
  const char* rings = std::getenv("VO_RINGS");
  widen(graph, rings ? std::atoi(rings) : 6, marked);
  const std::vector<Window> windows = find_windows(graph, marked);
  report.windows = static_cast<int>(windows.size());
  for (const Window& window : windows) {
    WindowShape shape = shape_of(mesh, window);
    const auto start = std::chrono::steady_clock::now();
    const UntangleReport part = untangle(surface, window, shape, progress);
    const double s = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    const auto levels = at(mesh.layers.levels());
    std::fprintf(stderr, "window: %zu free columns, %d steps, %d inner, energy %.4f least %.3e settled %d, %.2f s, %.0f nodes/s\n",
                 window.free, part.steps, part.inner_steps, part.energy, part.least, part.settled, s, double(window.free * (levels - 1)) / s);
    for (std::size_t c = 0; c < window.free; ++c) {
      for (std::size_t k = 1; k < levels; ++k) {
        mesh.layers.points_world[at(window.nodes[c]) * levels + k] = shape.points_world.get(c, k);
      }
      const auto n = at(window.nodes[c]);
      mesh.layers.first_cell_world[n] = surface.wall->closest(mesh.layers.points_world[n * levels + 1]).distance_world;
      mesh.layers.height_world[n] = surface.wall->closest(mesh.layers.points_world[n * levels + levels - 1]).distance_world;
    }
    report.columns += static_cast<int>(window.free);
    report.steps = std::max(report.steps, part.steps);
  }
  std::fprintf(stderr, "repair: %d bad columns\n", bad);
  return report;
}

}  // namespace vdb_offset
