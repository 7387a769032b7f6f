#pragma once

#include <array>
#include <cstddef>
#include <limits>
#include <vector>

#include "blocks/column_system.h"
#include "blocks/window_shape.h"
#include "vdb_offset/core/vec.h"
#include "vdb_offset/surface/surface.h"

namespace vdb_offset {

/// Holds levels to their true distances: sum weight ((phi(x) - height) / layer)^2 over the free
/// points, the outer level most, and all more where cells count more; phi by the plane that it is
/// near the point. Where two or three parts of the wall are as near, each has its plane, so that
/// points settle on the bisector.
class LevelHeights {
 public:
  LevelHeights(const Surface& surface, const WindowShape& shape);

  /// Takes phi, exact, where the points are now; of those that have hardly moved since, not again.
  void measure(const ColumnVector& x);
  double value(const ColumnVector& x) const;
  /// Adds gradient and Hessian.
  void expand(const ColumnVector& x, ColumnVector& gradient, ColumnSystem& hessian) const;

 private:
  struct Plane {
    Vec3 normal = Vec3::Zero();
    double offset = 0;  // phi = normal . x + offset
    double distance(const Vec3& x) const { return normal.dot(x) + offset; }
  };
  struct Term {
    std::array<Plane, 3> plane;
    std::size_t count = 0;
    double height = 0;
    double layer = 0;   // height of the cells there
    double wanted = 0;  // weight of all planes, of an error of a layer
    double weight = 0;  // of each plane
    Vec3 taken_at = Vec3::Constant(std::numeric_limits<double>::quiet_NaN());
  };
  template <typename Visit>
  void visit(const ColumnVector& x, std::size_t slot, const Visit& body) const;
  Plane nearest_plane(const Vec3& x, int& guess) const;
  void find_planes(const Vec3& x, Term& term, int& guess) const;

  const Surface& surface_;
  std::size_t levels_ = 0;
  std::vector<Term> terms_;  // free slot by free slot
};

}  // namespace vdb_offset
