// Aubry and Loehner, On the 'most normal' normal, 2008: the direction with the largest least cosine
// to all normals at the node. Whether any sees all cells is decided on the cone of those that do:
// its edges lie in two cells' planes each.

#include "core/most_normal.h"

#include <Eigen/Geometry>
#include <algorithm>

namespace vdb_offset {

double least_cosine(const Vec3& direction, const Vec3List& normals) {
  double least = 1;
  for (const Vec3& normal : normals) least = std::min(least, direction.dot(normal));
  return least;
}

namespace {

constexpr double kBarely = 0.05;         // below which the cone itself is looked at
constexpr std::size_t kMostFaces = 200;  // of a cone that is: the cost is their number cubed

/// Badoiu and Clarkson's core-set iteration: step towards the farthest normal with falling weight.
Vec3 farthest_of_all(const Vec3List& normals, Vec3 direction) {
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

/// The mean of the edges of the cone of directions that see all cells; zero if there is none.
Vec3 middle_of_cone(const Vec3List& normals) {
  constexpr double kParallel = 1e-6;
  Vec3 sum = Vec3::Zero();
  for (std::size_t a = 0; a < normals.size(); ++a) {
    for (std::size_t b = 0; b < a; ++b) {
      const Vec3 edge = normals[a].cross(normals[b]);
      if (!(edge.norm() > kParallel)) continue;
      for (const Vec3& way : {Vec3(edge.normalized()), Vec3(-edge.normalized())}) {
        if (least_cosine(way, normals) > -1e-12) sum += way;
      }
    }
  }
  return sum.norm() > 1e-9 ? Vec3(sum.normalized()) : Vec3(Vec3::Zero());
}

}  // namespace

Visible most_normal(const Vec3List& normals, const Vec3& start) {
  const Vec3 best = farthest_of_all(normals, start);
  const double least = least_cosine(best, normals);
  if (least >= kBarely || normals.size() > kMostFaces) return {best, least};
  const Vec3 middle = middle_of_cone(normals);
  const double of_middle = least_cosine(middle, normals);
  return of_middle > std::max(0.0, least) ? Visible{middle, of_middle} : Visible{best, least};
}

}  // namespace vdb_offset
