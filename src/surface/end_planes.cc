// Named planes first, then those that free edges are found to lie on.

#include "surface/end_planes.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <limits>
#include <memory>

#include "surface/coincide.h"
#include "surface/find_openings.h"
#include "surface/plane_parts.h"
#include "surface/share_plane.h"
#include "vdb_offset/core/error.h"

namespace vdb_offset {

namespace {

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

double height(const Plane& plane, const Vec3& p) { return plane.normal.dot(p - plane.point_world); }

/// A plane through a place on it.
Plane through(const Plane& plane, const Vec3& place) {
  return {Boundary("", plane).project(place), plane.normal};
}

}  // namespace

std::string free_name(std::set<std::string>& used, const std::string& name) {
  std::string unused = name;
  for (int n = 2; !used.insert(unused).second; ++n) unused = fmt::format("{} {}", name, n);
  return unused;
}

/// Parts of one plane.
bool EndPlanes::is_one(const Plane& a, const Plane& b) const {
  return (a.normal - b.normal).norm() < 1e-12 &&
         std::abs(height(a, b.point_world)) < 1e-3 * finder_.tolerance();
}

bool EndPlanes::cuts(const Plane& plane) const {
  const std::array<double, 2> sides = finder_.reach(plane);
  return std::min(-sides[0], sides[1]) > finder_.tolerance();
}

void EndPlanes::add(const std::string& name, const Plane& plane,
                    const std::vector<std::size_t>& edges) {
  for (const std::size_t e : edges) finder_.edges()[e].taken = true;
  added_.push_back({ends_.boundaries.list().size(), edges});
  ends_.boundaries.add({name, plane});
}

/// A boundary at openings whose plane the wall passes elsewhere; false if it does not.
bool EndPlanes::add_local(const std::string& name, const Plane& plane,
                          const std::vector<std::size_t>& edges) {
  std::set<int> rim;
  for (const std::size_t e : edges) rim.insert({finder_.edges()[e].a, finder_.edges()[e].b});
  auto crossing = part_of(
      surface_, [&](int n) { return height(plane, finder_.node(n)) < -finder_.tolerance(); });
  if (crossing == nullptr) return false;
  auto beside = part_of(surface_, [&](int n) { return rim.contains(n); });
  ends_.boundaries.add({name, plane, std::move(beside), std::move(crossing)});
  const BoundarySet bit = BoundarySet{1} << (ends_.boundaries.list().size() - 1);
  for (const int n : rim) ends_.on[static_cast<std::size_t>(n)] |= bit;
  for (const std::size_t e : edges) finder_.edges()[e].taken = true;
  return true;
}

/// Openings whose planes the wall passes elsewhere.
void EndPlanes::find_local() {
  for (const Opening& opening : find_openings(finder_)) {
    for (const PlanePart& part : boundaries_in(finder_, opening.plane, opening.edges)) {
      if (!finder_.is_opening(opening.plane, part.edges)) continue;
      std::set<std::string> names = used_;
      const std::string name = free_name(names, "opening");
      if (add_local(name, opening.plane, part.edges)) used_ = std::move(names);
    }
  }
}

void EndPlanes::find_global() {
  for (Plane plane; finder_.best(plane);) {
    std::vector<std::size_t> edges = finder_.left_on(plane);
    const auto there = std::ranges::find_if(added_, [&](const Added& added) {
      return is_same_plane(ends_.boundaries.list()[added.boundary].plane(),
                           {plane, surface_.nodes_world, finder_.tolerance()});
    });
    if (there == added_.end()) {
      finder_.take(plane);
    } else {
      plane = ends_.boundaries.list()[there->boundary].plane();
    }
    const std::vector<PlanePart> parts = boundaries_in(finder_, plane, edges);
    for (const PlanePart& part : parts) {
      const bool is_all = there == added_.end() && parts.size() == 1;
      add(free_name(used_, finder_.kind_of(plane, part.edges)),
          is_all ? plane : through(plane, part.centre_world), part.edges);
    }
  }
}

void EndPlanes::find() {
  find_local();
  find_global();
}

/// All of the openings that lie in a plane; turns its normal towards the wall at them.
std::vector<std::size_t> EndPlanes::openings_on(Plane& plane) const {
  std::vector<std::size_t> edges;
  const Plane given = plane;
  for (const Opening& opening : find_openings(finder_)) {
    const bool is_on = std::ranges::all_of(opening.edges, [&](std::size_t e) {
      return std::abs(height(given, finder_.node(finder_.edges()[e].a))) <= finder_.tolerance();
    });
    const double turned = opening.plane.normal.dot(given.normal) < 0 ? -1 : 1;
    const bool is_other = !edges.empty() && turned * plane.normal.dot(given.normal) < 0;
    if (!is_on || is_other) continue;
    plane.normal = turned * given.normal;
    edges.insert(edges.end(), opening.edges.begin(), opening.edges.end());
  }
  return edges;
}

void EndPlanes::add_one(const NamedPlane& named) {
  Plane plane = Boundary("", named.plane).plane();
  const std::array<double, 2> sides = finder_.reach(plane);
  if (cuts(plane)) {
    const std::vector<std::size_t> edges = openings_on(plane);
    std::set<std::string> names = used_;
    const std::string name = named.name.empty() ? free_name(names, "opening") : named.name;
    if (!edges.empty() && add_local(name, plane, edges)) {
      used_ = std::move(names);
      return;
    }
    throw InputError(fmt::format(
        "the boundary plane {} cuts the surface, which reaches {:g} to one side of it and {:g} to "
        "the other; all of the surface has to lie on one side, or the plane to hold an opening of "
        "the flow",
        describe(plane, finder_.is_flat()), -sides[0], sides[1]));
  }
  if (-sides[0] > sides[1]) plane.normal = -plane.normal;
  const std::vector<std::size_t> on = finder_.edges_on(plane);
  const std::string kind = finder_.kind_of(plane, on);
  add(named.name.empty() ? free_name(used_, kind) : named.name, plane, on);
}

/// The parts of a plane that has several names. Turns its normal towards the wall.
std::vector<PlanePart> EndPlanes::parts_of(Plane& plane, bool is_local) const {
  if (is_local) {
    const std::vector<std::size_t> edges = openings_on(plane);
    return parts_in(finder_, plane, edges);
  }
  const std::array<double, 2> sides = finder_.reach(plane);
  if (-sides[0] > sides[1]) plane.normal = -plane.normal;
  return parts_in(finder_, plane, finder_.left_on(plane));
}

void EndPlanes::add_shared(const std::vector<NamedPlane>& names) {
  Plane plane = Boundary("", names.front().plane).plane();
  const bool is_local = cuts(plane);
  const std::vector<PlanePart> parts = parts_of(plane, is_local);
  const bool are_named =
      std::ranges::none_of(names, [](const NamedPlane& named) { return named.name.empty(); });
  if (!are_named || parts.size() < 2) {
    const std::string remedy = are_named || parts.size() < 2
                                   ? "give one of them"
                                   : "give one of them, or a name to each for parts of it";
    throw InputError(fmt::format(
        "the boundary planes '{}' ({}) and '{}' ({}) are the same plane{}; {}", names[0].name,
        describe(plane, finder_.is_flat()), names[1].name, describe(plane, finder_.is_flat()),
        parts.size() == 1 ? ", whose free edges all hang together" : "", remedy));
  }
  const std::vector<int> owner = share_plane(finder_, plane, names, parts);
  for (std::size_t n = 0; n < names.size(); ++n) {
    std::vector<std::size_t> edges;
    Plane own = plane;
    for (std::size_t p = 0; p < parts.size(); ++p) {
      if (owner[p] != static_cast<int>(n)) continue;
      if (edges.empty()) own = through(plane, parts[p].centre_world);
      edges.insert(edges.end(), parts[p].edges.begin(), parts[p].edges.end());
    }
    if (!is_local || !add_local(names[n].name, own, edges)) add(names[n].name, own, edges);
  }
}

void EndPlanes::add_named(const std::vector<NamedPlane>& planes) {
  std::vector<bool> done(planes.size(), false);
  for (std::size_t p = 0; p < planes.size(); ++p) {
    if (done[p]) continue;
    const Plane plane = Boundary("", planes[p].plane).plane();
    std::vector<NamedPlane> same;
    for (std::size_t q = p; q < planes.size(); ++q) {
      if (done[q]) continue;
      const Plane other = Boundary("", planes[q].plane).plane();
      done[q] = is_same_plane(other, {plane, surface_.nodes_world, finder_.tolerance()});
      if (done[q]) same.push_back(planes[q]);
    }
    same.size() > 1 ? add_shared(same) : add_one(planes[p]);
  }
}

/// Whether a node is on a boundary in that plane.
bool EndPlanes::has_mark(int node, const Plane& plane) const {
  return std::ranges::any_of(added_, [&](const Added& added) {
    return (ends_.on[static_cast<std::size_t>(node)] >> added.boundary & 1U) != 0 &&
           is_one(ends_.boundaries.list()[added.boundary].plane(), plane);
  });
}

/// Of the boundaries in that plane.
std::size_t EndPlanes::nearest(int node, const Plane& plane) const {
  double least = std::numeric_limits<double>::infinity();
  std::size_t found = 0;
  for (const Added& added : added_) {
    if (!is_one(ends_.boundaries.list()[added.boundary].plane(), plane)) continue;
    const double off = distance_to(finder_, plane, {added.edges}, finder_.node(node));
    if (off > least) continue;
    found = added.boundary;
    least = off;
  }
  return found;
}

void EndPlanes::mark() const {
  for (const Added& added : added_) {
    for (const std::size_t e : added.edges) {
      for (const int n : {finder_.edges()[e].a, finder_.edges()[e].b}) {
        ends_.on[static_cast<std::size_t>(n)] |= BoundarySet{1} << added.boundary;
      }
    }
  }
  // Free edges may touch a plane with one end only.
  for (const FreeEdge& edge : finder_.edges()) {
    for (const Added& added : added_) {
      const Plane& plane = ends_.boundaries.list()[added.boundary].plane();
      for (const int n : {edge.a, edge.b}) {
        const bool is_on = std::abs(height(plane, finder_.node(n))) <= finder_.tolerance();
        if (!is_on || has_mark(n, plane)) continue;
        ends_.on[static_cast<std::size_t>(n)] |= BoundarySet{1} << nearest(n, plane);
      }
    }
  }
}

}  // namespace vdb_offset
