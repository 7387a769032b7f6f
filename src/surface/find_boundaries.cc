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

#include "surface/coincide.h"
#include "surface/find_openings.h"
#include "surface/internal_nodes.h"
#include "surface/plane_finder.h"
#include "surface/topology.h"
#include "vdb_offset/core/error.h"

namespace vdb_offset {

namespace {

// |cosine| between the normals of wall and shape above which the wall lies flat on it, or goes on
// into it: 26 degrees.
constexpr double kUprightOnShape = 0.9;
// A shape's facets may miss what they stand for by this part of their size: 14 degrees an edge.
constexpr double kSagitta = 0.03;

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
  return given;
}

/// "symmetry", then "symmetry 2": the first that is neither given nor taken.
std::string free_name(std::set<std::string>& used, const std::string& name) {
  std::string unused = name;
  for (int n = 2; !used.insert(unused).second; ++n) unused = fmt::format("{} {}", name, n);
  return unused;
}

void find_planes(PlaneFinder& finder, std::set<std::string>& used, Ends& ends) {
  for (Plane plane; finder.best(plane);) {
    finder.take(plane);
    ends.boundaries.add({free_name(used, finder.kind_of(plane)), plane});
  }
}

/// Cells of the wall as triangles, those that `is_kept` says yes to.
template <typename Keep>
std::shared_ptr<const Wall> part_of(const OpenSurface& surface, const Keep& is_kept) {
  std::vector<Wall::Triangle> triangles;
  for (std::size_t p = 0; p < surface.grids.patches.size(); ++p) {
    for_cells(surface.grids.patches[p], [&](std::array<int, 4> c) {
      for (int& corner : c) corner = surface.grids.nodes[p][static_cast<std::size_t>(corner)];
      if (std::ranges::none_of(c, is_kept)) return;
      triangles.insert(triangles.end(), {{c[0], c[1], c[2]}, {c[0], c[2], c[3]}});
    });
  }
  if (triangles.empty()) return nullptr;
  return std::make_shared<const Wall>(surface.nodes_world, std::move(triangles));
}

/// A boundary at an opening whose plane the wall passes elsewhere; false if it does not.
bool add_local(const OpenSurface& surface, PlaneFinder& finder, const NamedPlane& named,
               const Opening& opening, Ends& ends) {
  std::set<int> rim;
  for (const std::size_t e : opening.edges) {
    rim.insert({finder.edges()[e].a, finder.edges()[e].b});
  }
  const Plane& plane = opening.plane;
  auto crossing = part_of(surface, [&](int n) {
    return plane.normal.dot(finder.node(n) - plane.point_world) < -finder.tolerance();
  });
  if (crossing == nullptr) return false;
  auto beside = part_of(surface, [&](int n) { return rim.contains(n); });
  ends.boundaries.add({named.name, named.plane, std::move(beside), std::move(crossing)});
  const BoundarySet bit = BoundarySet{1} << (ends.boundaries.list().size() - 1);
  for (const int n : rim) ends.on[static_cast<std::size_t>(n)] |= bit;
  for (const std::size_t e : opening.edges) finder.edges()[e].taken = true;
  return true;
}

/// Openings whose planes the wall passes elsewhere.
void find_local_planes(const OpenSurface& surface, PlaneFinder& finder, std::set<std::string>& used,
                       Ends& ends) {
  for (const Opening& opening : find_openings(finder)) {
    std::set<std::string> names = used;
    const NamedPlane found{free_name(names, "opening"), opening.plane};
    if (add_local(surface, finder, found, opening, ends)) used = std::move(names);
  }
}

/// Openings in a plane that was named and that the wall passes elsewhere; false if there is none.
bool add_named_local(const OpenSurface& surface, PlaneFinder& finder, const NamedPlane& named,
                     Ends& ends) {
  for (const Opening& opening : find_openings(finder)) {
    const bool is_on = std::ranges::all_of(opening.edges, [&](std::size_t e) {
      const Vec3 off = finder.node(finder.edges()[e].a) - named.plane.point_world;
      return std::abs(off.dot(named.plane.normal)) <= finder.tolerance();
    });
    NamedPlane turned = named;
    if (opening.plane.normal.dot(named.plane.normal) < 0) turned.plane.normal *= -1;
    if (is_on && add_local(surface, finder, turned, opening, ends)) return true;
  }
  return false;
}

/// A named plane; the surface, for what of it passes that.
struct PlaneTask {
  const OpenSurface& surface;
  const NamedPlane& named;
};

void add_named_plane(const PlaneTask& task, PlaneFinder& finder, std::set<std::string>& used,
                     Ends& ends) {
  const NamedPlane& named = task.named;
  Plane plane = Boundary("", named.plane).plane();
  const std::array<double, 2> sides = finder.reach(plane);
  if (std::min(-sides[0], sides[1]) > finder.tolerance()) {
    std::set<std::string> names = used;
    const std::string name = named.name.empty() ? free_name(names, "opening") : named.name;
    if (add_named_local(task.surface, finder, {name, plane}, ends)) {
      used = std::move(names);
      return;
    }
    throw InputError(fmt::format(
        "the boundary plane {} cuts the surface, which reaches {:g} to one side of it and {:g} to "
        "the other; all of the surface has to lie on one side, or the plane to hold an opening of "
        "the flow",
        describe(plane), -sides[0], sides[1]));
  }
  if (-sides[0] > sides[1]) plane.normal = -plane.normal;
  Plane fitted = plane;
  finder.take(fitted);
  const std::string kind = finder.kind_of(plane);
  const std::string name = named.name.empty() ? free_name(used, kind) : named.name;
  refuse_same_plane(ends.boundaries, name, {plane, task.surface.nodes_world, finder.tolerance()});
  ends.boundaries.add({name, plane});
}

std::shared_ptr<const Wall> wall_of(const NamedShape& named, double scale, MarchSide side) {
  SurfaceOptions plain;
  plain.open_edges = OpenEdges::Splay;
  plain.scale = scale;
  plain.side = side;
  return build_surface(named.patches, plain).wall;
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

/// Longest edge of one triangle.
double facet_size(const Wall& shape, int triangle) {
  if (triangle < 0) return 0;
  const TriangleGeometry& g = shape.geometry()[static_cast<std::size_t>(triangle)];
  return std::max({g.ab.norm(), g.ac.norm(), (g.ac - g.ab).norm()});
}

/// Whether the shape's normals point away from the wall's cells at the free edges on it.
bool is_turned(const Wall& shape, const PlaneFinder& finder,
               const std::vector<const FreeEdge*>& rim) {
  double inward = 0;
  for (const FreeEdge* edge : rim) {
    const Vec3 middle = 0.5 * (finder.node(edge->a) + finder.node(edge->b));
    inward += shape.closest(middle).normal.dot(edge->inward);
  }
  return inward < 0;
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

void add_named_shape(PlaneFinder& finder, const NamedShape& named, double scale, Ends& ends) {
  const NamedShape as_wide{named.name, as_strips(named.patches, finder.width() / scale)};
  auto shape = wall_of(as_wide, scale, MarchSide::Along);
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
    ends.boundaries.add({named.name, shape, true});
    return;
  }
  if (rim.empty()) {
    throw InputError(fmt::format(
        "no free edge of the surface lies on the boundary '{}'{}", named.name,
        std::isfinite(least)
            ? fmt::format(": the nearest is {:.3g} times as far from it as would do", least)
            : " at an angle to it, or all that do lie on boundaries that were named before"));
  }
  if (is_turned(*shape, finder, rim)) shape = wall_of(as_wide, scale, MarchSide::Against);
  // The domain goes on behind a bare wall, on the body's other sides.
  ends.boundaries.add({named.name, shape, /*two_sided=*/named.is_bare_wall});
  const BoundarySet bit = BoundarySet{1} << (ends.boundaries.list().size() - 1);
  for (const FreeEdge* edge : rim) {
    ends.on[static_cast<std::size_t>(edge->a)] |= bit;
    ends.on[static_cast<std::size_t>(edge->b)] |= bit;
  }
}

/// Internal surfaces, and the nodes that they meet the wall at.
void add_internal(const OpenSurface& surface, const NamedShape& named, const Wide& wide,
                  Ends& ends) {
  const auto shape = wall_of({named.name, as_strips(named.patches, wide.width / wide.scale)},
                             wide.scale, MarchSide::Along);
  refuse_same_surface(ends.boundaries, wide.first, named.name, *shape);
  ends.boundaries.add({named.name, shape, true});
  const auto number = static_cast<int>(ends.boundaries.list().size()) - 1;
  mark_internal_nodes(surface, {named.name, *shape, number}, ends);
}

/// Nodes of free edges on the planes.
void mark_planes(const PlaneFinder& finder, Ends& ends) {
  for (const FreeEdge& edge : finder.edges()) {
    for (std::size_t b = 0; b < ends.boundaries.list().size(); ++b) {
      const Boundary& boundary = ends.boundaries.list()[b];
      if (!boundary.is_plane() || boundary.is_local()) continue;
      for (const int n : {edge.a, edge.b}) {
        if (std::abs(boundary.side(finder.node(n))) > finder.tolerance()) continue;
        ends.on[static_cast<std::size_t>(n)] |= BoundarySet{1} << b;
      }
    }
  }
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
    if (s <= edge.first.end) sides.push_back(side_name(grids.patches, edge.first));
  }
  if (sides.empty()) return;
  const std::size_t hidden = sides.size() > kShown ? sides.size() - kShown : 0;
  sides.resize(sides.size() - hidden);
  throw InputError(fmt::format(
      "free edges lie on no boundary: {}{}; name a boundary plane or surface there, or let them "
      "splay",
      fmt::join(sides, "; "), hidden > 0 ? fmt::format("; and {} more", hidden) : ""));
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
  std::set<std::string> names = given_names(surface.grids.patches, options);
  Ends ends;
  ends.on.assign(surface.nodes_world.size(), 0);
  PlaneFinder finder(surface);
  for (const NamedShape& named : options.shapes) {
    if (named.is_bare_wall) finder.add_bare_wall(named.patches, options.scale);
  }
  for (const NamedPlane& named : options.planes)
    add_named_plane({surface, named}, finder, names, ends);
  for (const NamedShape& named : options.shapes)
    add_named_shape(finder, named, options.scale, ends);
  if (options.open_edges != OpenEdges::Splay) {
    // First: two edges of such loops may well lie in a plane that the whole wall is behind.
    find_local_planes(surface, finder, names, ends);
    find_planes(finder, names, ends);
  }
  const std::size_t first = ends.boundaries.list().size();
  for (const NamedShape& named : options.internals) {
    add_internal(surface, named, {options.scale, finder.width(), first}, ends);
  }
  mark_planes(finder, ends);
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
