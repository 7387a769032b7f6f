// A plane that the whole wall lies on one side of needs no more than that. Where the wall passes it
// elsewhere, as a bend that comes round again does, only what is closed bounds the flow: loops of
// free edges. The edge of a sheet is no loop, and the base of a body is one around the body.

#include "surface/find_openings.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numeric>

#include "surface/plane_chains.h"
#include "surface/round_runs.h"

namespace vdb_offset {

namespace {

using Edges = std::vector<std::size_t>;

/// Edges not taken yet that hang together, where each node has two of them.
std::vector<Edges> closed_loops(const PlaneFinder& finder) {
  const std::vector<FreeEdge>& edges = finder.edges();
  std::map<int, Edges> at_node;
  for (std::size_t e = 0; e < edges.size(); ++e) {
    if (edges[e].taken || edges[e].a == edges[e].b) continue;
    at_node[edges[e].a].push_back(e);
    at_node[edges[e].b].push_back(e);
  }
  std::vector<bool> seen(edges.size(), false);
  std::vector<Edges> loops;
  for (const auto& [node, first] : at_node) {
    if (seen[first.front()]) continue;
    Edges loop{first.front()};
    seen[first.front()] = true;
    bool is_closed = true;
    for (std::size_t n = 0; n < loop.size(); ++n) {
      for (const int end : {edges[loop[n]].a, edges[loop[n]].b}) {
        is_closed = is_closed && at_node[end].size() == 2;
        for (const std::size_t next : at_node[end]) {
          if (!seen[next]) loop.push_back(next);
          seen[next] = true;
        }
      }
    }
    if (is_closed) loops.push_back(std::move(loop));
  }
  return loops;
}

double height(const Plane& plane, const Vec3& p) { return plane.normal.dot(p - plane.point_world); }

bool is_on(const PlaneFinder& finder, const Plane& plane, const Edges& loop) {
  return std::ranges::all_of(loop, [&](std::size_t e) {
    const FreeEdge& edge = finder.edges()[e];
    return std::abs(height(plane, finder.node(edge.a))) <= finder.tolerance() &&
           std::abs(height(plane, finder.node(edge.b))) <= finder.tolerance();
  });
}

/// How far the wall goes up from the plane at a loop, altogether.
double rise(const PlaneFinder& finder, const Plane& plane, const Edges& loop) {
  double sum = 0;
  for (const std::size_t e : loop) sum += finder.edges()[e].inward.dot(plane.normal);
  return sum;
}

/// The plane that fits a loop best, towards the wall.
Plane fit(const PlaneFinder& finder, const Edges& loop) {
  Plane plane;
  for (const std::size_t e : loop) {
    const FreeEdge& edge = finder.edges()[e];
    plane.point_world +=
        0.5 / static_cast<double>(loop.size()) * (finder.node(edge.a) + finder.node(edge.b));
  }
  Eigen::Matrix3d spread = Eigen::Matrix3d::Zero();
  for (const std::size_t e : loop) {
    const Vec3 off = finder.node(finder.edges()[e].a) - plane.point_world;
    spread += off * off.transpose();
  }
  plane.normal = Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(spread).eigenvectors().col(0);
  if (rise(finder, plane, loop) < 0) plane.normal = -plane.normal;
  // As it is found elsewhere: 0 where files say 1e-18.
  for (int axis = 0; axis < 3; ++axis) {
    const bool is_zero = std::abs(plane.point_world[axis]) <= 1e-6 * finder.tolerance();
    if (std::abs(plane.normal[axis]) > 1 - 1e-12 && is_zero) plane.point_world[axis] = 0;
  }
  return plane;
}

/// Whether edges of a chain do not lie on one line: any plane through that would do.
bool is_plane_known(const PlaneFinder& finder, const Edges& edges) {
  std::vector<std::array<int, 2>> ends;
  for (const std::size_t e : edges) ends.push_back({finder.edges()[e].a, finder.edges()[e].b});
  return lines_of(finder.nodes(), ends, 1, finder.tolerance()).size() > 1;
}

}  // namespace

std::vector<Opening> find_cut_openings(const PlaneFinder& finder, std::vector<CutPlane> planes) {
  Edges left;
  for (std::size_t e = 0; e < finder.edges().size(); ++e) {
    if (!finder.edges()[e].taken && finder.edges()[e].length > 0) left.push_back(e);
  }
  std::vector<EdgeChain> chains = chains_of(finder, left);
  std::erase_if(chains, [&](const EdgeChain& chain) {
    return chain.is_loop || !is_plane_known(finder, chain.edges);
  });
  std::vector<Opening> openings;
  for (std::size_t first = 0; first < chains.size(); ++first) {
    const Plane plane = fit(finder, chains[first].edges);
    planes.push_back({plane, {}});
    for (EdgeChain& chain : chains) {
      const bool is_part =
          is_on(finder, plane, chain.edges) && rise(finder, plane, chain.edges) > 0;
      if (!is_part) continue;
      planes.back().edges.insert(planes.back().edges.end(), chain.edges.begin(), chain.edges.end());
    }
    for (const CutFace& face : faces_closed_by_images(finder, planes)) {
      const bool is_new = face.edges.front() == chains[first].edges.front();
      if (is_new && finder.stands_up(plane, face.edges)) openings.push_back({plane, face.edges});
    }
    planes.pop_back();
  }
  return openings;
}

std::vector<Opening> find_openings(const PlaneFinder& finder) {
  std::vector<Edges> loops = closed_loops(finder);
  std::vector<Opening> openings;
  for (std::size_t first = 0; first < loops.size(); ++first) {
    if (loops[first].empty()) continue;
    Opening opening{fit(finder, loops[first]), {}};
    if (!is_on(finder, opening.plane, loops[first])) continue;
    // The rim of a hub goes with that of its casing.
    for (std::size_t n = first; n < loops.size(); ++n) {
      const bool is_part = !loops[n].empty() && is_on(finder, opening.plane, loops[n]) &&
                           rise(finder, opening.plane, loops[n]) > 0;
      if (!is_part) continue;
      opening.edges.insert(opening.edges.end(), loops[n].begin(), loops[n].end());
      loops[n].clear();
    }
    if (finder.is_opening(opening.plane, opening.edges)) openings.push_back(std::move(opening));
  }
  return openings;
}

}  // namespace vdb_offset
