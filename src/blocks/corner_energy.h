#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "blocks/column_system.h"

namespace vdb_offset {

/// The ideal corner: two edges along the wall, at the angle that they have there, and one as high
/// as the layer, orthogonal to them.
struct CornerIdeal {
  std::vector<double> first_world;   ///< length of the first edge at each level
  std::vector<double> second_world;  ///< and of the second
  double cosine = 0;                 ///< of the angle between them
};

/// One corner of a face: its column, the next and the one before.
struct Corner {
  int column = -1;
  int next = -1;
  int previous = -1;
  CornerIdeal ideal;
};

/// Energy of the corners of all cells in a stack, against their ideals (Garanzha, Kaporin,
/// Kudryavtseva, Protais, Ray, Sokolov, Foldover-free maps in 50 lines of code, 2021):
///
///     f = (1 - t) tr(A'A) / (3 chi^(2/3)) + t (D^2 + 1) / (2 chi),   A = J W^-1,  D = det A,
///     chi = (D + sqrt(eps^2 + D^2)) / 2
///
/// J: the corner's three edges, W: those of the ideal. f = 1 / 3 ... is least, 1, where A is a
/// rotation.
class CornerEnergy {
 public:
  explicit CornerEnergy(std::size_t levels);

  double epsilon = 1;
  static constexpr double kVolumeWeight = 0.3;  ///< t

  /// What one corner adds over all its cells, below and above.
  struct Sum {
    double energy = 0;
    double least = 0;  ///< D
  };
  Sum value(const Corner& corner, const ColumnVector& x, const std::vector<double>& heights_world);

  /// The same, with its gradient, and a positive part of its Hessian (that of the function of A
  /// and D with D linear; what D's curvature adds is left out).
  Sum expand(const Corner& corner, const ColumnVector& x, const std::vector<double>& heights_world,
             ColumnVector& gradient, ColumnSystem& hessian);

 private:
  enum Array : std::size_t {
    kEdges = 0,     // e1, e2, e3: 9
    kCross = 9,     // derivative of D by them: 9
    kStretch = 18,  // half the derivative of the trace by them: 9
    kMetric = 27,   // G11, G12, G22, G33 of the ideal
    kTrace = 31,
    kDet,
    kByTrace,    // 2 df/dT
    kByDet,      // df/dD
    kMixed,      // 2 d2f/dTdD
    kByDet2,     // d2f/dD2
    kValue,
    kBlocks,     // 45: H11 H22 H33 upper triangles, H12 H13 H23
    kArrays = kBlocks + 45
  };
  double* array(std::size_t index) { return store_.data() + index * levels_; }

  void measure(const Corner& corner, const ColumnVector& x, const std::vector<double>& heights,
               std::size_t base);
  Sum evaluate(std::size_t count, bool derivatives);
  void second_derivatives();
  void scatter_gradient(const Corner& corner, std::size_t base, ColumnVector& gradient);
  void scatter_hessian(const Corner& corner, std::size_t base, ColumnSystem& hessian);

  std::size_t levels_;
  std::vector<double> store_;
};

}  // namespace vdb_offset
