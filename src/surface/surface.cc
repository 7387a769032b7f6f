#include "vdb_offset/surface/surface.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <utility>

#include "surface/check_boundaries.h"
#include "surface/find_boundaries.h"
#include "surface/flat.h"
#include "surface/open_fans.h"
#include "surface/orient.h"
#include "surface/other_weld.h"
#include "surface/polygon_patch.h"
#include "surface/single_edges.h"
#include "surface/topology.h"
#include "surface/turn_loose.h"
#include "surface/weld.h"
#include "vdb_offset/core/error.h"
#include "vdb_offset/surface/winding.h"

namespace vdb_offset {

namespace {

/// Faces of points that there are.
void check_faces(const Patch& patch, int number) {
  const int points = static_cast<int>(patch.points_world.size());
  if (patch.ni != points || patch.nj != 0) {
    throw InputError(
        fmt::format("{} has faces and {} points, but is {} x {}; of polygons ni is the "
                    "number of points and nj is 0",
                    name_of(patch, number), points, patch.ni, patch.nj),
        {number});
  }
  for (std::size_t f = 0; f < patch.faces.size(); ++f) {
    for (const int corner : patch.faces[f]) {
      if (corner >= 0 && corner < points) continue;
      throw InputError(fmt::format("{}, face {}: has a corner at point {} of {}",
                                   name_of(patch, number), f + 1, corner, points),
                       {number, static_cast<std::int64_t>(f)});
    }
  }
}

void check_grid(const Patch& patch, int number, bool flat) {
  if (patch.ni < 2 || patch.nj < (flat ? 1 : 2)) {
    throw InputError(fmt::format("{} has {} x {} points, but a surface patch needs at least 2 x 2",
                                 name_of(patch, number), patch.ni, patch.nj),
                     {number});
  }
  const auto count = static_cast<std::size_t>(patch.ni) * static_cast<std::size_t>(patch.nj);
  if (patch.points_world.size() != count) {
    throw InputError(fmt::format("{} is {} x {} but holds {} points", name_of(patch, number),
                                 patch.ni, patch.nj, patch.points_world.size()),
                     {number});
  }
}

void check_patch(const Patch& patch, int number, bool flat) {
  patch.is_grid() ? check_grid(patch, number, flat) : check_faces(patch, number);
  for (std::size_t n = 0; n < patch.points_world.size(); ++n) {
    // Beyond 1e100 squares and cubes of lengths overflow.
    if ((patch.points_world[n].array().abs() < 1e100).all()) continue;
    const int i = static_cast<int>(n) % patch.ni;
    const int j = static_cast<int>(n) / patch.ni;
    throw InputError(
        fmt::format("{} is not a finite point below 1e100 in size", place(patch, number, i, j)),
        {number, i, j});
  }
}

void prepare(Patches& patches, double scale, bool flat) {
  if (patches.empty()) throw InputError("the surface has no patches");
  std::size_t points = 0;
  for (std::size_t p = 0; p < patches.size(); ++p) {
    if (scale != 1) {
      for (Vec3& x : patches[p].points_world) x *= scale;
    }
    check_patch(patches[p], static_cast<int>(p), flat);
    points += patches[p].points_world.size();
  }
  // Nodes, cell corners and triangles are counted in 32 bits.
  if (points > 250'000'000) {
    throw InputError(
        fmt::format("the surface has {} points; at most 250 million are supported", points));
  }
}

/// "the surface", with the files that it was read from.
std::string surface_name(const Patches& patches) {
  std::vector<std::string> files;
  for (const Patch& patch : patches) {
    if (!patch.file.empty() && std::ranges::count(files, patch.file) == 0) {
      files.push_back(patch.file);
    }
  }
  return files.empty() ? "the surface" : fmt::format("the surface of {}", fmt::join(files, ", "));
}

void measure_edges(Surface& surface) {
  std::vector<double> lengths;
  for (const Patch& patch : surface.patches) {
    for_edges(patch, [&](int a, int b) {
      lengths.push_back((patch.points_world[static_cast<std::size_t>(b)] -
                         patch.points_world[static_cast<std::size_t>(a)])
                            .norm());
    });
  }
  std::erase_if(lengths, [&](double length) {
    return length <= surface.report.weld_distance_max_world || length <= 0;
  });
  if (lengths.empty()) {
    throw InputError(surface_name(surface.patches) + " has no edge of non-zero length");
  }
  const auto middle = lengths.begin() + static_cast<std::ptrdiff_t>(lengths.size() / 2);
  std::nth_element(lengths.begin(), middle, lengths.end());
  surface.report.median_edge_world = *middle;
  surface.report.shortest_edge_world = *std::min_element(lengths.begin(), middle + 1);
}

void build_wall(Surface& surface) {
  Vec3List vertices = surface.nodes_world;
  std::vector<Wall::Triangle> triangles;
  for (std::size_t p = 0; p < surface.patches.size(); ++p) {
    const bool is_grid = surface.patches[p].is_grid();
    for_cells(surface.patches[p], [&](std::array<int, 4> corner) {
      for (int& c : corner) c = surface.patch_nodes[p][static_cast<std::size_t>(c)];
      if (!is_grid && corner[2] == corner[3]) {
        triangles.push_back({corner[0], corner[1], corner[2]});
        return;
      }
      const auto centre = static_cast<int>(vertices.size());
      Vec3 sum = Vec3::Zero();
      for (const int c : corner) sum += surface.nodes_world[static_cast<std::size_t>(c)];
      vertices.push_back(0.25 * sum);
      for (std::size_t s = 0; s < 4; ++s) {
        triangles.push_back({centre, corner[s], corner[(s + 1) % 4]});
      }
    });
  }
  auto wall = std::make_shared<const Wall>(std::move(vertices), std::move(triangles));
  if (!(wall->area() > 0)) throw InputError(surface_name(surface.patches) + " has no area");
  surface.wall = std::move(wall);
  surface.wall_nodes = static_cast<int>(surface.nodes_world.size());
}

/// A second copy of every patch and node, turned round: the blocks on the other side.
void add_other_side(Surface& surface, Orientation& orientation) {
  const std::size_t count = surface.patches.size();
  const auto nodes = static_cast<int>(surface.nodes_world.size());
  for (std::size_t p = 0; p < count; ++p) {
    surface.patches.push_back(surface.patches[p]);
    surface.patches.back().name += " (against)";
    surface.patch_nodes.push_back(surface.patch_nodes[p]);
    for (int& n : surface.patch_nodes.back()) n += nodes;
    flip({surface.patches, surface.patch_nodes}, count + p);
    orientation.component.push_back(orientation.component[p] + orientation.components);
  }
  orientation.components *= 2;
  const std::vector<BoundarySet> on = surface.node_boundaries;
  surface.node_boundaries.insert(surface.node_boundaries.end(), on.begin(), on.end());
  const Vec3List originals = surface.nodes_world;
  surface.nodes_world.insert(surface.nodes_world.end(), originals.begin(), originals.end());
}

/// Patch points become their nodes' points, so that every later stage sees one surface.
void snap(Surface& surface) {
  for (std::size_t p = 0; p < surface.patches.size(); ++p) {
    for (std::size_t n = 0; n < surface.patch_nodes[p].size(); ++n) {
      surface.patches[p].points_world[n] =
          surface.nodes_world[static_cast<std::size_t>(surface.patch_nodes[p][n])];
    }
  }
}

/// A point that was welded to another.
struct Moved {
  std::size_t patch, point;
  Vec3 from_world;
};

std::vector<Moved> moved_points(const Surface& surface) {
  std::vector<Moved> moved;
  if (!(surface.report.weld_distance_max_world > 0)) return moved;
  for (std::size_t p = 0; p < surface.patches.size(); ++p) {
    for (std::size_t n = 0; n < surface.patch_nodes[p].size(); ++n) {
      const Vec3& from = surface.patches[p].points_world[n];
      const auto node = static_cast<std::size_t>(surface.patch_nodes[p][n]);
      if (from != surface.nodes_world[node]) moved.push_back({p, n, from});
    }
  }
  return moved;
}

/// Points become nodes, and patches of polygons those of their nodes; those that moved.
std::vector<Moved> weld_patches(Surface& surface, double part, const Progress& progress) {
  Welding welding = weld(surface.patches, part, progress);
  surface.nodes_world = std::move(welding.nodes_world);
  surface.patch_nodes = std::move(welding.patch_nodes);
  surface.report.weld_distance_max_world = welding.moved_max_world;
  for (std::size_t p = 0; p < surface.patches.size(); ++p) {
    if (surface.patches[p].is_grid()) continue;
    settle_polygons(surface.patches[p], surface.patch_nodes[p]);
    if (surface.patches[p].faces.empty()) {
      throw InputError(fmt::format("{} has no face with three corners",
                                   name_of(surface.patches[p], static_cast<int>(p))),
                       {static_cast<std::int64_t>(p)});
    }
  }
  measure_edges(surface);
  std::vector<Moved> moved = moved_points(surface);
  snap(surface);
  return moved;
}

/// Tells what another tolerance would do where the surface is none.
Orientation orient_welded(Surface& surface, const std::vector<Moved>& moved, double weld) {
  try {
    return orient({surface.patches, surface.patch_nodes, surface.flat});
  } catch (const InputError& error) {
    for (const Moved& m : moved) surface.patches[m.patch].points_world[m.point] = m.from_world;
    throw InputError(error.what() + weld_advice(surface.patches, weld), error.indices());
  }
}

/// Faces as they are, for a field.
Surface build_soup(Patches patches, const SurfaceOptions& options, const Progress& progress) {
  Surface surface;
  if (is_flat(patches)) {
    throw InputError(name_of(patches.front(), 0) +
                     " is a curve: sides by winding numbers, or none, are for surfaces");
  }
  if (options.side == MarchSide::Against && options.sides == SideRule::Winding) {
    throw InputError("side = against: winding numbers tell in from out; take along or both");
  }
  if (!options.planes.empty() || !options.shapes.empty() || !options.internals.empty()) {
    throw InputError("boundaries are for surfaces whose normals tell their sides; leave them out");
  }
  prepare(patches, options.scale, false);
  surface.patches = std::move(patches);
  weld_patches(surface, options.weld, progress);
  build_wall(surface);
  surface.both_sides = options.side == MarchSide::Both || options.sides == SideRule::Unsigned;
  surface.topology.component.assign(surface.patches.size(), 0);
  surface.topology.components = 1;
  if (options.sides == SideRule::Winding) {
    surface.winding = std::make_shared<const Winding>(*surface.wall);
    surface.closed = true;
  }
  return surface;
}

/// Fans are blocks beside blocks.
void refuse_fans(const Patches& patches) {
  const auto found = std::ranges::find_if_not(patches, &Patch::is_grid);
  if (found == patches.end()) return;
  const auto number = found - patches.begin();
  throw InputError(fmt::format("{} is made of polygons, and fans open the edges of structured "
                               "patches alone; leave fans away",
                               name_of(*found, static_cast<int>(number))),
                   {number});
}

/// Finds the boundaries that free edges end on, and puts their nodes there.
void end_free_edges(Surface& surface, const SurfaceOptions& options) {
  const Topology topology = build_topology(surface.patches, surface.patch_nodes);
  Ends ends = find_boundaries(
      {{surface.patches, surface.patch_nodes}, surface.nodes_world, topology, surface.flat},
      options);
  surface.report.taper_edges = ends.taper_edges;
  surface.taper_nodes = std::move(ends.tapers);
  surface.report.open_tails = std::move(ends.open_tails);
  surface.report.missed = std::move(ends.missed);
  if (ends.boundaries.empty()) return;
  surface.report.boundary_distance_max_world = ends.moved_max_world;
  surface.boundaries = std::make_shared<const Boundaries>(std::move(ends.boundaries));
  surface.node_boundaries = std::move(ends.on);
  snap(surface);
}

}  // namespace

void SurfaceOptions::validate() const {
  if (!(scale > 0) || !std::isfinite(scale)) {
    throw InputError(fmt::format("scale = {}, but must be above 0 and finite", scale));
  }
  if (!(weld >= 0 && weld < 0.5)) {
    throw InputError(fmt::format("weld = {}, but must be in [0, 0.5)", weld));
  }
  if (fans < 0 || fans > 64) {
    throw InputError(fmt::format("fans = {}, but must be in [0, 64]", fans));
  }
}

int Surface::points() const {
  std::size_t sum = 0;
  for (const Patch& patch : patches) sum += patch.points_world.size();
  return static_cast<int>(sum);
}

int Surface::faces() const {
  int count = 0;
  for (std::size_t p = 0; p < patches.size(); ++p) {
    for_cells(patches[p], [&](std::array<int, 4> corner) {
      for (int& c : corner) c = patch_nodes[p][static_cast<std::size_t>(c)];
      std::sort(corner.begin(), corner.end());
      count += std::unique(corner.begin(), corner.end()) - corner.begin() >= 3 ? 1 : 0;
    });
  }
  return count;
}

int Surface::free_edges() const {
  const bool is_soup = topology.edges.empty() && (winding || !closed);  // without topology
  if (is_soup) return static_cast<int>(count_single_edges(patches, patch_nodes));
  int count = 0;
  for (const Edge& edge : topology.edges) {
    const bool is_plane =
        flat && edge.boundary >= 0 && edge.boundary < static_cast<int>(kFlatPlanes);
    if (edge.kind == EdgeKind::Free && !is_plane) count += edge.first.cells();
  }
  return count;
}

int Surface::free_edges_on(int boundary) const {
  int count = 0;
  for (const Edge& edge : topology.edges) {
    const bool on = edge.kind == EdgeKind::Free && edge.boundary == boundary;
    if (on) count += edge.first.cells();
  }
  return count;
}

Surface build_surface(Patches patches, const SurfaceOptions& given, const Progress& progress) {
  given.validate();
  if (given.sides != SideRule::Manifold) return build_soup(std::move(patches), given, progress);
  SurfaceOptions options = given;
  Surface surface;
  surface.flat = is_flat(patches);
  prepare(patches, options.scale, surface.flat);
  check_boundaries(patches, options, surface.flat);
  if (surface.flat) extrude(patches, options);
  surface.patches = std::move(patches);
  const std::vector<Moved> moved = weld_patches(surface, options.weld, progress);
  progress.check();

  const NodeGrids grids{surface.patches, surface.patch_nodes, surface.flat};
  Orientation orientation = orient_welded(surface, moved, options.weld);
  surface.report.turned_parts = turn_loose(grids, orientation);
  surface.report.flipped = orientation.flipped;
  if (options.side == MarchSide::Against) {
    for (std::size_t p = 0; p < surface.patches.size(); ++p) flip(grids, p);
  }
  end_free_edges(surface, options);
  progress.check();
  build_wall(surface);
  surface.both_sides = options.side == MarchSide::Both;
  if (surface.both_sides) add_other_side(surface, orientation);
  if (options.fans > 0) refuse_fans(surface.patches);
  if (options.fans > 0) open_fans(surface, options.fans, orientation.component);
  progress.check();

  surface.topology = build_topology(surface.patches, surface.patch_nodes, surface.node_boundaries);
  surface.topology.component = std::move(orientation.component);
  surface.topology.components = orientation.components;
  surface.closed = std::ranges::none_of(
      surface.topology.edges, [](const Edge& edge) { return edge.kind == EdgeKind::Free; });
  return surface;
}

}  // namespace vdb_offset
