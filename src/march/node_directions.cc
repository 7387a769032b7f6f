// Aubry and Loehner, On the 'most normal' normal, 2008: where the mean of the normals hides a cell,
// the direction with the largest least cosine to all normals at the node.

#include "march/node_directions.h"

#include <algorithm>
#include <limits>

namespace vdb_offset {

namespace {

constexpr double kHidden = 0.2;  // cosine to a cell's normal below which the mean is not used

double least_cosine(const Vec3& direction, const Vec3List& normals) {
  double least = 1;
  for (const Vec3& normal : normals) least = std::min(least, direction.dot(normal));
  return least;
}

/// Badoiu and Clarkson's core-set iteration: step towards the farthest normal with falling weight.
Vec3 most_normal(const Vec3List& normals, Vec3 direction) {
  Vec3 best = direction;
  for (int n = 1; n <= 200; ++n) {
    const auto farthest = std::min_element(
        normals.begin(), normals.end(),
        [&](const Vec3& a, const Vec3& b) { return direction.dot(a) < direction.dot(b); });
    direction += (*farthest - direction) / (n + 1);
    if (!(direction.norm() > 1e-6)) break;
    const Vec3 candidate = direction.normalized();
    if (least_cosine(candidate, normals) > least_cosine(best, normals)) best = candidate;
  }
  return best;
}

}  // namespace

NodeDirections node_directions(const Wall& wall, int nodes) {
  const auto count = static_cast<std::size_t>(nodes);
  NodeDirections result;
  result.spacing_world.assign(count, std::numeric_limits<double>::infinity());
  for (std::size_t n = 0; n < count; ++n) {
    result.direction.push_back(wall.vertex_normal(static_cast<int>(n)));
  }
  std::vector<std::vector<int>> hidden(count);  // triangles at nodes whose mean normal is poor
  const auto& triangles = wall.triangles();
  const auto for_corners = [&](const auto& visit) {
    for (std::size_t t = 0; t < triangles.size(); ++t) {
      for (const int v : triangles[t]) {
        if (v < nodes) visit(t, static_cast<std::size_t>(v));
      }
    }
  };
  std::vector<char> poor(count, 0);
  for_corners([&](std::size_t t, std::size_t node) {
    const Vec3& p = wall.vertices()[node];
    for (const int v : triangles[t]) {
      const double length = (wall.vertices()[static_cast<std::size_t>(v)] - p).norm();
      if (length > 0) result.spacing_world[node] = std::min(result.spacing_world[node], length);
    }
    const Vec3& normal = wall.triangle_normal(static_cast<int>(t));
    if (normal.squaredNorm() > 0 && result.direction[node].dot(normal) < kHidden) poor[node] = 1;
  });
  for_corners([&](std::size_t t, std::size_t node) {
    if (poor[node] != 0) hidden[node].push_back(static_cast<int>(t));
  });
  for (std::size_t node = 0; node < count; ++node) {
    if (poor[node] == 0) continue;
    Vec3List normals;
    for (const int t : hidden[node]) {
      if (wall.triangle_normal(t).squaredNorm() > 0) normals.push_back(wall.triangle_normal(t));
    }
    if (normals.empty()) continue;
    Vec3 start = result.direction[node];
    if (start.squaredNorm() < 0.5) start = normals.front();
    result.direction[node] = most_normal(normals, start);
  }
  return result;
}

}  // namespace vdb_offset
