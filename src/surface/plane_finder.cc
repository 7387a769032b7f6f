// Planes are guessed from the free edges: each straight run of them lies in the plane through it
// that stands upright on the wall, each curved one in the plane that fits it best, and two runs
// that share a plane find it together. A guess is good if the whole wall lies on one side of it and
// stands up from it; the one that takes up the most edges comes first. None is good that a smooth
// curve soon leaves: any short piece of one lies near some plane. Nor is that of a hole in the
// wall, which goes on within it there, or that of a slit, as a T-junction is one. Two straight
// lines often lie in a plane that means nothing: sectors end on planes through their axis.

#include "surface/plane_finder.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "surface/topology.h"

namespace vdb_offset {

namespace {

// The wall stands up from a plane that is found at 45 degrees or more, a little less for rounding.
constexpr double kUpright = 0.708;
// At no edge it lies within 3 degrees of one, but for one hundredth of the length.
constexpr double kFlat = 0.9986;
constexpr double kFlatPart = 0.01;
constexpr double kSmooth = 0.94;  // cosine of 20 degrees: less of a turn is no corner
// In two dimensions some two ends always lie on a line: the wall stands up from it at 60 degrees.
constexpr double kUprightEnd = 0.5;
constexpr double kBends =
    0.7;  // cosine of the least angle between cells that is an edge of the wall
constexpr double kSame = 1e-9;  // lengths, relative; components of unit normals

Vec3 cell_normal(const Patch& patch, int i, int j) {
  const int a = std::clamp(i, 0, patch.ni - 2);
  const int b = std::clamp(j, 0, patch.nj - 2);
  const Vec3 normal =
      (patch.at(a + 1, b + 1) - patch.at(a, b)).cross(patch.at(a, b + 1) - patch.at(a + 1, b));
  const double length = normal.norm();
  return length > 0 ? Vec3(normal / length) : Vec3(Vec3::Zero());
}

/// The normal at a rim that a cell of a height is on, `next` those of the cell behind it.
Vec3 extended(const Vec3& normal, double height, const Vec3& next, double next_height) {
  const Vec3 axis = next.cross(normal);
  const double sine = axis.norm();
  const double cosine = next.dot(normal);
  if (cosine < kBends || !(sine > 0) || !(height > 0)) return normal;
  const double turn = std::atan2(sine, cosine) * height / (height + next_height);
  return Eigen::AngleAxisd(turn, axis / sine) * normal;
}

/// Of the two diagonals of a face of a patch of polygons.
Vec3 face_normal(const Patch& patch, const std::array<int, 4>& face) {
  const auto point = [&](std::size_t c) {
    return patch.points_world[static_cast<std::size_t>(face[c])];
  };
  const Vec3 normal = (point(2) - point(0)).cross(point(3) - point(1));
  const double length = normal.norm();
  return length > 0 ? Vec3(normal / length) : Vec3(Vec3::Zero());
}

Vec3 face_centre(const Patch& patch, const std::array<int, 4>& face) {
  const int corners = face[2] == face[3] ? 3 : 4;
  Vec3 sum = Vec3::Zero();
  for (int c = 0; c < corners; ++c) {
    sum += patch.points_world[static_cast<std::size_t>(face[static_cast<std::size_t>(c)])];
  }
  return sum / corners;
}

double height(const Plane& plane, const Vec3& p) { return plane.normal.dot(p - plane.point_world); }

/// Of planes that take up the same length those across an axis come first, x before y before z,
/// then lower places before higher: their order is no matter of that of the patches.
bool comes_before(const Plane& a, const Plane& b, double tolerance) {
  if (is_along_axis(a) != is_along_axis(b)) return is_along_axis(a);
  for (int axis = 0; axis < 3; ++axis) {
    const double more = std::abs(a.normal[axis]) - std::abs(b.normal[axis]);
    if (std::abs(more) > kSame) return more > 0;
  }
  Eigen::Index main = 0;
  a.normal.cwiseAbs().maxCoeff(&main);
  const Vec3 normal = a.normal[main] < 0 ? Vec3(-a.normal) : a.normal;
  return normal.dot(a.point_world - b.point_world) < -tolerance;
}

}  // namespace

bool is_along_axis(const Plane& plane) {
  Eigen::Index main = 0;
  plane.normal.cwiseAbs().maxCoeff(&main);
  return (plane.normal.cwiseAbs() - Vec3::Unit(main)).norm() <= kSame;
}

PlaneFinder::PlaneFinder(const OpenSurface& surface)
    : nodes_(surface.nodes_world), grids_(surface.grids), is_flat_(surface.is_flat) {
  Box box;
  for (const Vec3& node : nodes_) box.add(node);
  tolerance_ = kOnPlane * box.size();
  for (const Edge& edge : surface.topology.edges) {
    if (edge.kind == EdgeKind::Free) add_run(surface, edge);
  }
  for (std::size_t e = 0; e < edges_.size(); ++e) {
    for (const int end : {edges_[e].a, edges_[e].b}) edges_at_[end].push_back(e);
  }
}

void PlaneFinder::add_rim(const OpenSurface& surface, const SideRange& range) {
  const auto p = static_cast<std::size_t>(range.patch);
  const Patch& patch = surface.grids.patches[p];
  const std::size_t begin = edges_.size();
  for (auto r = static_cast<std::size_t>(range.begin); r < static_cast<std::size_t>(range.end);
       ++r) {
    const auto node_of = [&](int n) { return surface.grids.nodes[p][static_cast<std::size_t>(n)]; };
    const int a = node_of(patch.rim.points[r]);
    const int b = node_of(patch.rim.points[r + 1]);
    const std::array<int, 4>& face = patch.faces[static_cast<std::size_t>(patch.rim.faces[r])];
    const Vec3 normal = face_normal(patch, face);
    edges_.push_back({a, b, (node(b) - node(a)).norm(), normal,
                      face_centre(patch, face) - 0.5 * (node(a) + node(b)), normal});
  }
  runs_.push_back({begin, edges_.size()});
  // It may go round corners; a plane through one edge says nothing.
  for (std::size_t first = begin; first < edges_.size();) {
    std::size_t last = first + 1;
    while (last < edges_.size() && is_smooth(edges_[last - 1], edges_[last])) ++last;
    const bool is_all = first == begin && last == edges_.size();
    if (last > first + 1 && !is_all) runs_.push_back({first, last});
    first = last;
  }
}

/// Whether one edge of a rim goes on as the next without a corner.
bool PlaneFinder::is_smooth(const FreeEdge& edge, const FreeEdge& next) const {
  const Vec3 here = node(edge.b) - node(edge.a);
  const Vec3 there = node(next.b) - node(next.a);
  return here.dot(there) > kSmooth * edge.length * next.length;
}

void PlaneFinder::add_run(const OpenSurface& surface, const Edge& edge) {
  const auto p = static_cast<std::size_t>(edge.first.patch);
  const Patch& patch = surface.grids.patches[p];
  if (!patch.is_grid()) return add_rim(surface, edge.first);
  const Side side = edge.first.side;
  const int in = (side == Side::IMin || side == Side::IMax ? 1 : patch.ni) *
                 (side == Side::IMin || side == Side::JMin ? 1 : -1);
  const int rows = side == Side::IMin || side == Side::IMax ? patch.ni : patch.nj;
  const auto point = [&](int n) { return patch.points_world[static_cast<std::size_t>(n)]; };
  const auto node_of = [&](int n) { return surface.grids.nodes[p][static_cast<std::size_t>(n)]; };
  const std::size_t begin = edges_.size();
  for (int s = edge.first.begin; s < edge.first.end; ++s) {
    const int from = side_point(patch, side, s);
    const int to = side_point(patch, side, s + 1);
    const int a = node_of(from);
    const int b = node_of(to);
    const int low = std::min(from, to);
    const int i = std::min(low % patch.ni, patch.ni - 2);
    const int j = std::min(low / patch.ni, patch.nj - 2);
    const Vec3 normal = cell_normal(patch, i, j);
    const Vec3 inward = point(from + in) - point(from);
    Vec3 normal_there = normal;
    if (rows > 2) {
      const bool is_along_j = std::abs(in) == 1;  // of a patch two points wide both say the same
      const int step = in < 0 ? -1 : 1;
      normal_there =
          extended(normal, inward.norm(),
                   cell_normal(patch, i + (is_along_j ? step : 0), j + (is_along_j ? 0 : step)),
                   (point(from + 2 * in) - point(from + in)).norm());
    }
    edges_.push_back({a, b, (node(b) - node(a)).norm(), normal, inward, normal_there});
  }
  runs_.push_back({begin, edges_.size()});
}

bool PlaneFinder::is_on(const Plane& plane, const FreeEdge& edge) const {
  return std::abs(height(plane, node(edge.a))) <= tolerance_ &&
         std::abs(height(plane, node(edge.b))) <= tolerance_;
}

std::array<double, 2> PlaneFinder::reach(const Plane& plane) const {
  std::array<double, 2> reach{0, 0};
  for (const Vec3& p : nodes_) {
    const double h = height(plane, p);
    reach[0] = std::min(reach[0], h);
    reach[1] = std::max(reach[1], h);
  }
  return reach;
}

/// The other free edge at one end of an edge, where it goes on without a corner.
std::optional<std::size_t> PlaneFinder::next_edge(std::size_t edge, int at) const {
  const std::vector<std::size_t>& both = edges_at_.at(at);
  if (both.size() != 2) return {};
  const std::size_t next = both[0] == edge ? both[1] : both[0];
  const auto other_end = [&](std::size_t e) {
    return edges_[e].a == at ? edges_[e].b : edges_[e].a;
  };
  const Vec3 here = node(at) - node(other_end(edge));
  const Vec3 there = node(other_end(next)) - node(at);
  return here.dot(there) > kSmooth * here.norm() * there.norm() ? std::optional(next)
                                                                : std::nullopt;
}

/// Length of the smooth curve that an edge on the plane goes on as, off it, beyond its end `from`.
double PlaneFinder::smooth_rest(const Plane& plane, std::size_t edge, int from) const {
  double length = 0;
  int at = from;
  for (std::size_t steps = 0; steps < edges_.size(); ++steps) {
    const std::optional<std::size_t> next = next_edge(edge, at);
    if (!next || edges_[*next].taken || is_on(plane, edges_[*next])) break;
    edge = *next;
    at = edges_[edge].a == at ? edges_[edge].b : edges_[edge].a;
    length += edges_[edge].length;
  }
  return length;
}

double PlaneFinder::smooth_rest(const Plane& plane) const {
  double length = 0;
  for (std::size_t e = 0; e < edges_.size(); ++e) {
    if (edges_[e].taken || !is_on(plane, edges_[e])) continue;
    length += smooth_rest(plane, e, edges_[e].a) + smooth_rest(plane, e, edges_[e].b);
  }
  return length;
}

bool PlaneFinder::stands_up(const Plane& plane, const std::vector<std::size_t>& edges) const {
  const bool says_nothing = is_flat_
                                ? edges.size() < 2 || (edges.size() == 2 && !is_along_axis(plane))
                                : edges.size() <= 3;
  double length = 0;
  double upright = 0;
  double flat = 0;
  double least = 0;
  for (const std::size_t e : edges) {
    const double along = std::abs(plane.normal.dot(edges_[e].normal));
    length += edges_[e].length;
    upright += edges_[e].length * along;
    flat += along > kFlat ? edges_[e].length : 0;
    least = std::max(least, along);
  }
  if (upright > kUpright * length || flat > kFlatPart * length) return false;
  // Three always lie in a plane, two ends of curves on a line: that they do says nothing.
  if (says_nothing && least > (is_flat_ ? kUprightEnd : kUpright)) return false;
  const PlaneRim rim = rim_of(plane, edges);
  return !rim.is_closed() || std::abs(rim.area) > tolerance_ * rim.length;
}

/// Whether cells of the wall lie in a plane, as a side of a body that is flush with an edge: there
/// it would have no layers.
bool PlaneFinder::holds_wall(const Plane& plane) const {
  std::vector<char> is_on;
  for (const Vec3& p : nodes_) is_on.push_back(std::abs(height(plane, p)) <= tolerance_ ? 1 : 0);
  bool holds = false;
  for (std::size_t p = 0; p < grids_.patches.size() && !holds; ++p) {
    for_cells(grids_.patches[p], [&](std::array<int, 4> c) {
      for (int& corner : c) corner = grids_.nodes[p][static_cast<std::size_t>(corner)];
      if (!std::ranges::all_of(c, [&](int n) { return is_on[static_cast<std::size_t>(n)] != 0; }))
        return;
      const Vec3 area = (node(c[2]) - node(c[0])).cross(node(c[3]) - node(c[1]));
      const double longest =
          std::max((node(c[2]) - node(c[0])).norm(), (node(c[3]) - node(c[1])).norm());
      holds = holds || area.norm() > tolerance_ * longest;
    });
  }
  return holds;
}

/// Whether the wall stands up from a plane, on one side, and no free edge leaves it as a smooth
/// curve. Turns its normal towards the wall.
bool PlaneFinder::is_end(Plane& plane, double gained) const {
  if (!stands_up(plane, left_on(plane))) return false;
  const std::array<double, 2> sides = reach(plane);
  if (std::min(-sides[0], sides[1]) > tolerance_) return false;
  if (smooth_rest(plane) > gained || holds_wall(plane)) return false;
  if (-sides[0] > sides[1]) plane.normal = -plane.normal;
  return true;
}

bool PlaneFinder::best(Plane& plane) const {
  const std::vector<Plane> on_axes = meridians();
  double most = 0;
  for (Plane guess : guesses(on_axes)) {
    double gained = 0;
    for (const FreeEdge& edge : edges_) {
      if (!edge.taken && is_on(guess, edge)) gained += edge.length;
    }
    if (!(gained > most * (1 - kSame))) continue;
    const bool is_more = gained > most * (1 + kSame);
    if (!is_more && !comes_before(guess, plane, tolerance_)) continue;
    if (!is_end(guess, gained) || is_chance(guess, on_axes)) continue;
    most = gained;
    plane = guess;
  }
  return most > 0;
}

void PlaneFinder::take(Plane& plane) {
  std::vector<double> heights;
  for (FreeEdge& edge : edges_) {
    if (!is_on(plane, edge)) continue;
    edge.taken = true;
    heights.push_back(height(plane, node(edge.a)));
    heights.push_back(height(plane, node(edge.b)));
  }
  if (heights.empty()) return;
  const auto middle = heights.begin() + static_cast<std::ptrdiff_t>(heights.size() / 2);
  std::nth_element(heights.begin(), middle, heights.end());
  plane.point_world += *middle * plane.normal;
  // Files mean 0 where they say 1e-18, and a mirror in 0 maps voxels to voxels.
  for (int axis = 0; axis < 3; ++axis) {
    const bool across = std::abs(plane.normal[axis]) > 1 - 1e-12;
    const bool is_zero = std::abs(plane.point_world[axis]) <= 1e-6 * tolerance_;
    if (across && is_zero) plane.point_world[axis] = 0;
  }
}

std::vector<std::size_t> PlaneFinder::edges_on(const Plane& plane) const {
  std::vector<std::size_t> on;
  for (std::size_t e = 0; e < edges_.size(); ++e) {
    if (is_on(plane, edges_[e])) on.push_back(e);
  }
  return on;
}

std::vector<std::size_t> PlaneFinder::left_on(const Plane& plane) const {
  std::vector<std::size_t> left = edges_on(plane);
  std::erase_if(left, [&](std::size_t e) { return edges_[e].taken; });
  return left;
}

PlaneRim PlaneFinder::rim_of(const Plane& plane, const std::vector<std::size_t>& edges) const {
  PlaneRim rim;
  for (const std::size_t e : edges) {
    const Vec3& a = node(edges_[e].a);
    const Vec3& b = node(edges_[e].b);
    Vec3 across = (b - a).cross(plane.normal);
    if (across.dot(edges_[e].normal) < 0) across = -across;
    rim.area += (0.5 * (a + b) - plane.point_world).dot(across);
    rim.closing += across;
    rim.length += (b - a).norm();
  }
  return rim;
}

bool PlaneFinder::is_opening(const Plane& plane, const std::vector<std::size_t>& edges) const {
  const PlaneRim rim = rim_of(plane, edges);
  return rim.is_opening() && stands_up(plane, edges);
}

}  // namespace vdb_offset
