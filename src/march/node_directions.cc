// Aubry and Loehner, On the 'most normal' normal, 2008: where the mean of the normals hides a cell,
// the direction with the largest least cosine to all normals at the node. Whether any sees all
// cells is decided on the cone of those that do: its edges lie in two cells' planes each.

#include "march/node_directions.h"

#include <algorithm>
#include <limits>

#include "core/most_normal.h"
#include "core/parallel.h"

namespace vdb_offset {

namespace {

constexpr double kHidden = 0.2;  // cosine to a cell's normal below which the mean is not used
constexpr double kBlind = 1e-6;  // and below which nothing but rounding is seen

void list_triangles(const Wall& wall, std::size_t nodes, NodeDirections& result) {
  const auto for_corners = [&](const auto& visit) {
    for (std::size_t t = 0; t < wall.triangles().size(); ++t) {
      for (const int v : wall.triangles()[t]) {
        if (static_cast<std::size_t>(v) < nodes) visit(t, static_cast<std::size_t>(v));
      }
    }
  };
  result.first_triangle.assign(nodes + 1, 0);
  for_corners([&](std::size_t, std::size_t node) { ++result.first_triangle[node + 1]; });
  for (std::size_t n = 0; n < nodes; ++n) result.first_triangle[n + 1] += result.first_triangle[n];
  result.triangle_list.resize(result.first_triangle[nodes]);
  std::vector<std::size_t> next(result.first_triangle);
  for_corners([&](std::size_t t, std::size_t node) {
    result.triangle_list[next[node]++] = static_cast<int>(t);
  });
}

double spacing_at(const Wall& wall, const NodeDirections& result, std::size_t node) {
  double shortest = std::numeric_limits<double>::infinity();
  result.for_edges(wall, node, [&](const Vec3& edge) {
    if (edge.norm() > 0) shortest = std::min(shortest, edge.norm());
  });
  return shortest;
}

struct Out {
  Vec3 direction;
  bool blind = false;
};

Out direction_at(const Wall& wall, const NodeDirections& result, std::size_t node) {
  const Vec3& mean = wall.vertex_normal(static_cast<int>(node));
  Vec3List normals;
  for (const int t : result.triangles(node)) {
    if (wall.triangle_normal(t).squaredNorm() > 0) normals.push_back(wall.triangle_normal(t));
  }
  if (normals.empty() || least_cosine(mean, normals) >= kHidden) return {mean};
  const Visible best = most_normal(normals, mean.squaredNorm() < 0.5 ? normals.front() : mean);
  return {best.direction, !(best.least_cosine > kBlind)};
}

}  // namespace

NodeDirections node_directions(const Wall& wall, int nodes) {
  const auto count = static_cast<std::size_t>(nodes);
  NodeDirections result;
  list_triangles(wall, count, result);
  result.direction.resize(count);
  result.spacing_world.resize(count);
  std::vector<char> blind(count);  // bits of one word are not written side by side
  parallel::for_ranges(count, 512, [&](std::size_t begin, std::size_t end) {
    for (std::size_t node = begin; node < end; ++node) {
      const Out out = direction_at(wall, result, node);
      result.direction[node] = out.direction;
      blind[node] = out.blind ? 1 : 0;
      result.spacing_world[node] = spacing_at(wall, result, node);
    }
  });
  result.blind.assign(blind.begin(), blind.end());
  return result;
}

}  // namespace vdb_offset
