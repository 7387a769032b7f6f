// Named planes first, then those that free edges are found to lie on.

#include "surface/end_planes.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <memory>
#include <optional>
#include <utility>

#include "surface/coincide.h"
#include "surface/cut_faces.h"
#include "surface/find_openings.h"
#include "surface/missed_edges.h"
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

constexpr double kNearMiss = 1e4;  // times what is near enough

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
    const std::vector<PlanePart> parts = parts_in(finder_, opening.plane, opening.edges);
    for (const PlanePart& part : boundaries_in(finder_, opening.plane, parts)) {
      if (!finder_.is_opening(opening.plane, part.edges)) continue;
      const std::size_t number = ends_.boundaries.list().size();
      if (add_local("", opening.plane, part.edges)) unnamed_.push_back({number, "opening"});
    }
  }
}

void EndPlanes::find_global() {
  for (Plane plane; finder_.best(plane);) {
    Found one{plane, finder_.left_on(plane), true};
    for (const CutPlane& there : cut_planes()) {
      if (!is_same_plane(there.plane, {plane, surface_.nodes_world, finder_.tolerance()})) continue;
      one.plane = there.plane;
      one.is_whole = false;
      break;
    }
    if (one.is_whole) finder_.take(one.plane);
    for (const std::size_t e : one.edges) finder_.edges()[e].taken = true;
    found_.push_back(std::move(one));
  }
}

void EndPlanes::find() {
  find_local();
  find_global();
  for (const Opening& opening : find_cut_openings(finder_, cut_planes())) {
    const std::size_t number = ends_.boundaries.list().size();
    if (add_local("", opening.plane, opening.edges)) unnamed_.push_back({number, "opening"});
  }
}

/// Each once, with the edges of all its boundaries.
std::vector<CutPlane> EndPlanes::cut_planes() const {
  std::vector<CutPlane> planes;
  const auto put = [&](const Plane& plane, const std::vector<std::size_t>& edges) {
    const auto is_there = [&](const CutPlane& one) { return is_one(one.plane, plane); };
    auto place = std::ranges::find_if(planes, is_there);
    if (place == planes.end()) place = planes.insert(place, {plane, {}});
    place->edges.insert(place->edges.end(), edges.begin(), edges.end());
  };
  for (const Added& added : added_)
    put(ends_.boundaries.list()[added.boundary].plane(), added.edges);
  for (const Found& one : found_) put(one.plane, one.edges);
  for (CutPlane& one : planes) {
    const PlaneRim rim = finder_.rim_of(one.plane, one.edges);
    const auto says_so = [&](const Added& added) {
      const Boundary& boundary = ends_.boundaries.list()[added.boundary];
      return boundary.name().starts_with("symmetry") && is_one(boundary.plane(), one.plane);
    };
    one.is_symmetry = (rim.is_closed() && rim.area > finder_.tolerance() * rim.length) ||
                      std::ranges::any_of(added_, says_so);
  }
  return planes;
}

/// Of edges that have one name: openings if the flow passes the greater part of them.
std::string EndPlanes::kind_of(const Plane& plane, const std::vector<PlanePart>& parts,
                               const std::vector<CutPlane>& planes) const {
  double length = 0;
  double open = 0;
  std::vector<std::size_t> edges;
  for (const PlanePart& part : parts) {
    length += part.length_world;
    open += part.is_opening ? part.length_world : 0;
    edges.insert(edges.end(), part.edges.begin(), part.edges.end());
  }
  if (finder_.is_flat()) {
    const PlaneRim rim = finder_.rim_of(plane, edges);
    const auto is_half = [&](const CutPlane& other) { return closes_with_image(rim, other); };
    const bool is_open = rim.is_opening() || std::ranges::any_of(planes, is_half);
    return is_open ? "opening" : "symmetry";
  }
  return open > 0.5 * length ? "opening" : "symmetry";
}

/// What has no name yet gets one, that of what it is to the flow.
void EndPlanes::add_found() {
  const std::vector<CutPlane> planes = cut_planes();
  std::vector<CutFaces> cut(planes.size());
  if (!finder_.is_flat()) cut = find_cut_faces(finder_, planes);
  const auto parts_of = [&](const Plane& plane, const std::vector<std::size_t>& edges) {
    const auto is_there = [&](const CutPlane& one) { return is_one(one.plane, plane); };
    const auto place = std::ranges::find_if(planes, is_there) - planes.begin();
    return parts_in(finder_, plane, edges, cut[static_cast<std::size_t>(place)]);
  };
  for (auto& [boundary, kind] : unnamed_) {
    const auto added = std::ranges::find(added_, boundary, &Added::boundary);
    const Plane plane = ends_.boundaries.list()[boundary].plane();
    if (kind.empty()) kind = kind_of(plane, parts_of(plane, added->edges), planes);
    ends_.boundaries.rename(boundary, free_name(used_, kind));
  }
  for (const Found& one : found_) {
    const std::vector<PlanePart> parts =
        boundaries_in(finder_, one.plane, parts_of(one.plane, one.edges));
    const bool is_all = one.is_whole && parts.size() == 1;
    for (const PlanePart& part : parts) {
      add(free_name(used_, kind_of(one.plane, {part}, planes)),
          is_all ? one.plane : through(one.plane, part.centre_world), part.edges);
    }
  }
}

/// Openings whose planes the wall passes elsewhere, those that planes not found yet cut too.
std::vector<Opening> EndPlanes::openings_ahead() const {
  PlaneFinder ahead = finder_;
  std::vector<CutPlane> planes = cut_planes();
  for (Plane plane; ahead.best(plane);) {
    planes.push_back({plane, ahead.left_on(plane)});
    ahead.take(planes.back().plane);
  }
  std::vector<Opening> openings = find_openings(finder_);
  const std::vector<Opening> cut = find_cut_openings(ahead, std::move(planes));
  openings.insert(openings.end(), cut.begin(), cut.end());
  return openings;
}

/// All of the openings that lie in a plane; turns its normal towards the wall at them.
std::vector<std::size_t> EndPlanes::openings_on(Plane& plane) const {
  std::vector<std::size_t> edges;
  const Plane given = plane;
  for (const Opening& opening : openings_ahead()) {
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

/// "; the nearest of its edges are 1e-05 off it, ..." where that is little.
std::string EndPlanes::near_miss(const Plane& plane) const {
  const double off = nearest_missed(finder_, plane);
  if (off > kNearMiss * finder_.tolerance()) return {};
  return fmt::format("; the nearest {} are {:.3g} off it, and {:.3g} would do, {:g} of the size",
                     finder_.is_flat() ? "ends of curves" : "free edges", off, finder_.tolerance(),
                     kOnPlane);
}

/// "(1, 2, 3)": of what a plane that cuts the surface parts off, the smaller side's farthest point.
std::string EndPlanes::farthest_beyond(const Plane& plane) const {
  const std::array<double, 2> sides = finder_.reach(plane);
  const double towards = -sides[0] < sides[1] ? 1 : -1;
  const Vec3& p = *std::ranges::min_element(
      finder_.nodes(), {}, [&](const Vec3& node) { return towards * height(plane, node); });
  return finder_.is_flat() ? fmt::format("({:g}, {:g})", p.x(), p.y())
                           : fmt::format("({:g}, {:g}, {:g})", p.x(), p.y(), p.z());
}

void EndPlanes::add_one(const NamedPlane& named) {
  Plane plane = Boundary("", named.plane).plane();
  const std::array<double, 2> sides = finder_.reach(plane);
  if (cuts(plane)) {
    const std::vector<std::size_t> edges = openings_on(plane);
    const std::size_t number = ends_.boundaries.list().size();
    if (!edges.empty() && add_local(named.name, plane, edges)) {
      if (named.name.empty()) unnamed_.push_back({number, "opening"});
      return;
    }
    throw InputError(fmt::format(
        "the boundary plane {} cuts the surface, which reaches {:g} to one side of it and {:g} to "
        "the other, on the smaller side as far as {}; all of the surface has to lie on one side, "
        "or the plane to hold an opening of the flow{}",
        describe(plane, finder_.is_flat()), -sides[0], sides[1], farthest_beyond(plane),
        near_miss(plane)));
  }
  if (-sides[0] > sides[1]) plane.normal = -plane.normal;
  if (named.name.empty()) unnamed_.push_back({ends_.boundaries.list().size(), ""});
  const std::vector<std::size_t> on = finder_.edges_on(plane);
  const double off = nearest_missed(finder_, plane);
  add(named.name, plane, on);
  if (on.empty()) added_.back().nearest_world = off;
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

/// Free edges that nearly lie on planes that were given, the first so many; each plane once.
void EndPlanes::note_missed(std::size_t given) {
  for (std::size_t n = 0; n < given; ++n) {
    const auto boundary = [&](std::size_t m) -> const Boundary& {
      return ends_.boundaries.list()[added_[m].boundary];
    };
    bool is_again = false;
    for (std::size_t m = 0; m < n; ++m) {
      is_again = is_again || is_one(boundary(m).plane(), boundary(n).plane());
    }
    if (is_again) continue;
    std::optional<MissedEdges> missed = missed_edges(finder_, boundary(n).plane());
    const double nearest = added_[n].nearest_world;
    if (nearest > 0) missed = MissedEdges{{}, 0, nearest, nearest, finder_.tolerance()};
    if (!missed || !std::isfinite(missed->off_world)) continue;
    missed->plane = boundary(n).name();
    ends_.missed.push_back(*missed);
  }
}

void EndPlanes::finish() {
  const std::size_t given = added_.size();
  add_found();
  note_missed(given);
  mark();
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
