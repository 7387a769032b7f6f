#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "blocks/column_system.h"

namespace vdb_offset {

/// Three edges that span a corner or a tetrahedron of each cell in a stack: one along each
/// direction of the cell, between four points; and what they should be like.
struct Triad {
  struct Point {
    int column = -1;
    int up = 0;  ///< 0: at the cell's lower level, 1: at its upper
  };
  struct Edge {
    std::size_t from = 0;
    std::size_t to = 0;
    const std::vector<double>* length_world = nullptr;  ///< ideal, by level; of the third: none
    std::size_t up = 0;                                 ///< level of the length
  };
  std::array<Point, 4> points;
  std::array<Edge, 3> edges;                           ///< the third along the column
  double cosine = 0;                                   ///< of the ideal angle between the first two
  const std::vector<double>* heights_world = nullptr;  ///< of the levels
  double weight = 1;
  std::size_t first = 0;  ///< lowest cell of the stack that it counts in

  /// +1 or -1 where a point ends or begins an edge, else 0.
  double sign(std::size_t edge, std::size_t point) const {
    return edges[edge].to == point ? 1.0 : edges[edge].from == point ? -1.0 : 0.0;
  }
};

/// Energy of a triad over all cells of its stack, against the ideal (Garanzha, Kaporin,
/// Kudryavtseva, Protais, Ray, Sokolov, Foldover-free maps in 50 lines of code, 2021):
///
///     f = (1 - t) tr(A'A) / (3 chi^(2/3)) + t (D^2 + 1) / (2 chi),   A = J W^-1,  D = det A,
///     chi = (D + sqrt(eps^2 + D^2)) / 2
///
/// J: the three edges, W: the ideal ones. f is least, 1, where A is a rotation. For one thread.
class TriadEnergy {
 public:
  TriadEnergy(std::size_t levels, double epsilon);

  static constexpr double kVolumeWeight = 0.3;  ///< t

  struct Sum {
    double energy = 0;
    double least = 0;  ///< D
  };
  Sum value(const Triad& triad, const ColumnVector& x);

  struct Derivatives {
    ColumnVector& gradient;
    ColumnSystem& hessian;
  };
  /// The same, with its gradient, and a positive part of its Hessian (that of the function of A
  /// and D with D linear; what D's curvature adds is left out).
  Sum expand(const Triad& triad, const ColumnVector& x, const Derivatives& out);

 private:
  enum Array : std::size_t {
    kEdges = 0,     // e1, e2, e3: 9
    kCross = 9,     // derivative of D by them: 9
    kStretch = 18,  // half the derivative of the trace by them: 9
    kMetric = 27,   // G11, G12, G22, G33 of the ideal
    kTrace = 31,
    kDet,
    kEnergy,
    kScale,    // 1 / det W
    kByTrace,  // 2 df/dT
    kByDet,    // df/dD
    kMixed,    // 2 d2f/dTdD
    kByDet2,   // d2f/dD2, or more
    kBlocks,   // 45: H11 H22 H33 upper triangles, H12 H13 H23
    kArrays = kBlocks + 45
  };
  double* array(std::size_t index) { return store_.data() + index * cells_; }
  const double* block_entry(std::size_t i, std::size_t j, std::size_t entry);

  void set_ideal(const Triad& triad);
  void measure(const Triad& triad, const ColumnVector& x);
  Sum evaluate(double weight, bool derivatives);
  void second_derivatives();
  void scatter_gradient(const Triad& triad, ColumnVector& gradient);
  void scatter_hessian(const Triad& triad, ColumnSystem& hessian);

  std::size_t cells_;
  std::size_t first_ = 0;  // cell of the triad at hand
  std::size_t count_;      // of its cells
  double epsilon_;
  std::vector<double> store_;
};

}  // namespace vdb_offset
