#include "surface/stars.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <deque>
#include <numeric>

#include "surface/sharp_edges.h"
#include "surface/topology.h"

namespace vdb_offset {

namespace {

// Cosine between two sectors' normals below which there is no way from one to the other.
constexpr double kOpposite = -0.9998;
// Determinant of a corner's three normals above which it is one.
constexpr double kSolid = 0.02;

std::size_t at(int index) { return static_cast<std::size_t>(index); }

/// Sets of patch points at one node that hang together other than across a sharp edge.
class Sectors {
 public:
  explicit Sectors(const Surface& surface) {
    std::size_t count = 0;
    for (const Patch& patch : surface.patches) {
      first_.push_back(count);
      count += patch.points_world.size();
    }
    parent_.resize(count);
    std::iota(parent_.begin(), parent_.end(), std::size_t{0});
  }
  std::size_t root(const PatchPoint& point) {
    std::size_t a = first_[at(point.patch)] + at(point.index);
    while (parent_[a] != a) a = parent_[a] = parent_[parent_[a]];
    return a;
  }
  void join(const PatchPoint& a, const PatchPoint& b) { parent_[root(a)] = root(b); }

 private:
  std::vector<std::size_t> first_;  // of each patch
  std::vector<std::size_t> parent_;
};

/// Sum of the normals of the wall's triangles at one point of one patch, weighted by angle.
Vec3 normal_at(const Patch& patch, int index) {
  constexpr std::array<std::array<int, 2>, 4> kRound{{{0, 0}, {1, 0}, {1, 1}, {0, 1}}};
  const int i = index % patch.ni;
  const int j = index / patch.ni;
  Vec3 sum = Vec3::Zero();
  for (std::size_t c = 0; c < 4; ++c) {
    const int ci = i - kRound[c][0];
    const int cj = j - kRound[c][1];
    if (ci < 0 || cj < 0 || ci + 1 >= patch.ni || cj + 1 >= patch.nj) continue;
    const auto corner = [&](std::size_t n) -> const Vec3& {
      return patch.at(ci + kRound[n % 4][0], cj + kRound[n % 4][1]);
    };
    const Vec3 centre = 0.25 * (corner(0) + corner(1) + corner(2) + corner(3)) - corner(c);
    const std::array<Vec3, 3> ray{corner(c + 1) - corner(c), centre, corner(c + 3) - corner(c)};
    for (std::size_t r = 0; r < 2; ++r) {
      const Vec3 area = ray[r].cross(ray[r + 1]);
      const double length = area.norm();
      if (length > 0) sum += std::atan2(length, ray[r].dot(ray[r + 1])) / length * area;
    }
  }
  return sum;
}

struct Marks {
  std::vector<char> free;
  std::vector<char> closed;  // on a concave edge or a pole
};

Marks mark_nodes(const Surface& surface, const Topology& topology) {
  Marks marks{std::vector<char>(surface.nodes_world.size(), 0), concave_nodes(surface, topology)};
  for (const Edge& edge : topology.edges) {
    if (edge.kind == EdgeKind::Interface) continue;
    for (int s = 0; s <= edge.first.cells(); ++s) {
      const int node = run_node(surface, {&edge, {}}, s);
      (edge.kind == EdgeKind::Free ? marks.free : marks.closed)[at(node)] = 1;
    }
  }
  return marks;
}

void find_runs(const Surface& surface, const Topology& topology, Stars& stars, Sectors& sectors) {
  for (const Edge& edge : topology.edges) {
    if (edge.kind != EdgeKind::Interface) continue;
    SharpRun run{&edge, {}};
    for (int s = 0; s < edge.first.cells(); ++s) {
      // On an internal surface two columns would have one way out.
      const bool sharp = edge.boundary < 0 && is_sharp(turn_across(surface.patches, edge, s));
      run.sharp.push_back(sharp ? 1 : 0);
      for (const int end : {s, s + 1}) {
        if (sharp) {
          int& star = stars.of_node[at(run_node(surface, run, end))];
          if (star < 0) {
            star = static_cast<int>(stars.list.size());
            stars.list.emplace_back().node = run_node(surface, run, end);
          }
          ++stars.list[at(star)].degree;
        } else {
          const auto [a, b] = run_points(surface, run, end);
          sectors.join(a, b);
        }
      }
    }
    if (std::ranges::count(run.sharp, 1) > 0) stars.runs.push_back(std::move(run));
  }
}

void add_points(const Surface& surface, Stars& stars, Sectors& sectors) {
  std::vector<std::vector<std::size_t>> roots(stars.list.size());
  for (std::size_t p = 0; p < surface.patches.size(); ++p) {
    for (std::size_t n = 0; n < surface.patch_nodes[p].size(); ++n) {
      const int index = stars.of_node[at(surface.patch_nodes[p][n])];
      if (index < 0) continue;
      Star& star = stars.list[at(index)];
      const PatchPoint point{static_cast<int>(p), static_cast<int>(n)};
      const std::size_t root = sectors.root(point);
      auto& known = roots[at(index)];
      const auto found = std::find(known.begin(), known.end(), root);
      const auto sector = static_cast<std::size_t>(found - known.begin());
      if (found == known.end()) {
        known.push_back(root);
        star.normals.push_back(Vec3::Zero());
      }
      star.points.push_back(point);
      star.sector_of.push_back(sector);
      star.normals[sector] += normal_at(surface.patches[p], point.index);
    }
  }
}

/// Normals of unit length, within the boundaries that the node lies on; false if there is none.
bool finish_normals(const Surface& surface, Star& star) {
  const BoundarySet on = surface.boundaries_of(at(star.node));
  const Vec3& place = surface.nodes_world[at(star.node)];
  bool all = true;
  for (Vec3& normal : star.normals) {
    if (on != 0) normal = surface.boundaries->along(on, place, normal);
    all = all && normal.norm() > 0;
    normal.normalize();
  }
  return all;
}

Opening opening_of(Star& star, bool with_corners) {
  const std::size_t sectors = star.normals.size();
  const bool ends_open = star.free && star.degree == 1;
  const bool goes_on = !star.free && star.degree == 2;
  if (sectors == 2 && (ends_open || goes_on)) {
    return star.normals[0].dot(star.normals[1]) > kOpposite ? Opening::Row : Opening::Closed;
  }
  if (!with_corners || star.free || star.degree != 3 || sectors != 3) return Opening::Closed;
  const double solid = star.normals[0].cross(star.normals[1]).dot(star.normals[2]);
  return std::abs(solid) > kSolid ? Opening::Corner : Opening::Closed;
}

/// How far along sharp edges each star is from a closed one.
void count_steps(const Surface& surface, Stars& stars) {
  std::vector<std::vector<int>> next(stars.list.size());
  for (const SharpRun& run : stars.runs) {
    for (int s = 0; s < run.edge->first.cells(); ++s) {
      if (run.sharp[at(s)] == 0) continue;
      const int a = stars.of_node[at(run_node(surface, run, s))];
      const int b = stars.of_node[at(run_node(surface, run, s + 1))];
      next[at(a)].push_back(b);
      next[at(b)].push_back(a);
    }
  }
  std::deque<int> queue;
  for (std::size_t n = 0; n < stars.list.size(); ++n) {
    if (stars.list[n].opening != Opening::Closed) continue;
    stars.list[n].steps = 0;
    queue.push_back(static_cast<int>(n));
  }
  while (!queue.empty()) {
    const int from = queue.front();
    queue.pop_front();
    for (const int to : next[at(from)]) {
      Star& star = stars.list[at(to)];
      if (star.steps != std::numeric_limits<int>::max()) continue;
      star.steps = stars.list[at(from)].steps + 1;
      // A corner is open all the way: what closes beyond it is no matter here.
      if (star.opening == Opening::Row) queue.push_back(to);
    }
  }
}

}  // namespace

std::pair<PatchPoint, PatchPoint> run_points(const Surface& surface, const SharpRun& run, int s) {
  const SideRange& first = run.edge->first;
  const SideRange& second = run.edge->second;
  const int other = second.end > second.begin ? second.begin + s : second.begin - s;
  return {{first.patch, side_point(surface.patches[at(first.patch)], first.side, first.begin + s)},
          {second.patch, side_point(surface.patches[at(second.patch)], second.side, other)}};
}

int run_node(const Surface& surface, const SharpRun& run, int s) {
  const SideRange& side = run.edge->first;
  const int point = side_point(surface.patches[at(side.patch)], side.side, side.begin + s);
  return surface.patch_nodes[at(side.patch)][at(point)];
}

Stars find_stars(const Surface& surface, const Topology& topology, bool with_corners) {
  Stars stars;
  stars.of_node.assign(surface.nodes_world.size(), -1);
  Sectors sectors(surface);
  find_runs(surface, topology, stars, sectors);
  if (stars.list.empty()) return stars;
  add_points(surface, stars, sectors);
  const Marks marks = mark_nodes(surface, topology);
  for (Star& star : stars.list) {
    star.free = marks.free[at(star.node)] != 0;
    if (!finish_normals(surface, star) || marks.closed[at(star.node)] != 0) continue;
    star.opening = opening_of(star, with_corners);
  }
  count_steps(surface, stars);
  return stars;
}

}  // namespace vdb_offset
