// Which planes free edges may lie in, and which of those mean nothing.

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>

#include "surface/coincide.h"
#include "surface/plane_finder.h"
#include "surface/round_runs.h"

namespace vdb_offset {

namespace {

constexpr double kUprightLine = 0.5;     // the wall stands up from two lines at 60 degrees or more
constexpr std::size_t kMostRuns = 2000;  // beyond it runs are not compared in pairs

}  // namespace

Vec3List PlaneFinder::points_of(const Run& run) const {
  Vec3List points;
  for (std::size_t e = run.begin; e < run.end; ++e) points.push_back(node(edges_[e].a));
  points.push_back(node(edges_[run.end - 1].b));
  return points;
}

/// Planes that a sector of a body of revolution ends on: through the axis of arcs, at their ends.
std::vector<Plane> PlaneFinder::meridians() const {
  std::vector<Plane> planes;
  for (const Run& run : runs_) {
    for (Plane plane : meridians_of(points_of(run), tolerance_)) {
      const std::vector<std::size_t> left = left_on(plane);
      double gained = 0;
      for (const std::size_t e : left) gained += edges_[e].length;
      if (gained > 0 && is_end(plane, gained)) planes.push_back(plane);
    }
  }
  return planes;
}

/// Whether each edge left on a plane lies on another, a meridian, that further lines lie on.
bool PlaneFinder::is_chord(const Plane& plane, const std::vector<Plane>& meridians) const {
  const std::vector<std::size_t> left = left_on(plane);
  std::vector<bool> is_held(left.size(), false);
  for (const Plane& meridian : meridians) {
    if (is_same_plane(meridian, {plane, nodes_, tolerance_})) continue;
    std::vector<std::array<int, 2>> ends;
    for (const std::size_t e : left_on(meridian)) {
      if (edges_[e].length > 0) ends.push_back({edges_[e].a, edges_[e].b});
    }
    if (lines_of(nodes_, ends, 1, tolerance_).size() < 2) continue;
    for (std::size_t n = 0; n < left.size(); ++n) {
      is_held[n] = is_held[n] || is_on(meridian, edges_[left[n]]);
    }
  }
  return std::ranges::all_of(is_held, [](bool held) { return held; });
}

/// Whether edges left on a plane lie on it for that they are few: those of one straight line lie on
/// any plane through it, and two lines apart on one that is not along an axis and that the wall
/// leans over. Where they end on meridians these are what is meant; but a plane along an axis that
/// two lines lie on may cut a round trough, unless the meridians hold further lines, as of a hub.
bool PlaneFinder::is_chance(const Plane& plane, const std::vector<Plane>& meridians) const {
  if (is_flat_) return false;
  const std::vector<std::size_t> left = left_on(plane);
  std::vector<std::array<int, 2>> ends;
  double least = 0;
  for (const std::size_t e : left) {
    if (!(edges_[e].length > 0)) continue;
    ends.push_back({edges_[e].a, edges_[e].b});
    least = std::max(least, std::abs(plane.normal.dot(edges_[e].normal_there)));
  }
  std::vector<EdgeLine> lines = lines_of(nodes_, ends, 2, tolerance_);
  if (lines.size() > 2) return false;
  if (lines.size() == 2) {
    if (is_along_axis(plane)) return is_chord(plane, meridians);
    const std::vector<int>& others = lines[1].nodes;
    const auto is_shared = [&](int n) { return std::ranges::count(others, n) > 0; };
    if (std::ranges::any_of(lines[0].nodes, is_shared)) return false;
    if (least > kUprightLine) return true;
  }
  return std::ranges::any_of(meridians, [&](const Plane& meridian) {
    const auto is_there = [&](std::size_t e) { return is_on(meridian, edges_[e]); };
    return std::ranges::any_of(left, is_there) &&
           !is_same_plane(meridian, {plane, nodes_, tolerance_});
  });
}

/// The line that fits a run's nodes best, and the planes that they may lie in.
PlaneFinder::Line PlaneFinder::fit(const Run& run, std::vector<Plane>& planes) const {
  const Vec3List points = points_of(run);
  Vec3 upright = Vec3::Zero();
  Box box;
  for (std::size_t e = run.begin; e < run.end; ++e) {
    upright += edges_[e].length * edges_[e].normal_there;
  }
  Line line{Vec3::Zero(), Vec3::Zero()};
  for (const Vec3& p : points) line.centre += p / static_cast<double>(points.size());
  Eigen::Matrix3d spread = Eigen::Matrix3d::Zero();
  for (const Vec3& p : points) {
    spread += (p - line.centre) * (p - line.centre).transpose();
    box.add(p);
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(spread);
  line.direction = solver.eigenvectors().col(2);
  const bool is_straight = std::all_of(points.begin(), points.end(), [&](const Vec3& p) {
    return (p - line.centre).cross(line.direction).norm() <= tolerance_;
  });
  for (int axis = 0; axis < 3; ++axis) {
    if ((box.hi - box.lo)[axis] <= tolerance_) planes.push_back({line.centre, Vec3::Unit(axis)});
  }
  // Along a straight run lies the plane that stands upright on the wall there.
  const Vec3 normal =
      is_straight ? Vec3(line.direction.cross(upright)) : Vec3(solver.eigenvectors().col(0));
  if (normal.norm() > 0) planes.push_back({line.centre, normal.normalized()});
  return line;
}

std::vector<Plane> PlaneFinder::guesses(std::vector<Plane> planes) const {
  std::vector<Line> lines;
  for (const Run& run : runs_) {
    const bool is_left = std::any_of(edges_.begin() + static_cast<std::ptrdiff_t>(run.begin),
                                     edges_.begin() + static_cast<std::ptrdiff_t>(run.end),
                                     [](const FreeEdge& edge) { return !edge.taken; });
    if (is_left) lines.push_back(fit(run, planes));
  }
  if (lines.size() > kMostRuns) return planes;
  for (std::size_t a = 0; a < lines.size(); ++a) {
    for (std::size_t b = a + 1; b < lines.size(); ++b) {
      const Vec3 between = lines[b].centre - lines[a].centre;
      Vec3 normal = lines[a].direction.cross(lines[b].direction);
      if (normal.norm() < 1e-3) normal = lines[a].direction.cross(between.normalized());
      if (normal.norm() < 1e-3) continue;
      normal.normalize();
      if (std::abs(normal.dot(between)) > tolerance_) continue;
      planes.push_back({0.5 * (lines[a].centre + lines[b].centre), normal});
    }
  }
  return planes;
}

}  // namespace vdb_offset
