// C. de Boor, A Practical Guide to Splines, 1978: interpolation with the not-a-knot end condition
// (chapter IV), and the recurrence of B-splines (chapter X). In both directions one after the
// other.

#include "io/cad/spline_surface.h"

#include <Eigen/SparseLU>
#include <TColStd_Array1OfInteger.hxx>
#include <TColStd_Array1OfReal.hxx>
#include <TColgp_Array2OfPnt.hxx>
#include <algorithm>
#include <array>
#include <cstddef>
#include <vector>

#include "vdb_offset/core/error.h"

namespace vdb_offset::cad {
namespace {

/// Splines of one direction.
class Basis {
 public:
  explicit Basis(const std::vector<double>& parameters)
      : parameters_(parameters),
        degree_(std::min<int>(3, static_cast<int>(parameters.size()) - 1)) {
    knots_.assign(at(degree_ + 1), 0.0);
    // The second point and the last but one are no knots.
    if (degree_ == 3) {
      knots_.insert(knots_.end(), parameters.begin() + 2, parameters.end() - 2);
    }
    knots_.insert(knots_.end(), at(degree_ + 1), 1.0);
  }

  int degree() const { return degree_; }

  /// Poles of the splines through each column of values.
  Eigen::MatrixXd poles(const Eigen::MatrixXd& values) const {
    const auto count = static_cast<Eigen::Index>(parameters_.size());
    std::vector<Eigen::Triplet<double>> entries;
    for (Eigen::Index row = 0; row < count; ++row) {
      const double t = parameters_[static_cast<std::size_t>(row)];
      const int span = span_of(t);
      const std::array<double, 4> basis = values_at(t, span);
      for (int n = 0; n <= degree_; ++n) {
        entries.emplace_back(static_cast<int>(row), span - degree_ + n, basis[at(n)]);
      }
    }
    Eigen::SparseMatrix<double> matrix(count, count);
    matrix.setFromTriplets(entries.begin(), entries.end());
    const Eigen::SparseLU<Eigen::SparseMatrix<double>> solver(matrix);
    if (solver.info() != Eigen::Success) {
      throw InputError("no spline goes through the points of a patch");
    }
    return solver.solve(values);
  }

  /// Knots once each, and how often they stand.
  void put(TColStd_Array1OfReal& knots, TColStd_Array1OfInteger& times) const {
    const int inner = different() - 2;
    for (int n = 0; n < different(); ++n) {
      const bool is_end = n == 0 || n == inner + 1;
      knots(n + 1) = n == 0 ? 0.0 : n > inner ? 1.0 : knots_[at(degree_ + n)];
      times(n + 1) = is_end ? degree_ + 1 : 1;
    }
  }
  int different() const { return static_cast<int>(knots_.size()) - 2 * degree_; }

 private:
  static std::size_t at(int n) { return static_cast<std::size_t>(n); }

  /// The last knot at or before t that another follows.
  int span_of(double t) const {
    const auto last = knots_.end() - degree_ - 1;
    const auto after = std::upper_bound(knots_.begin() + degree_ + 1, last, t);
    return static_cast<int>(after - knots_.begin()) - 1;
  }

  /// Of the splines that are not 0 there.
  std::array<double, 4> values_at(double t, int span) const {
    std::array<double, 4> value{1, 0, 0, 0};
    for (int d = 1; d <= degree_; ++d) {
      double carried = 0;
      for (int n = 0; n < d; ++n) {
        const double right = knots_[at(span + n + 1)];
        const double left = knots_[at(span + n + 1 - d)];
        const double part = value[at(n)] / (right - left);
        value[at(n)] = carried + (right - t) * part;
        carried = (t - left) * part;
      }
      value[at(d)] = carried;
    }
    return value;
  }

  const std::vector<double>& parameters_;
  int degree_;
  std::vector<double> knots_;
};

}  // namespace

Handle(Geom_BSplineSurface) spline_surface(const SplinePiece& piece, double scale) {
  const Patch& patch = piece.patch;
  const Basis u(piece.u);
  const Basis v(piece.v);
  TColgp_Array2OfPnt poles(1, patch.ni, 1, patch.nj);
  for (int axis = 0; axis < 3; ++axis) {
    Eigen::MatrixXd values(patch.ni, patch.nj);
    for (int j = 0; j < patch.nj; ++j) {
      for (int i = 0; i < patch.ni; ++i) values(i, j) = scale * patch.at(i, j)[axis];
    }
    const Eigen::MatrixXd along_u = u.poles(values);
    const Eigen::MatrixXd both = v.poles(along_u.transpose());
    for (int j = 0; j < patch.nj; ++j) {
      for (int i = 0; i < patch.ni; ++i) poles(i + 1, j + 1).SetCoord(axis + 1, both(j, i));
    }
  }
  TColStd_Array1OfReal u_knots(1, u.different());
  TColStd_Array1OfReal v_knots(1, v.different());
  TColStd_Array1OfInteger u_times(1, u.different());
  TColStd_Array1OfInteger v_times(1, v.different());
  u.put(u_knots, u_times);
  v.put(v_knots, v_times);
  return new Geom_BSplineSurface(poles, u_knots, v_knots, u_times, v_times, u.degree(), v.degree());
}

}  // namespace vdb_offset::cad
