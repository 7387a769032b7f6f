#pragma once

#include <cstddef>
#include <vector>

#include "vdb_offset/core/vec.h"

namespace vdb_offset {

/// The path of one node: knots with unit tangents, cubic Hermite curves between them.
class ColumnPath {
 public:
  struct Knot {
    double s_world;  ///< length along the path
    Vec3 point_world;
    Vec3 tangent;
  };

  void clear() { knots_.clear(); }
  void add(const Knot& knot) { knots_.push_back(knot); }
  void drop_last() { knots_.pop_back(); }
  const Knot& back() const { return knots_.back(); }
  const Knot& knot(std::size_t n) const { return knots_[n]; }
  std::size_t size() const { return knots_.size(); }

  /// Point at length s, in [0, back().s_world].
  Vec3 point(double s_world) const;
  /// Derivative of `point`, about a unit vector.
  Vec3 derivative(double s_world) const;

 private:
  std::size_t segment(double s_world) const;
  std::vector<Knot> knots_;
};

}  // namespace vdb_offset
