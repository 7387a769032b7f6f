#include "surface/missed_edges.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

namespace vdb_offset {

namespace {

constexpr double kNear = 1000;  // times what is near enough
constexpr double kAlong = 0.5;  // of its length that an edge along a plane rises at most

double height(const Plane& plane, const Vec3& p) { return plane.normal.dot(p - plane.point_world); }

/// How far an edge along a plane is off it; nothing for others, and for those on it.
std::optional<double> off(const PlaneFinder& finder, const Plane& plane, const FreeEdge& edge) {
  const double a = height(plane, finder.node(edge.a));
  const double b = height(plane, finder.node(edge.b));
  const double most = std::max(std::abs(a), std::abs(b));
  const bool is_along = edge.length > 0 && std::abs(a - b) <= kAlong * edge.length;
  return is_along && most > finder.tolerance() ? std::optional(most) : std::nullopt;
}

}  // namespace

double nearest_missed(const PlaneFinder& finder, const Plane& plane) {
  double least = std::numeric_limits<double>::infinity();
  for (const FreeEdge& edge : finder.edges()) {
    if (const std::optional<double> is_off = off(finder, plane, edge)) {
      least = std::min(least, *is_off);
    }
  }
  return least;
}

std::optional<MissedEdges> missed_edges(const PlaneFinder& finder, const Plane& plane) {
  MissedEdges missed;
  missed.tolerance_world = finder.tolerance();
  for (const FreeEdge& edge : finder.edges()) {
    const std::optional<double> is_off = off(finder, plane, edge);
    if (edge.taken || !is_off || *is_off > kNear * finder.tolerance()) continue;
    missed.off_world = missed.edges == 0 ? *is_off : std::min(missed.off_world, *is_off);
    missed.off_max_world = std::max(missed.off_max_world, *is_off);
    ++missed.edges;
  }
  return missed.edges > 0 ? std::optional(missed) : std::nullopt;
}

}  // namespace vdb_offset
