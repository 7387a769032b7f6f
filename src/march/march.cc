// Section 4.4 of Wang, Guibault, Camarero, Automatic near-body domain decomposition using the
// eikonal equation. Layers are read off the traced columns at true distances from the wall.

#include "vdb_offset/march/march.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

#include "core/grading.h"
#include "core/large_vector.h"
#include "core/parallel.h"
#include "march/column.h"
#include "march/height_profile.h"
#include "march/lean.h"
#include "march/node_directions.h"
#include "march/room.h"
#include "march/taper.h"
#include "vdb_offset/core/error.h"
#include "vdb_offset/core/units.h"
#include "vdb_offset/march/face_room.h"

namespace vdb_offset {

namespace {

constexpr Grading kOfFirstCells{.ratio = 1.2};
constexpr double kHair = 1e-12;       // of the height asked for: the least that a column has
constexpr double kSameHeight = 1e-5;  // of a height: columns are cut that nearly
constexpr int kMostLowerings = 4;

std::size_t at(int index) { return static_cast<std::size_t>(index); }

/// Everything one thread needs to march one node after the other.
struct Marcher {
  const Surface& surface;
  const NodeDirections& directions;
  const Vec3List& lean;  // of each node, or empty
  double gap_margin;
  ColumnTracer tracer;
  ColumnPath path = {};
  HeightProfile profile = {};
  Vec3List edges = {};  // at the node

  bool is_blind(std::size_t node) const;
  ColumnStart start(std::size_t node);
  void explore(std::size_t node, Layers& layers);
  void shorten(std::size_t node, Layers& layers);
  void place(std::size_t node, const ColumnEnd& end, Layers& layers);
};

ColumnStart Marcher::start(std::size_t node) {
  const std::size_t there = surface.stands_at(node);
  const std::size_t wall_node = there % at(surface.wall_nodes);
  const double side = there == wall_node ? 1.0 : -1.0;
  const bool in_fan = surface.fans.leads(node);
  const Vec3 out =
      in_fan ? surface.fans.direction[node] : Vec3(side * directions.direction[wall_node]);
  const Vec3 leans =
      lean.empty() ? Vec3(Vec3::Zero()) : Vec3(lean[node] - lean[node].dot(out) * out);
  edges.clear();
  directions.for_edges(*surface.wall, wall_node, [&](const Vec3& edge) { edges.push_back(edge); });
  return {surface.nodes_world[node],
          out,
          directions.spacing_world[wall_node],
          side,
          directions.triangles(wall_node),
          edges,
          surface.boundaries_of(node),
          in_fan,
          leans};
}

/// Whether cells would be inverted however low they were: then the column has no height at all, and
/// they are what is left of them.
bool Marcher::is_blind(std::size_t node) const {
  const std::size_t wall_node = surface.stands_at(node) % at(surface.wall_nodes);
  return !surface.fans.leads(node) && directions.blind[wall_node];
}

/// How far the column can go; its levels, if that is all of what is asked.
void Marcher::explore(std::size_t node, Layers& layers) {
  const double asked = layers.asked_world[node];
  if (is_blind(node)) {
    layers.stop[node] = Stop::Collided;
    layers.room_world[node] = layers.height_world[node] = 0;
    return;
  }
  ColumnEnd end = tracer.trace(start(node), asked, path);
  layers.stop[node] = end.stop;
  layers.room_world[node] = end.height_world;
  layers.height_world[node] = end.height_world;
  if (end.stop == Stop::Reached) {
    // What the margin has to be kept from may lie beyond the end.
    const bool is_near = (1 - gap_margin) * end.meets_world < asked;
    if (!(end.meets_world > 0 && is_near)) return place(node, end, layers);
    layers.stop[node] = Stop::Collided;
    layers.room_world[node] = end.meets_world;
  }
  if (layers.stop[node] == Stop::Collided) {
    layers.height_world[node] = std::min(asked, (1 - gap_margin) * layers.room_world[node]);
  }
  // A column that cannot leave the wall still gets levels, in order, a hair apart.
  layers.height_world[node] = std::max(layers.height_world[node], kHair * asked);
}

/// Copies of columns on the near plane of a flat surface to the far one.
void copy_across(const Surface& surface, Layers& layers) {
  const auto levels = at(layers.levels());
  for (std::size_t p = 0; p < surface.patches.size(); ++p) {
    for (int i = 0; i < surface.patches[p].ni; ++i) {
      const std::size_t from = at(surface.node(static_cast<int>(p), i, 0));
      const std::size_t to = at(surface.node(static_cast<int>(p), i, 1));
      const Vec3 shift = surface.nodes_world[to] - surface.nodes_world[from];
      for (std::size_t k = 0; k < levels; ++k) {
        layers.points_world[to * levels + k] = layers.points_world[from * levels + k] + shift;
      }
      layers.stop[to] = layers.stop[from];
      layers.ends_on[to] = layers.ends_on[from];
      for (auto* field : {&layers.height_world, &layers.room_world, &layers.first_cell_world}) {
        (*field)[to] = (*field)[from];
      }
    }
  }
}

/// The levels of a column that goes less far than it could.
void Marcher::shorten(std::size_t node, Layers& layers) {
  const double asked = layers.asked_world[node];
  const double height = layers.height_world[node];
  if (height == 0) {
    const auto levels = at(layers.levels());
    std::fill_n(layers.points_world.data() + node * levels, levels, surface.nodes_world[node]);
    layers.first_cell_world[node] = 0;
    return;
  }
  const ColumnEnd whole = tracer.trace(start(node), asked, path);
  place(node, height < whole.height_world ? tracer.cut(path, whole, height) : whole, layers);
}

void Marcher::place(std::size_t node, const ColumnEnd& end, Layers& layers) {
  layers.height_world[node] = end.height_world;
  layers.ends_on[node] = end.internal;
  if (!end.is_straight) profile.build(tracer, path, end);
  const std::vector<double> heights = layers.heights(node);
  const std::size_t levels = heights.size();
  Vec3* points = layers.points_world.data() + node * levels;
  points[0] = surface.nodes_world[node];
  if (end.is_straight) {
    for (std::size_t k = 1; k < levels; ++k) points[k] = tracer.straight_point(path, heights[k]);
    layers.first_cell_world[node] = heights[1];
    return;
  }
  double s = 0;
  for (std::size_t k = 1; k + 1 < levels; ++k) {
    s = profile.length_at(heights[k], s);
    points[k] = tracer.point(path, s);
  }
  points[levels - 1] = tracer.point(path, end.s_world);
  if (end.internal >= 0) {
    points[levels - 1] = surface.boundaries->list()[at(end.internal)].project(points[levels - 1]);
  }
  const double reach = 1.001 * (points[1] - points[0]).norm();
  layers.first_cell_world[node] = surface.wall->closest(points[1], reach).distance_world;
}

/// All nodes at one place of a fan want the least that one of them does.
void ask_alike(const Surface& surface, Layers& layers) {
  for (auto* asked : {&layers.asked_world, &layers.first_asked_world}) {
    for (std::size_t n = 0; n < asked->size(); ++n) {
      double& least = (*asked)[surface.stands_at(n)];
      least = std::min(least, (*asked)[n]);
    }
    for (std::size_t n = 0; n < asked->size(); ++n) (*asked)[n] = (*asked)[surface.stands_at(n)];
  }
}

/// What each node is asked for: the least of its patches, with first cells that do not step.
void ask(const Surface& surface, const MarchOptions& options, Layers& layers) {
  const std::size_t nodes = surface.nodes_world.size();
  layers.asked_world.assign(nodes, layers.distance_world);
  layers.first_asked_world.assign(nodes, layers.spacing.first_cell_world);
  if (options.families.empty()) return;
  check_names(options.families, surface.patches);
  constexpr double kNone = std::numeric_limits<double>::infinity();
  layers.asked_world.assign(nodes, kNone);
  layers.first_asked_world.assign(nodes, kNone);
  for (std::size_t p = 0; p < surface.patches.size(); ++p) {
    double distance = layers.distance_world;
    double first = layers.spacing.first_cell_world;
    for (const FamilyLayers& family : options.families) {
      if (!family.is_of(surface.patches[p])) continue;
      distance = family.distance_world.value_or(distance);
      first = family.first_cell_world.value_or(first);
    }
    for (const int n : surface.patch_nodes[p]) {
      layers.asked_world[at(n)] = std::min(layers.asked_world[at(n)], distance);
      layers.first_asked_world[at(n)] = std::min(layers.first_asked_world[at(n)], first);
    }
  }
  ask_alike(surface, layers);
  grade(links_of(surface), kOfFirstCells, layers.first_asked_world);
}

/// Heights that do not step, from those that are free.
std::vector<std::size_t> limit(const Surface& surface, bool graded, Layers& layers) {
  const std::vector<double> free = layers.height_world;
  Grading grading = kOfHeights;
  grading.ratio = std::max(grading.ratio, layers.spacing.growth);
  if (graded) grade(links_of(surface), grading, layers.height_world);
  if (graded) taper(surface, layers);
  std::vector<std::size_t> left;
  for (std::size_t n = 0; n < free.size(); ++n) {
    const bool lowered = layers.height_world[n] < free[n] * (1 - 1e-12);
    const bool was_whole = layers.stop[n] == Stop::Reached || layers.stop[n] == Stop::Internal;
    if (lowered && was_whole) layers.stop[n] = Stop::Limited;
    if (!lowered) layers.height_world[n] = free[n];
    if (layers.stop[n] != Stop::Reached && !surface.is_copy(n)) left.push_back(n);
  }
  return left;
}

/// What columns could be, before they were limited by neighbours.
struct Free {
  std::vector<double> height_world;
  std::vector<Stop> stop;
};

/// Limits columns anew, where faces allow them no more than `room`; returns those that are lower
/// than they were.
std::vector<std::size_t> lower(const Surface& surface, const MarchOptions& options,
                               const std::vector<double>& room, Free& free, Layers& layers) {
  const Free was{layers.height_world, layers.stop};
  for (std::size_t n = 0; n < room.size(); ++n) {
    if (!(room[n] < free.height_world[n])) continue;
    free.height_world[n] = room[n];
    free.stop[n] = Stop::Collided;
    const double whole = room[n] / (1 - options.gap_margin);
    layers.room_world[n] = std::min(layers.room_world[n], whole);
  }
  layers.height_world = free.height_world;
  layers.stop = free.stop;
  std::vector<std::size_t> left = limit(surface, options.graded, layers);
  std::erase_if(left, [&](std::size_t n) {
    return !(layers.height_world[n] < was.height_world[n] * (1 - kSameHeight));
  });
  std::vector<char> is_left(room.size(), 0);
  for (const std::size_t n : left) is_left[n] = 1;
  for (std::size_t n = 0; n < room.size(); ++n) {
    if (is_left[n] != 0 || surface.is_copy(n)) continue;
    layers.height_world[n] = was.height_world[n];
    layers.stop[n] = was.stop[n];
  }
  return left;
}

/// Columns without content.
Layers blank(const LayerSpacing& spacing, std::size_t nodes) {
  Layers layers;
  layers.spacing = spacing;
  layers.distance_world = spacing.height_world;
  const std::size_t points = nodes * spacing.heights_world.size();
  layers.points_world.reserve(points);
  advise_large_pages(layers.points_world.data(), points * sizeof(Vec3));
  layers.points_world.resize(points);
  layers.stop.resize(nodes);
  layers.ends_on.assign(nodes, -1);
  layers.height_world.resize(nodes);
  layers.room_world.resize(nodes);
  layers.first_cell_world.resize(nodes);
  return layers;
}

MarchReport summarise(const Surface& surface, const Layers& layers) {
  MarchReport report;
  report.nodes = static_cast<int>(surface.nodes());
  for (std::size_t n = 0; n < layers.stop.size(); ++n) {
    if (surface.is_copy(n)) continue;
    if (layers.stop[n] == Stop::Collided) ++report.collided;
    if (layers.stop[n] == Stop::LeftBand) ++report.left_band;
    if (layers.stop[n] == Stop::Limited) ++report.limited;
    if (layers.stop[n] == Stop::Internal) ++report.internal;
    if (layers.stop[n] != Stop::Reached) continue;
    ++report.reached;
    const double error = std::abs(layers.height_world[n] / layers.asked_world[n] - 1);
    report.distance_error_max = std::max(report.distance_error_max, error);
  }
  return report;
}

}  // namespace

std::vector<double> Layers::heights(std::size_t node) const {
  const double asked = asked_world[node];
  if (height_world[node] == 0) return std::vector<double>(static_cast<std::size_t>(levels()), 0.0);
  const double height = std::clamp(height_world[node], kHair * asked, asked);
  if (stop[node] == Stop::Reached && asked == spacing.height_world &&
      first_asked_world[node] == spacing.first_cell_world) {
    return spacing.heights_world;
  }
  return rescale(spacing, height, first_asked_world[node]);
}

void FamilyLayers::validate() const {
  const auto check = [&](const char* what, const std::optional<double>& value) {
    if (!value || (*value > 0 && *value < 1e100)) return;
    throw InputError(fmt::format("family '{}': {} = {}, but must be above 0 and below 1e100", name,
                                 what, *value));
  };
  check("distance", distance_world);
  check("first-cell", first_cell_world);
  if (off && (distance_world || first_cell_world)) {
    throw InputError(
        fmt::format("family '{}': layers=off leaves nothing for a distance or a first cell", name));
  }
}

void check_names(const std::vector<FamilyLayers>& families, const Patches& patches) {
  for (const FamilyLayers& family : families) {
    const auto is_of = [&](const Patch& patch) { return family.is_of(patch); };
    if (std::any_of(patches.begin(), patches.end(), is_of)) continue;
    std::set<std::string> known;
    for (const Patch& patch : patches) {
      known.insert(patch.name);
      if (!patch.family.empty()) known.insert(patch.family);
    }
    throw InputError(fmt::format("no family or patch is called '{}'; there are: {}", family.name,
                                 fmt::join(known, ", ")));
  }
}

void MarchOptions::validate() const {
  if (!(step_voxels >= 0.01 && step_voxels <= 2)) {
    throw InputError(fmt::format("step = {}, but must be in [0.01, 2] voxels", step_voxels));
  }
  if (!(gap_margin >= 0 && gap_margin <= 0.9)) {
    throw InputError(fmt::format("gap-margin = {}, but must be in [0, 0.9]", gap_margin));
  }
  if (!(splay >= 0 && splay <= 1)) {
    throw InputError(fmt::format("splay = {:.6g} degrees, but must be in [0, 57]", degrees(splay)));
  }
  for (const FamilyLayers& family : families) family.validate();
}

Layers march(const Surface& surface, const DistanceField& field, const LayerSpacing& spacing,
             const MarchOptions& options, const Progress& progress) {
  options.validate();
  if (spacing.heights_world.size() < 2) throw InputError("the layer spacing has no layers");
  const std::size_t nodes = surface.nodes_world.size();
  Layers layers = blank(spacing, nodes);
  ask(surface, options, layers);
  const NodeDirections directions = node_directions(*surface.wall, surface.wall_nodes);
  const Vec3List leans = lean(surface, options, spacing.height_world);
  const auto marcher = [&] {
    return Marcher{surface, directions, leans, options.gap_margin,
                   ColumnTracer(surface, field, options)};
  };
  parallel::for_ranges({progress, "march", 0, 0.8}, nodes, 32,
                       [&](std::size_t begin, std::size_t end) {
                         Marcher own = marcher();
                         for (std::size_t n = begin; n < end; ++n) {
                           if (!surface.is_copy(n)) own.explore(n, layers);
                         }
                       });
  if (surface.flat) copy_across(surface, layers);
  const auto shorten = [&](const std::vector<std::size_t>& nodes_left, double from, double to) {
    parallel::for_ranges({progress, "march", from, to}, nodes_left.size(), 32,
                         [&](std::size_t begin, std::size_t end) {
                           Marcher own = marcher();
                           for (std::size_t n = begin; n < end; ++n)
                             own.shorten(nodes_left[n], layers);
                         });
    if (surface.flat) copy_across(surface, layers);
  };
  Free free{layers.height_world, layers.stop};
  shorten(limit(surface, options.graded, layers), 0.8, 0.95);
  for (int n = 0; n < kMostLowerings; ++n) {
    progress.check();
    const std::vector<double> room = face_room(surface, layers, options.gap_margin);
    if (room.empty()) break;
    shorten(lower(surface, options, room, free, layers), 0.95, 1);
  }
  layers.report = summarise(surface, layers);
  return layers;
}

}  // namespace vdb_offset
