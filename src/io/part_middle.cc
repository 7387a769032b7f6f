#include "io/part_middle.h"

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <limits>

namespace vdb_offset {
namespace {

/// Of a face at a corner: `normal` . x - `offset` is how far x lies within.
struct Plane {
  Vec3 normal;
  double offset;
  double area;  ///< of the parallelogram between the corner's edges

  double within(const Vec3& x) const { return normal.dot(x) - offset; }
};

std::vector<Plane> planes_of(const std::vector<InnerFace>& faces) {
  std::vector<Plane> planes;
  for (const InnerFace& face : faces) {
    const std::size_t n = face.size();
    for (std::size_t c = 0; c < (n == 3 ? 1 : n); ++c) {
      const Vec3 area = (face[(c + 1) % n] - face[c]).cross(face[(c + n - 1) % n] - face[c]);
      const double size = area.norm();
      const Vec3 normal = size > 0 ? Vec3(area / size) : Vec3(Vec3::Zero());
      planes.push_back({normal, normal.dot(face[c]), size});
    }
  }
  return planes;
}

double least_within(const std::vector<Plane>& planes, const Vec3& x) {
  double least = std::numeric_limits<double>::infinity();
  for (const Plane& plane : planes) least = std::min(least, plane.within(x));
  return least;
}

/// The point as far within each of four planes; `start` if there is none.
Vec3 equally_within(const std::array<const Plane*, 4>& four, const Vec3& start) {
  Eigen::Matrix3d rows;
  Vec3 right;
  for (int r = 0; r < 3; ++r) {
    const Plane& other = *four[static_cast<std::size_t>(r) + 1];
    rows.row(r) = (four[0]->normal - other.normal).transpose();
    right[r] = other.within(start) - four[0]->within(start);
  }
  constexpr double kRounding = 1e-12;
  const double det = rows.determinant();
  if (!(std::abs(det) > kRounding)) return start;
  return start + rows.inverse() * right;
}

}  // namespace

double least_part_about(const std::vector<InnerFace>& faces, const Vec3& apex) {
  double least = std::numeric_limits<double>::infinity();
  for (const Plane& plane : planes_of(faces)) {
    least = std::min(least, plane.area * plane.within(apex));
  }
  return least;
}

Vec3 part_middle(const std::vector<InnerFace>& faces, const Vec3& mean) {
  const std::vector<Plane> planes = planes_of(faces);
  Vec3 best = mean;
  double most = least_within(planes, mean);
  if (most > 0) return mean;
  const std::size_t n = planes.size();
  for (std::size_t a = 0; a < n; ++a) {
    for (std::size_t b = a + 1; b < n; ++b) {
      for (std::size_t code = (b + 1) * n; code < n * n; ++code) {
        const std::size_t c = code / n;
        const std::size_t d = code % n;
        if (d <= c) continue;
        const Vec3 x = equally_within({&planes[a], &planes[b], &planes[c], &planes[d]}, mean);
        const double least = least_within(planes, x);
        if (least > most) {
          most = least;
          best = x;
        }
      }
    }
  }
  return best;
}

}  // namespace vdb_offset
