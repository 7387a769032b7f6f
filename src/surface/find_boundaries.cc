// Where an open surface ends: on the boundaries that are named, then on planes that are found.

#include "surface/find_boundaries.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <memory>
#include <set>

#include "surface/beyond_shape.h"
#include "surface/coincide.h"
#include "surface/curve_tails.h"
#include "surface/end_planes.h"
#include "surface/facet_size.h"
#include "surface/internal_nodes.h"
#include "surface/plane_finder.h"
#include "surface/shape_wall.h"
#include "surface/topology.h"
#include "surface/whole_wall.h"
#include "vdb_offset/core/error.h"

namespace vdb_offset {

namespace {

// |cosine| between the normals of wall and shape above which the wall lies flat on it, or goes on
// into it: 26 degrees.
constexpr double kUprightOnShape = 0.9;

/// What faces of blocks that are on no boundary are called.
bool is_reserved(const std::string& name) {
  constexpr std::array<const char*, 6> kReserved{"wall", "outer", "free", "pole", "edge", "corner"};
  return std::find(kReserved.begin(), kReserved.end(), name) != kReserved.end();
}

/// The names that were given. They tell boundaries apart, from each other and from other faces of
/// blocks: what is found is not called as a part of the wall is either.
std::set<std::string> given_names(const Patches& wall, const SurfaceOptions& options) {
  std::set<std::string> given;
  const auto add = [&](const std::string& name) {
    if (name.empty() || (!is_reserved(name) && given.insert(name).second)) return;
    throw InputError(
        fmt::format("a boundary cannot be called '{}': that is the name of {}; give it another",
                    name, is_reserved(name) ? "a kind of face" : "a boundary already"));
  };
  for (const NamedPlane& named : options.planes) add(named.name);
  for (const NamedShape& named : options.shapes) add(named.name);
  for (const NamedShape& named : options.internals) add(named.name);
  for (const Patch& patch : wall) given.insert({patch.family, patch.name});
  for (const NamedShape& named : options.shapes) {
    if (!named.is_bare_wall) continue;
    for (const Patch& patch : named.patches) given.insert({patch.family, patch.name});
  }
  return given;
}

/// The factor on shapes' coordinates, the width of a flat surface, and the first internal surface.
struct Wide {
  double scale, width;
  std::size_t first;
};

/// Curves as strips, past those of a flat surface on both sides, so that none of it is at their
/// rims; patches as they are.
Patches as_strips(Patches patches, double width) {
  for (Patch& patch : patches) {
    if (patch.nj != 1) continue;
    const Vec3List curve = patch.points_world;
    for (Vec3& p : patch.points_world) p.z() = -width;
    for (const Vec3& p : curve) patch.points_world.emplace_back(p.x(), p.y(), 2 * width);
    patch.nj = 2;
  }
  return patches;
}

double longest_of(const std::vector<const FreeEdge*>& rim) {
  double longest = 0;
  for (const FreeEdge* edge : rim) longest = std::max(longest, edge->length);
  return longest;
}

/// How far an edge is off a shape, in parts of what is near enough, and whether the wall lies flat
/// on the shape there.
struct Fit {
  double off;
  bool is_flat;
};

/// `sagitta`: how far off the wall may be for the shape's facets, in parts of theirs.
Fit fit_to(const Wall& shape, const PlaneFinder& finder, const FreeEdge& edge, double sagitta) {
  const WallPoint a = shape.closest(finder.node(edge.a));
  const WallPoint b = shape.closest(finder.node(edge.b));
  const double near = std::max(kOnShape * edge.length, sagitta * facet_size(shape, a.triangle));
  return {std::max(a.distance_world, b.distance_world) / near,
          std::abs(a.normal.dot(edge.normal)) > kUprightOnShape};
}

void add_taper(FreeEdge& edge, Ends& ends) {
  edge.taken = true;
  ++ends.taper_edges;
  ends.tapers.insert(ends.tapers.end(), {edge.a, edge.b});
}

/// A surface, and what is left of its free edges.
struct OpenWall {
  const OpenSurface& surface;
  PlaneFinder& finder;
};

void add_named_shape(const OpenWall& open, const NamedShape& named, double scale, Ends& ends) {
  PlaneFinder& finder = open.finder;
  const NamedShape as_wide{named.name, as_strips(named.patches, finder.width() / scale)};
  auto shape = shape_wall(as_wide, scale);
  if (!named.is_bare_wall) refuse_on_wall(open.surface, named.name, *shape);
  std::vector<const FreeEdge*> rim;
  bool is_beside = false;
  double least = std::numeric_limits<double>::infinity();
  for (FreeEdge& edge : finder.edges()) {
    if (edge.taken || !(edge.length > 0)) continue;
    // A bare wall's points are those of its neighbours.
    const Fit fit = fit_to(*shape, finder, edge, named.is_bare_wall ? 0 : kSagitta);
    // Where the wall lies flat on the shape columns cannot march within it.
    const bool goes_on = fit.off <= 1 && fit.is_flat;
    is_beside = is_beside || goes_on;
    if (goes_on && named.is_bare_wall) add_taper(edge, ends);
    if (!fit.is_flat) least = std::min(least, fit.off);
    if (fit.off > 1 || fit.is_flat) continue;
    edge.taken = true;
    rim.push_back(&edge);
  }
  if (rim.empty() && is_beside && named.is_bare_wall) return;
  if (rim.empty() && named.is_bare_wall) {
    ends.boundaries.add({named.name, shape, ShapeRole::Wall});
    return;
  }
  if (rim.empty()) {
    throw InputError(fmt::format(
        "no free edge of the surface lies on the boundary '{}'{}", named.name,
        std::isfinite(least)
            ? fmt::format(": the nearest is {:.3g} times as far from it as would do", least)
            : " at an angle to it, or all that do lie on boundaries that were named before"));
  }
  shape = turned_shape(as_wide, scale, {finder, rim});
  if (!named.is_bare_wall) {
    refuse_beyond(open.surface, named.name, *shape, kOnShape * longest_of(rim));
  }
  // The domain goes on behind a bare wall, on the body's other sides.
  ends.boundaries.add({named.name, shape, named.is_bare_wall ? ShapeRole::Wall : ShapeRole::End});
  const BoundarySet bit = BoundarySet{1} << (ends.boundaries.list().size() - 1);
  for (const FreeEdge* edge : rim) {
    ends.on[static_cast<std::size_t>(edge->a)] |= bit;
    ends.on[static_cast<std::size_t>(edge->b)] |= bit;
  }
}

/// Internal surfaces, and the nodes that they meet the wall at.
void add_internal(const OpenSurface& surface, const NamedShape& named, const Wide& wide,
                  Ends& ends) {
  const auto shape =
      shape_wall({named.name, as_strips(named.patches, wide.width / wide.scale)}, wide.scale);
  refuse_same_surface(ends.boundaries, wide.first, named.name, *shape);
  ends.boundaries.add({named.name, shape, ShapeRole::Internal});
  const auto number = static_cast<int>(ends.boundaries.list().size()) - 1;
  mark_internal_nodes(surface, {named.name, *shape, number}, ends);
}

/// What the wall ends on, all of it that `options` know of: named boundaries, then those found.
void end_wall(const OpenSurface& surface, PlaneFinder& finder, const SurfaceOptions& options,
              Ends& ends) {
  std::set<std::string> names = given_names(surface.grids.patches, options);
  EndPlanes planes(surface, finder, names, ends);
  planes.add_named(options.planes);
  for (const NamedShape& named : options.shapes)
    add_named_shape({surface, finder}, named, options.scale, ends);
  if (options.open_edges != OpenEdges::Splay) {
    if (finder.is_flat()) ends.open_tails = leave_open_tails(surface, finder);
    planes.find();
  }
  planes.finish();
}

/// The boundaries of the wall without layers too, those that were given and those that this wall
/// ends on as well; false if that is no surface, or ends on none of some that were given.
bool end_as_whole(const OpenSurface& surface, PlaneFinder& finder, const SurfaceOptions& options,
                  Ends& ends) {
  std::optional<WholeWall> whole = whole_wall(surface, options, finder.width());
  if (!whole) return false;
  SurfaceOptions given = options;
  std::erase_if(given.shapes, [](const NamedShape& named) { return named.is_bare_wall; });
  Ends all;
  all.on.assign(whole->nodes_world.size(), 0);
  try {
    const OpenSurface open = whole->open(surface.is_flat);
    PlaneFinder whole_finder(open);
    end_wall(open, whole_finder, given, all);
  } catch (const InputError&) {
    return false;
  }
  const auto on_whole = [&](std::size_t n) {
    return all.on[static_cast<std::size_t>(whole->node_of[n])];
  };
  BoundarySet met = 0;
  for (std::size_t n = 0; n < ends.on.size(); ++n) met |= on_whole(n);
  const auto take_over = [&](std::size_t b) {
    const BoundarySet bit = BoundarySet{1} << ends.boundaries.list().size();
    ends.boundaries.add(all.boundaries.list()[b]);
    for (std::size_t n = 0; n < ends.on.size(); ++n) {
      if ((on_whole(n) >> b & 1U) != 0) ends.on[n] |= bit;
    }
  };
  const std::size_t count = given.planes.size() + given.shapes.size();
  for (std::size_t b = 0; b < count; ++b) take_over(b);
  for (FreeEdge& edge : finder.edges()) {
    edge.taken = (on_whole(static_cast<std::size_t>(edge.a)) &
                  on_whole(static_cast<std::size_t>(edge.b))) != 0;
  }
  for (const NamedShape& named : options.shapes) {
    if (named.is_bare_wall) add_named_shape({surface, finder}, named, options.scale, ends);
  }
  for (std::size_t b = count; b < all.boundaries.list().size(); ++b) {
    if ((met >> b & 1U) != 0) take_over(b);
  }
  ends.open_tails = std::move(all.open_tails);
  ends.missed = std::move(all.missed);
  return true;
}

/// "patch 1 'upper', its last point, at (1, 0.2)": the end of a curve.
std::string end_name(const Patches& patches, const SideRange& range) {
  const Patch& patch = patches[static_cast<std::size_t>(range.patch)];
  const Vec3& end =
      patch.points_world[static_cast<std::size_t>(side_point(patch, range.side, range.begin))];
  return fmt::format("{}, its {} point, at ({:g}, {:g})", name_of(patch, range.patch),
                     range.side == Side::IMin ? "first" : "last", end.x(), end.y());
}

/// Names the sides that are open, on no boundary and do not taper, if there are any.
void refuse_left(const OpenSurface& surface, const Ends& ends) {
  constexpr std::size_t kShown = 6;
  const NodeGrids& grids = surface.grids;
  const auto tapers = [&](const SideRange& range, int s) {
    const auto p = static_cast<std::size_t>(range.patch);
    const int point = side_point(grids.patches[p], range.side, s);
    return std::ranges::binary_search(ends.tapers, grids.nodes[p][static_cast<std::size_t>(point)]);
  };
  std::vector<std::string> sides;
  for (const Edge& edge : build_topology(grids.patches, grids.nodes, ends.on).edges) {
    if (edge.kind != EdgeKind::Free || edge.boundary >= 0) continue;
    int s = edge.first.begin;
    while (s <= edge.first.end && tapers(edge.first, s)) ++s;
    if (s > edge.first.end) continue;
    sides.push_back(surface.is_flat ? end_name(grids.patches, edge.first)
                                    : side_name(grids.patches, edge.first));
  }
  if (sides.empty()) return;
  const std::size_t hidden = sides.size() > kShown ? sides.size() - kShown : 0;
  sides.resize(sides.size() - hidden);
  const std::string all = fmt::format("{}{}", fmt::join(sides, "; "),
                                      hidden > 0 ? fmt::format("; and {} more", hidden) : "");
  if (surface.is_flat) {
    throw InputError(fmt::format(
        "ends of curves lie on no boundary: {}; {}name a boundary line or curve there, or let them "
        "splay",
        all, ends.open_tails.empty() ? "" : "close the trailing edge with the first point, "));
  }
  throw InputError(fmt::format(
      "free edges lie on no boundary: {}; name a boundary plane or surface there, or let them "
      "splay",
      all));
}

}  // namespace

std::string side_name(const Patches& patches, const SideRange& range) {
  constexpr std::array<const char*, 4> kNames{"imin", "imax", "jmin", "jmax"};
  const Patch& patch = patches[static_cast<std::size_t>(range.patch)];
  if (!patch.is_grid()) {
    const auto point = static_cast<std::size_t>(side_point(patch, range.side, range.begin));
    const Vec3& x = patch.points_world[point];
    return fmt::format("{}, {} edges of its rim from ({:g}, {:g}, {:g})",
                       name_of(patch, range.patch), range.cells(), x.x(), x.y(), x.z());
  }
  return fmt::format("{}, side {}, points {} to {}", name_of(patch, range.patch),
                     kNames[static_cast<std::size_t>(range.side)], range.begin + 1, range.end + 1);
}

Ends find_boundaries(const OpenSurface& surface, const SurfaceOptions& options) {
  given_names(surface.grids.patches, options);
  Ends ends;
  ends.on.assign(surface.nodes_world.size(), 0);
  PlaneFinder finder(surface);
  if (!end_as_whole(surface, finder, options, ends)) end_wall(surface, finder, options, ends);
  const std::size_t first = ends.boundaries.list().size();
  for (const NamedShape& named : options.internals) {
    add_internal(surface, named, {options.scale, finder.width(), first}, ends);
  }
  std::ranges::sort(ends.tapers);
  ends.tapers.erase(std::unique(ends.tapers.begin(), ends.tapers.end()), ends.tapers.end());
  if (options.open_edges == OpenEdges::Refuse) refuse_left(surface, ends);
  for (std::size_t n = 0; n < ends.on.size(); ++n) {
    if (ends.on[n] == 0) continue;
    const Vec3 held = ends.boundaries.hold(ends.on[n], surface.nodes_world[n]);
    for (std::size_t b = 0; ends.on[n] >> b != 0; ++b) {
      if ((ends.on[n] >> b & 1U) == 0) continue;
      const double off = std::abs(ends.boundaries.list()[b].side(surface.nodes_world[n]));
      ends.moved_max_world = std::max(ends.moved_max_world, off);
    }
    ends.moved_max_world = std::max(ends.moved_max_world, (held - surface.nodes_world[n]).norm());
    surface.nodes_world[n] = held;
  }
  return ends;
}

}  // namespace vdb_offset
