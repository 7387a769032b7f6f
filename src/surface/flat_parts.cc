#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <span>
#include <vector>

#include "core/sets.h"
#include "vdb_offset/surface/overlaps.h"

namespace vdb_offset {
namespace {

std::size_t at(int index) { return static_cast<std::size_t>(index); }

/// Of what holds together by its vertices.
struct Measure {
  double volume = 0, area = 0;
};

}  // namespace

std::vector<FlatPart> find_flat_parts(const Wall& wall) {
  constexpr double kFlat = 1e-9;
  const Box& box = wall.bounds();
  const double far = box.lo.cwiseAbs().cwiseMax(box.hi.cwiseAbs()).maxCoeff();
  Sets sets(wall.vertices().size());
  for (const Wall::Triangle& t : wall.triangles()) {
    sets.join(t[0], t[1]);
    sets.join(t[0], t[2]);
  }
  std::vector<Measure> of_root(wall.vertices().size());
  const std::span<const Wall::Triangle> triangles = wall.triangles();
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    const int root = sets.root(triangles[t][0]);
    const TriangleGeometry& g = wall.geometry()[t];
    const Vec3 twice = g.ab.cross(g.ac);
    of_root[at(root)].area += twice.norm() / 2;
    of_root[at(root)].volume += twice.dot(g.a - wall.vertices()[at(root)]) / 6;
  }
  std::vector<FlatPart> parts;
  for (std::size_t v = 0; v < of_root.size(); ++v) {
    const auto& [volume, area] = of_root[v];
    const double thickness = area > 0 ? 2 * std::abs(volume) / area : 0;
    if (area > 0 && thickness <= kFlat * (box.size() + far)) {
      parts.push_back({wall.vertices()[v], thickness});
    }
  }
  return parts;
}

}  // namespace vdb_offset
