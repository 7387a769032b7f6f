// A plane may hold several openings of the flow: the inlet and the outlet of a bend that comes
// back. Each is a loop of free edges that closes around the flow, with the loops of bodies within
// it. Where walls are open along another plane too, or in two dimensions, edges make no loops:
// there the walls that face each other over the flow are one opening, and parts of loops that are
// closed along the lines of other planes.

#include "surface/plane_parts.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <set>
#include <utility>

#include "surface/plane_chains.h"

namespace vdb_offset {

namespace {

using Edges = std::vector<std::size_t>;

constexpr double kSameLength = 1e-9;     // relative: sums in another order
constexpr double kBay = 0.25;            // of the smaller opening's size
constexpr std::size_t kMostChains = 24;  // beyond it they are not compared in pairs

/// In the plane's own two coordinates; of a flat surface along its line alone.
class InPlane {
 public:
  InPlane(const PlaneFinder& finder, const Plane& plane) : finder_(finder) {
    u_ = finder.is_flat() ? Vec3(Vec3::UnitZ().cross(plane.normal)) : plane.normal.unitOrthogonal();
    v_ = finder.is_flat() ? Vec3(Vec3::Zero()) : Vec3(plane.normal.cross(u_));
  }

  Eigen::Vector2d of(const Vec3& p) const { return {u_.dot(p), v_.dot(p)}; }
  Eigen::Vector2d node(int n) const { return of(finder_.node(n)); }

  double distance(const Eigen::Vector2d& p, std::size_t e) const {
    const Eigen::Vector2d a = node(finder_.edges()[e].a);
    const Eigen::Vector2d ab = node(finder_.edges()[e].b) - a;
    const double square = ab.squaredNorm();
    const double part = square > 0 ? std::clamp((p - a).dot(ab) / square, 0.0, 1.0) : 0;
    return (a + part * ab - p).norm();
  }
  /// Least distance from nodes of the one to edges of the other.
  double distance(const Edges& from, const Edges& to) const {
    double least = std::numeric_limits<double>::infinity();
    for (const std::size_t f : from) {
      const Eigen::Vector2d p = node(finder_.edges()[f].a);
      for (const std::size_t t : to) least = std::min(least, distance(p, t));
    }
    return least;
  }
  bool is_within(const Eigen::Vector2d& p, const PlanePart& part) const {
    bool is_in = false;
    const auto pass = [&](const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
      if (finder_.is_flat()) {
        is_in = is_in != (a.x() > 0);
      } else if ((a.y() > 0) != (b.y() > 0)) {
        is_in = is_in != ((a.x() * b.y() - b.x() * a.y()) / (b.y() - a.y()) > 0);
      }
    };
    for (const std::size_t e : part.edges) {
      pass(node(finder_.edges()[e].a) - p, node(finder_.edges()[e].b) - p);
    }
    for (const auto& [a, b] : part.closing_world) pass(of(a) - p, of(b) - p);
    return is_in;
  }
  Eigen::AlignedBox2d box(const Edges& edges) const {
    Eigen::AlignedBox2d box;
    for (const std::size_t e : edges) {
      box.extend(node(finder_.edges()[e].a));
      box.extend(node(finder_.edges()[e].b));
    }
    return box;
  }

 private:
  const PlaneFinder& finder_;
  Vec3 u_, v_;
};

void join(Edges& to, const Edges& from) { to.insert(to.end(), from.begin(), from.end()); }

/// Its length and its centre.
void measure(const PlaneFinder& finder, PlanePart& part) {
  Box box;
  part.length_world = 0;
  for (const std::size_t e : part.edges) {
    const FreeEdge& edge = finder.edges()[e];
    part.length_world += edge.length;
    box.add(finder.node(edge.a));
    box.add(finder.node(edge.b));
  }
  part.centre_world = 0.5 * (box.lo + box.hi);
  if (finder.is_flat()) part.centre_world.z() = 0;
}

PlanePart make_part(const PlaneFinder& finder, Edges edges, bool is_opening) {
  PlanePart part{std::move(edges), is_opening};
  measure(finder, part);
  return part;
}

/// Loops of bodies go with the smallest loop around the flow that they lie in.
void put_into_openings(const PlaneFinder& finder, const Plane& plane,
                       std::vector<EdgeChain>& chains, std::vector<PlanePart>& openings) {
  const InPlane in_plane(finder, plane);
  const std::size_t outer = openings.size();
  const std::vector<PlanePart> rims = openings;
  std::vector<double> areas;
  for (const PlanePart& rim : rims) areas.push_back(in_plane.box(rim.edges).volume());
  std::erase_if(chains, [&](const EdgeChain& chain) {
    if (!chain.is_loop) return false;
    const Eigen::Vector2d p = in_plane.node(finder.edges()[chain.edges.front()].a);
    std::size_t best = outer;
    for (std::size_t o = 0; o < outer; ++o) {
      const bool is_less = best == outer || areas[o] < areas[best];
      if (is_less && in_plane.is_within(p, rims[o])) best = o;
    }
    if (best == outer) return false;
    join(openings[best].edges, chain.edges);
    return true;
  });
}

/// Faces all of whose chains there are become openings, or else the parts that are returned: walls
/// that are cut by the plane are no pair.
std::vector<PlanePart> take_faces(const PlaneFinder& finder, const std::vector<CutFace>& faces,
                                  std::vector<EdgeChain>& chains,
                                  std::vector<PlanePart>& openings) {
  std::vector<PlanePart> cuts;
  for (const CutFace& face : faces) {
    const std::set<std::size_t> of_face(face.edges.begin(), face.edges.end());
    const auto is_part = [&](const EdgeChain& chain) {
      return of_face.contains(chain.edges.front());
    };
    std::size_t there = 0;
    for (const EdgeChain& chain : chains) there += is_part(chain) ? chain.edges.size() : 0;
    if (there != of_face.size()) continue;
    std::erase_if(chains, is_part);
    PlanePart part = make_part(finder, face.edges, face.is_opening);
    for (const CutFace::Chord& chord : face.chords) part.closing_world.push_back(chord.ends_world);
    (face.is_opening ? openings : cuts).push_back(std::move(part));
  }
  return cuts;
}

/// The two chains nearest to each other between which the flow passes.
std::optional<std::pair<std::size_t, std::size_t>> nearest_pair(
    const PlaneFinder& finder, const Plane& plane, const std::vector<EdgeChain>& chains) {
  const InPlane in_plane(finder, plane);
  double least = std::numeric_limits<double>::infinity();
  std::optional<std::pair<std::size_t, std::size_t>> found;
  for (std::size_t a = 0; a < chains.size(); ++a) {
    for (std::size_t b = a + 1; b < chains.size(); ++b) {
      Edges both = chains[a].edges;
      join(both, chains[b].edges);
      if (!finder.rim_of(plane, both).is_opening()) continue;
      const double apart = in_plane.distance(chains[a].edges, chains[b].edges);
      if (!(apart < least)) continue;
      least = apart;
      found = {a, b};
    }
  }
  return found;
}

/// Walls that face each other over the flow, where all that there are close around it: between two
/// bodies on a plane of symmetry is no opening.
void pair_chains(const PlaneFinder& finder, const Plane& plane, std::vector<EdgeChain>& chains,
                 std::vector<PlanePart>& openings) {
  Edges all;
  for (const EdgeChain& chain : chains) join(all, chain.edges);
  if (chains.size() > kMostChains || !finder.rim_of(plane, all).is_opening()) return;
  while (const auto pair = nearest_pair(finder, plane, chains)) {
    join(chains[pair->first].edges, chains[pair->second].edges);
    openings.push_back(make_part(finder, std::move(chains[pair->first].edges), true));
    chains.erase(chains.begin() + static_cast<std::ptrdiff_t>(pair->second));
    chains.erase(chains.begin() + static_cast<std::ptrdiff_t>(pair->first));
  }
}

}  // namespace

bool comes_before(const PlanePart& a, const PlanePart& b) {
  const double near = kSameLength * std::max(a.length_world, b.length_world);
  if (std::abs(a.length_world - b.length_world) > near) return a.length_world > b.length_world;
  for (int axis = 0; axis < 3; ++axis) {
    const double apart = a.centre_world[axis] - b.centre_world[axis];
    if (std::abs(apart) > near) return apart < 0;
  }
  return false;
}

std::vector<PlanePart> parts_in(const PlaneFinder& finder, const Plane& plane,
                                const std::vector<std::size_t>& edges, const CutFaces& cut) {
  std::vector<EdgeChain> chains = chains_of(finder, edges);
  std::vector<PlanePart> parts;
  std::erase_if(chains, [&](EdgeChain& chain) {
    if (!chain.is_loop || !finder.rim_of(plane, chain.edges).is_opening()) return false;
    parts.push_back(make_part(finder, std::move(chain.edges), true));
    return true;
  });
  std::vector<PlanePart> cuts = take_faces(finder, cut.faces, chains, parts);
  put_into_openings(finder, plane, chains, parts);
  if (!cut.is_mirror) pair_chains(finder, plane, chains, parts);
  for (PlanePart& part : parts) measure(finder, part);
  for (EdgeChain& chain : chains) cuts.push_back(make_part(finder, std::move(chain.edges), false));
  parts.insert(parts.end(), cuts.begin(), cuts.end());
  std::ranges::stable_sort(parts, comes_before);
  return parts;
}

std::vector<PlanePart> boundaries_in(const PlaneFinder& finder, const Plane& plane,
                                     std::vector<PlanePart> parts) {
  const InPlane in_plane(finder, plane);
  const auto is_bay = [&](const PlanePart& a, const PlanePart& b) {
    const Eigen::AlignedBox2d around_a = in_plane.box(a.edges);
    const Eigen::AlignedBox2d around_b = in_plane.box(b.edges);
    const double near = kBay * std::min(around_a.diagonal().norm(), around_b.diagonal().norm());
    return around_a.exteriorDistance(around_b) < near && in_plane.distance(a.edges, b.edges) < near;
  };
  std::vector<PlanePart> openings;
  Edges rest;
  for (PlanePart& part : parts) {
    if (!part.is_opening) {
      join(rest, part.edges);
      continue;
    }
    for (auto beside = openings.begin(); beside != openings.end();) {
      const bool is_one = is_bay(*beside, part);
      if (is_one) join(part.edges, beside->edges);
      beside = is_one ? openings.erase(beside) : beside + 1;
    }
    openings.push_back(make_part(finder, std::move(part.edges), true));
  }
  std::ranges::stable_sort(openings, comes_before);
  if (!rest.empty()) openings.push_back(make_part(finder, std::move(rest), false));
  return openings;
}

double distance_to(const PlaneFinder& finder, const Plane& plane, const PlanePart& part,
                   const Vec3& point_world) {
  const InPlane in_plane(finder, plane);
  const Eigen::Vector2d p = in_plane.of(point_world);
  if (part.is_opening && in_plane.is_within(p, part)) return 0;
  double least = std::numeric_limits<double>::infinity();
  for (const std::size_t e : part.edges) least = std::min(least, in_plane.distance(p, e));
  return least;
}

}  // namespace vdb_offset
