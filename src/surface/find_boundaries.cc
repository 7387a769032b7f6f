// Where an open surface ends. Planes are guessed from the free edges: each straight run of them
// lies in the plane through it that stands upright on the wall, each curved one in the plane that
// fits it best, and two runs that share a plane find it together. A guess becomes a boundary if the
// whole wall lies on one side of it and stands up from it; the one that takes up the most edges
// comes first.

#include "surface/find_boundaries.h"

#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>

#include "surface/topology.h"
#include "vdb_offset/core/error.h"

namespace vdb_offset {

namespace {

// The wall stands up from a plane that is found at 45 degrees or more, a little less for rounding.
constexpr double kUpright = 0.708;
constexpr std::size_t kMostRuns = 2000;  // beyond it runs are not compared in pairs

/// A free grid edge, the unit normal of its cell, and the way into it along the wall.
struct FreeEdge {
  int a, b;
  double length;
  Vec3 normal;
  Vec3 inward;
  bool taken = false;
};

/// A run of free edges along one side of one patch.
struct Run {
  std::size_t begin, end;
};

struct Free {
  std::vector<FreeEdge> edges;
  std::vector<Run> runs;
};

Vec3 cell_normal(const Patch& patch, int i, int j) {
  const int a = std::clamp(i, 0, patch.ni - 2);
  const int b = std::clamp(j, 0, patch.nj - 2);
  const Vec3 normal =
      (patch.at(a + 1, b + 1) - patch.at(a, b)).cross(patch.at(a, b + 1) - patch.at(a + 1, b));
  const double length = normal.norm();
  return length > 0 ? Vec3(normal / length) : Vec3(Vec3::Zero());
}

Free free_edges(const OpenSurface& surface) {
  Free free;
  for (const Edge& edge : surface.topology.edges) {
    if (edge.kind != EdgeKind::Free) continue;
    const auto p = static_cast<std::size_t>(edge.first.patch);
    const Patch& patch = surface.grids.patches[p];
    const std::size_t begin = free.edges.size();
    for (int s = edge.first.begin; s < edge.first.end; ++s) {
      const int from = side_point(patch, edge.first.side, s);
      const int to = side_point(patch, edge.first.side, s + 1);
      const int a = surface.grids.nodes[p][static_cast<std::size_t>(from)];
      const int b = surface.grids.nodes[p][static_cast<std::size_t>(to)];
      const double length = (surface.nodes_world[static_cast<std::size_t>(b)] -
                             surface.nodes_world[static_cast<std::size_t>(a)])
                                .norm();
      const int low = std::min(from, to);
      const Side side = edge.first.side;
      const int in = (side == Side::IMin || side == Side::IMax ? 1 : patch.ni) *
                     (side == Side::IMin || side == Side::JMin ? 1 : -1);
      const auto point = [&](int n) { return patch.points_world[static_cast<std::size_t>(n)]; };
      free.edges.push_back({a, b, length, cell_normal(patch, low % patch.ni, low / patch.ni),
                            point(from + in) - point(from)});
    }
    free.runs.push_back({begin, free.edges.size()});
  }
  return free;
}

double height(const Plane& plane, const Vec3& p) { return plane.normal.dot(p - plane.point_world); }

class Finder {
 public:
  Finder(const OpenSurface& surface, Free free) : surface_(surface), free_(std::move(free)) {
    for (const Vec3& node : surface.nodes_world) box_.add(node);
    tolerance_ = kOnPlane * box_.size();
  }

  Free& free() { return free_; }
  double tolerance() const { return tolerance_; }

  /// Length of free edges not taken yet that lie on the plane; 0 if that is not more than `least`,
  /// or if the wall crosses it or lies flat on it. Turns its normal towards the wall.
  double gain(Plane& plane, double least) const;
  /// Moves the plane to the middle of the nodes on it, and takes their edges.
  void take(Plane& plane);
  /// Planes worth a look.
  std::vector<Plane> guesses() const;
  /// How far the wall reaches to either side.
  std::array<double, 2> reach(const Plane& plane) const;

 private:
  const Vec3& node(int n) const { return surface_.nodes_world[static_cast<std::size_t>(n)]; }
  bool is_on(const Plane& plane, const FreeEdge& edge) const {
    return std::abs(height(plane, node(edge.a))) <= tolerance_ &&
           std::abs(height(plane, node(edge.b))) <= tolerance_;
  }
  Vec3 direction(const Run& run, double& straightness, Vec3& centre, Vec3& normal) const;

  const OpenSurface& surface_;
  Free free_;
  Box box_;
  double tolerance_ = 0;
};

std::array<double, 2> Finder::reach(const Plane& plane) const {
  std::array<double, 2> reach{0, 0};
  for (const Vec3& p : surface_.nodes_world) {
    const double h = height(plane, p);
    reach[0] = std::min(reach[0], h);
    reach[1] = std::max(reach[1], h);
  }
  return reach;
}

double Finder::gain(Plane& plane, double least) const {
  double gained = 0;
  double upright = 0;
  for (const FreeEdge& edge : free_.edges) {
    if (edge.taken || !is_on(plane, edge)) continue;
    gained += edge.length;
    upright += edge.length * std::abs(plane.normal.dot(edge.normal));
  }
  if (!(gained > least) || upright > kUpright * gained) return 0;
  const std::array<double, 2> sides = reach(plane);
  if (std::min(-sides[0], sides[1]) > tolerance_) return 0;
  if (-sides[0] > sides[1]) plane.normal = -plane.normal;
  return gained;
}

void Finder::take(Plane& plane) {
  std::vector<double> heights;
  for (FreeEdge& edge : free_.edges) {
    if (!is_on(plane, edge)) continue;
    edge.taken = true;
    heights.push_back(height(plane, node(edge.a)));
    heights.push_back(height(plane, node(edge.b)));
  }
  if (heights.empty()) return;
  const auto middle = heights.begin() + static_cast<std::ptrdiff_t>(heights.size() / 2);
  std::nth_element(heights.begin(), middle, heights.end());
  plane.point_world += *middle * plane.normal;
}

/// Main direction of a run's nodes; `straightness` is their largest distance from that line.
Vec3 Finder::direction(const Run& run, double& straightness, Vec3& centre, Vec3& normal) const {
  centre = Vec3::Zero();
  Vec3 mean = Vec3::Zero();
  const auto count = static_cast<double>(run.end - run.begin + 1);
  for (std::size_t e = run.begin; e < run.end; ++e) {
    centre += node(free_.edges[e].a);
    mean += free_.edges[e].length * free_.edges[e].normal;
  }
  centre = (centre + node(free_.edges[run.end - 1].b)) / count;
  Eigen::Matrix3d spread = Eigen::Matrix3d::Zero();
  const auto add = [&](int n) {
    const Vec3 d = node(n) - centre;
    spread += d * d.transpose();
  };
  for (std::size_t e = run.begin; e < run.end; ++e) add(free_.edges[e].a);
  add(free_.edges[run.end - 1].b);
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(spread);
  const Vec3 main = solver.eigenvectors().col(2);
  straightness = 0;
  for (std::size_t e = run.begin; e < run.end; ++e) {
    straightness = std::max(straightness, (node(free_.edges[e].a) - centre).cross(main).norm());
  }
  const bool is_straight = straightness <= tolerance_;
  // Across a straight run lies the plane that stands upright on the wall there.
  normal = is_straight ? Vec3(main.cross(mean)) : Vec3(solver.eigenvectors().col(0));
  normal = main.cross(mean).norm() > 0 || !is_straight ? Vec3(normal.normalized()) : Vec3::Zero();
  return main;
}

std::vector<Plane> Finder::guesses() const {
  std::vector<Plane> planes;
  const auto guess = [&](const Vec3& point, const Vec3& normal) {
    if (normal.norm() > 1e-6) planes.push_back({point, normal.normalized()});
  };
  Vec3List mains;
  Vec3List centres;
  for (const Run& run : free_.runs) {
    if (free_.edges[run.begin].taken && free_.edges[run.end - 1].taken) continue;
    double straightness = 0;
    Vec3 centre;
    Vec3 normal;
    mains.push_back(direction(run, straightness, centre, normal));
    centres.push_back(centre);
    for (int axis = 0; axis < 3; ++axis) {
      const double spread = std::abs(node(free_.edges[run.begin].a)[axis] - centre[axis]);
      if (spread <= tolerance_) guess(centre, Vec3::Unit(axis));
    }
    guess(centre, normal);
  }
  if (mains.size() > kMostRuns) return planes;
  for (std::size_t a = 0; a < mains.size(); ++a) {
    for (std::size_t b = a + 1; b < mains.size(); ++b) {
      const Vec3 between = (centres[b] - centres[a]).normalized();
      Vec3 normal = mains[a].cross(mains[b]);
      if (normal.norm() < 1e-3) normal = mains[a].cross(between);
      if (normal.norm() < 1e-3) continue;
      if (std::abs(normal.normalized().dot(centres[b] - centres[a])) > tolerance_) continue;
      guess(0.5 * (centres[a] + centres[b]), normal);
    }
  }
  return planes;
}

/// A closed loop of free edges around the flow is an opening; around the body, a symmetry plane.
std::string kind_of(const Finder& finder, const OpenSurface& surface, const Free& free,
                    const Plane& plane) {
  double area = 0;
  Vec3 closing = Vec3::Zero();
  double length = 0;
  for (const FreeEdge& edge : free.edges) {
    const Vec3& a = surface.nodes_world[static_cast<std::size_t>(edge.a)];
    const Vec3& b = surface.nodes_world[static_cast<std::size_t>(edge.b)];
    const bool on = std::abs(height(plane, a)) <= finder.tolerance() &&
                    std::abs(height(plane, b)) <= finder.tolerance();
    if (!on) continue;
    Vec3 across = (b - a).cross(plane.normal);
    if (across.dot(edge.normal) < 0) across = -across;
    area += (0.5 * (a + b) - plane.point_world).dot(across);
    closing += across;
    length += edge.length;
  }
  return closing.norm() < 1e-6 * length && area < 0 ? "opening" : "symmetry";
}

/// "symmetry", then "symmetry 2".
std::string free_name(const Boundaries& boundaries, const std::string& name) {
  const auto is_used = [&](const std::string& other) {
    return std::any_of(boundaries.list().begin(), boundaries.list().end(),
                       [&](const Boundary& boundary) { return boundary.name() == other; });
  };
  std::string unused = name;
  for (int n = 2; is_used(unused); ++n) unused = fmt::format("{} {}", name, n);
  return unused;
}

void find_planes(Finder& finder, const OpenSurface& surface, Ends& ends) {
  while (true) {
    Plane best;
    double most = 0;
    for (Plane plane : finder.guesses()) {
      const double gained = finder.gain(plane, most * (1 + 1e-9));
      if (gained == 0) continue;
      most = gained;
      best = plane;
    }
    if (!(most > 0)) return;
    finder.take(best);
    const std::string kind = kind_of(finder, surface, finder.free(), best);
    ends.boundaries.add({free_name(ends.boundaries, kind), best});
  }
}

void add_named_plane(Finder& finder, const NamedPlane& named, const OpenSurface& surface,
                     Ends& ends) {
  Plane plane = Boundary("", named.plane).plane();
  const std::array<double, 2> sides = finder.reach(plane);
  if (std::min(-sides[0], sides[1]) > finder.tolerance()) {
    throw InputError(fmt::format(
        "the boundary plane {} cuts the surface, which reaches {:g} to one side of it and {:g} to "
        "the other; all of the surface has to lie on one side",
        describe(plane), -sides[0], sides[1]));
  }
  if (-sides[0] > sides[1]) plane.normal = -plane.normal;
  Plane fitted = plane;
  finder.take(fitted);
  const std::string kind = kind_of(finder, surface, finder.free(), plane);
  ends.boundaries.add({named.name.empty() ? free_name(ends.boundaries, kind) : named.name, plane});
}

/// The shape with its normals towards the wall's cells at the free edges on it.
std::shared_ptr<const Wall> towards(const NamedShape& named, const OpenSurface& surface,
                                    const std::vector<const FreeEdge*>& rim) {
  SurfaceOptions plain;
  plain.open_edges = OpenEdges::Splay;
  const auto along = build_surface(named.patches, plain).wall;
  double inward = 0;
  for (const FreeEdge* edge : rim) {
    const Vec3& a = surface.nodes_world[static_cast<std::size_t>(edge->a)];
    const Vec3& b = surface.nodes_world[static_cast<std::size_t>(edge->b)];
    inward += along->closest(0.5 * (a + b)).normal.dot(edge->inward);
  }
  if (inward >= 0) return along;
  plain.side = MarchSide::Against;
  return build_surface(named.patches, plain).wall;
}

void add_named_shape(Finder& finder, const NamedShape& named, const OpenSurface& surface,
                     Ends& ends) {
  SurfaceOptions plain;
  plain.open_edges = OpenEdges::Splay;
  const auto shape = build_surface(named.patches, plain).wall;
  const auto miss = [&](const FreeEdge& edge) {
    const double a =
        shape->closest(surface.nodes_world[static_cast<std::size_t>(edge.a)]).distance_world;
    const double b =
        shape->closest(surface.nodes_world[static_cast<std::size_t>(edge.b)]).distance_world;
    return std::max(a, b) / edge.length;
  };
  std::vector<const FreeEdge*> rim;
  double least = std::numeric_limits<double>::infinity();
  for (FreeEdge& edge : finder.free().edges) {
    if (edge.taken || !(edge.length > 0)) continue;
    const double off = miss(edge);
    least = std::min(least, off);
    if (off > kOnShape) continue;
    edge.taken = true;
    rim.push_back(&edge);
  }
  if (rim.empty()) {
    throw InputError(fmt::format(
        "no free edge of the surface lies on the boundary '{}': the nearest is {:g} of its own "
        "length away, and {:g} would do",
        named.name, least, kOnShape));
  }
  ends.boundaries.add({named.name, towards(named, surface, rim)});
  const BoundarySet bit = BoundarySet{1} << (ends.boundaries.list().size() - 1);
  for (const FreeEdge* edge : rim) {
    ends.on[static_cast<std::size_t>(edge->a)] |= bit;
    ends.on[static_cast<std::size_t>(edge->b)] |= bit;
  }
}

/// Nodes of free edges on the planes.
void mark_planes(const Finder& finder, const Free& free, const OpenSurface& surface, Ends& ends) {
  for (const FreeEdge& edge : free.edges) {
    for (std::size_t b = 0; b < ends.boundaries.list().size(); ++b) {
      const Boundary& boundary = ends.boundaries.list()[b];
      if (!boundary.is_plane()) continue;
      for (const int n : {edge.a, edge.b}) {
        const auto at = static_cast<std::size_t>(n);
        const double away = std::abs(boundary.side(surface.nodes_world[at]));
        if (away <= finder.tolerance()) ends.on[at] |= BoundarySet{1} << b;
      }
    }
  }
}

/// Names the sides that are open and on no boundary.
[[noreturn]] void refuse(const OpenSurface& surface, const Topology& ended) {
  constexpr std::size_t kShown = 6;
  std::vector<std::string> sides;
  for (const Edge& edge : ended.edges) {
    if (edge.kind != EdgeKind::Free || edge.boundary >= 0) continue;
    sides.push_back(side_name(surface.grids.patches, edge.first));
  }
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
  return fmt::format("{}, side {}, points {} to {}",
                     name_of(patches[static_cast<std::size_t>(range.patch)], range.patch),
                     kNames[static_cast<std::size_t>(range.side)], range.begin + 1, range.end + 1);
}

Ends find_boundaries(const OpenSurface& surface, const SurfaceOptions& options) {
  Ends ends;
  ends.on.assign(surface.nodes_world.size(), 0);
  Finder finder(surface, free_edges(surface));
  for (const NamedPlane& named : options.planes) add_named_plane(finder, named, surface, ends);
  for (const NamedShape& named : options.shapes) add_named_shape(finder, named, surface, ends);
  if (options.open_edges != OpenEdges::Splay) find_planes(finder, surface, ends);
  mark_planes(finder, finder.free(), surface, ends);
  if (options.open_edges == OpenEdges::Refuse) {
    const Topology ended = build_topology(surface.grids.patches, surface.grids.nodes, ends.on);
    const bool left = std::any_of(ended.edges.begin(), ended.edges.end(), [](const Edge& edge) {
      return edge.kind == EdgeKind::Free && edge.boundary < 0;
    });
    if (left) refuse(surface, ended);
  }
  for (std::size_t n = 0; n < ends.on.size(); ++n) {
    if (ends.on[n] == 0) continue;
    const Vec3 held = ends.boundaries.hold(ends.on[n], surface.nodes_world[n]);
    ends.moved_max_world = std::max(ends.moved_max_world, (held - surface.nodes_world[n]).norm());
    surface.nodes_world[n] = held;
  }
  return ends;
}

}  // namespace vdb_offset
