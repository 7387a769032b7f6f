#pragma once

#include <vector>

#include "march/column.h"

namespace vdb_offset {

/// True distance along a column as a cubic Hermite function of the path's length; read backwards,
/// and corrected by the exact distance, it says where a layer lies.
class HeightProfile {
 public:
  /// Keeps references to tracer and path. Cost: about five exact distances for a smooth column.
  void build(ColumnTracer& tracer, const ColumnPath& path, const ColumnEnd& end);

  /// Length, not below `from`, at which the true distance is `height_world`.
  /// Accuracy 1e-9 relative where the distance rises along the column; across a kink, where it may
  /// jump over the height, the nearest that five steps find. Cost: none on a straight start, else
  /// about two exact distances.
  double length_at(double height_world, double from);

 private:
  struct Knot {
    double s, height, slope;
  };
  void refine(const Knot& a, const Knot& b, int depth);
  double predict(double height_world) const;

  ColumnTracer::Height height_at(double s) const;

  ColumnTracer* tracer_ = nullptr;
  const ColumnPath* path_ = nullptr;
  bool home_ = false;      // the wall around the foot stands for all of it
  double prediction_ = 0;  // relative error that the knots leave
  double linear_ = 0;      // up to this length the height is slope * s
  std::vector<Knot> knots_;
};

}  // namespace vdb_offset
