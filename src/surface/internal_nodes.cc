#include "surface/internal_nodes.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <utility>

#include "surface/topology.h"
#include "vdb_offset/core/error.h"

namespace vdb_offset {

namespace {

constexpr double kAlong = 0.7;   // cosine between normals of what runs along each other
constexpr double kTouch = 1e-6;  // of a cell's shortest side: nothing fits between
constexpr double kInward = 0.5;  // of the way from an edge to the cell's centre

/// A cell of the wall.
struct WallCell {
  std::array<std::size_t, 4> node;
  std::array<Vec3, 4> x;
  Vec3 centre = Vec3::Zero();
  Vec3 normal = Vec3::Zero();
  double shortest = std::numeric_limits<double>::infinity();  // side

  WallCell(const OpenSurface& surface, std::size_t patch, const std::array<int, 4>& corners);
};

WallCell::WallCell(const OpenSurface& surface, std::size_t patch,
                   const std::array<int, 4>& corners) {
  const std::size_t count = corners[2] == corners[3] ? 3 : 4;
  for (std::size_t c = 0; c < 4; ++c) {
    const auto point = static_cast<std::size_t>(corners[c]);
    node[c] = static_cast<std::size_t>(surface.grids.nodes[patch][point]);
    x[c] = surface.nodes_world[node[c]];
    if (c < count) centre += x[c] / static_cast<double>(count);
  }
  normal = (x[2] - x[0]).cross(x[3] - x[1]).normalized();
  for (std::size_t c = 0; c < 4; ++c) {
    const double side = (x[(c + 1) % 4] - x[c]).norm();
    if (side > 0) shortest = std::min(shortest, side);
  }
}

bool is_near(const Wall& shape, const WallCell& cell, const Vec3& place) {
  return shape.closest_place(place, kOnShape * cell.shortest).triangle >= 0;
}

/// Whether the shape lies on a cell that it is near to: above all of it, or below, it only runs
/// along the wall.
bool lies_on(const Wall& shape, const WallCell& cell) {
  double lowest = std::numeric_limits<double>::infinity();
  double highest = -lowest;
  for (const Vec3& place : {cell.x[0], cell.x[1], cell.x[2], cell.x[3], cell.centre}) {
    const WallPoint foot = shape.closest(place);
    if (std::abs(foot.normal.dot(cell.normal)) < kAlong) return false;
    const double height = (foot.point_world - place).dot(cell.normal);
    lowest = std::min(lowest, height);
    highest = std::max(highest, height);
  }
  const double touch = kTouch * cell.shortest;
  return lowest <= touch && highest >= -touch;
}

/// "patch 2 'tip', at (0, 1, 2)": a cell's middle.
std::string cell_place(const OpenSurface& surface, std::size_t patch, const WallCell& cell) {
  const Vec3& p = cell.centre;
  const std::string name = name_of(surface.grids.patches[patch], static_cast<int>(patch));
  return surface.is_flat ? fmt::format("{}, at ({:g}, {:g})", name, p.x(), p.y())
                         : fmt::format("{}, at ({:g}, {:g}, {:g})", name, p.x(), p.y(), p.z());
}

/// How an edge between two nodes lies to the surface.
struct EdgeFit {
  bool is_on = false;
  bool is_along = false;  // the surface goes on over a cell beside it
};

class InternalNodes {
 public:
  InternalNodes(const OpenSurface& surface, const InternalShape& internal)
      : surface_(surface), internal_(internal) {}

  void look_at(std::size_t patch, const std::array<int, 4>& corners);
  void mark(Ends& ends) const;

 private:
  bool is_near(const WallCell& cell, const Vec3& place) const {
    return vdb_offset::is_near(internal_.shape, cell, place);
  }

  const OpenSurface& surface_;
  const InternalShape& internal_;
  std::map<std::pair<std::size_t, std::size_t>, EdgeFit> edges_;
};

void InternalNodes::look_at(std::size_t patch, const std::array<int, 4>& corners) {
  const WallCell cell(surface_, patch, corners);
  std::array<bool, 4> near{};
  for (std::size_t c = 0; c < 4; ++c) near[c] = is_near(cell, cell.x[c]);
  for (std::size_t c = 0; c < 4; ++c) {
    const std::size_t next = (c + 1) % 4;
    if (!near[c] || !near[next] || cell.node[c] == cell.node[next]) continue;
    EdgeFit& fit = edges_[std::minmax(cell.node[c], cell.node[next])];
    fit.is_on = true;
    const Vec3 middle = 0.5 * (cell.x[c] + cell.x[next]);
    fit.is_along = fit.is_along || is_near(cell, middle + kInward * (cell.centre - middle));
  }
  const bool is_over = near[0] && near[1] && near[2] && near[3] && is_near(cell, cell.centre);
  if (!is_over || !lies_on(internal_.shape, cell)) return;
  throw InputError(fmt::format(
      "the internal surface '{}' lies on the wall, {}: no cell fits between; leave out of it what "
      "is the wall's, or move it off the wall",
      internal_.name, cell_place(surface_, patch, cell)));
}

void InternalNodes::mark(Ends& ends) const {
  const BoundarySet bit = BoundarySet{1} << static_cast<unsigned>(internal_.boundary);
  for (const auto& [nodes, fit] : edges_) {
    if (!fit.is_on || fit.is_along) continue;
    ends.on[nodes.first] |= bit;
    ends.on[nodes.second] |= bit;
  }
}

}  // namespace

void mark_internal_nodes(const OpenSurface& surface, const InternalShape& internal, Ends& ends) {
  InternalNodes found(surface, internal);
  for (std::size_t p = 0; p < surface.grids.patches.size(); ++p) {
    for_cells(surface.grids.patches[p],
              [&](const std::array<int, 4>& corners) { found.look_at(p, corners); });
  }
  found.mark(ends);
}

void refuse_on_wall(const OpenSurface& surface, const std::string& name, const Wall& shape) {
  for (std::size_t p = 0; p < surface.grids.patches.size(); ++p) {
    for_cells(surface.grids.patches[p], [&](const std::array<int, 4>& corners) {
      const WallCell cell(surface, p, corners);
      const auto is_near_here = [&](const Vec3& x) { return is_near(shape, cell, x); };
      if (!std::ranges::all_of(cell.x, is_near_here) || !is_near_here(cell.centre)) return;
      if (!lies_on(shape, cell)) return;
      throw InputError(fmt::format(
          "the boundary '{}' lies on the wall, {}: it is what the wall ends on, at an angle; leave "
          "out of it what is the wall's",
          name, cell_place(surface, p, cell)));
    });
  }
}

}  // namespace vdb_offset
