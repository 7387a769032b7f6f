#include "surface/round_runs.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

namespace vdb_offset {

namespace {

constexpr double kRound = 1e-3;  // of an arc's height that it may be off a circle

double off_line(const EdgeLine& line, const Vec3& p) {
  return (p - line.point).cross(line.direction).norm();
}

}  // namespace

std::vector<EdgeLine> lines_of(const Vec3List& nodes_world,
                               const std::vector<std::array<int, 2>>& edges, std::size_t most,
                               double tolerance_world) {
  std::vector<EdgeLine> lines;
  for (const std::array<int, 2>& edge : edges) {
    const Vec3& a = nodes_world[static_cast<std::size_t>(edge[0])];
    const Vec3& b = nodes_world[static_cast<std::size_t>(edge[1])];
    const auto holds = [&](const EdgeLine& line) {
      return off_line(line, a) <= tolerance_world && off_line(line, b) <= tolerance_world;
    };
    auto found = std::ranges::find_if(lines, holds);
    if (found == lines.end()) {
      if (lines.size() > most) return lines;
      found = lines.insert(found, {a, (b - a).normalized(), {}});
    }
    found->nodes.insert(found->nodes.end(), edge.begin(), edge.end());
  }
  return lines;
}

std::vector<Plane> meridians_of(const Vec3List& points_world, double tolerance_world) {
  const std::size_t count = points_world.size();
  if (count < 4 || points_world.front() == points_world.back()) return {};
  Vec3 middle = Vec3::Zero();
  for (const Vec3& p : points_world) middle += p / static_cast<double>(count);
  Eigen::Matrix3d spread = Eigen::Matrix3d::Zero();
  for (const Vec3& p : points_world) spread += (p - middle) * (p - middle).transpose();
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(spread);
  const Vec3 axis = solver.eigenvectors().col(0);
  const Vec3 u = solver.eigenvectors().col(1);
  const Vec3 v = solver.eigenvectors().col(2);
  // |q|^2 = 2 q . centre + (radius^2 - |centre|^2), in the plane's coordinates.
  Eigen::MatrixX3d rows(count, 3);
  Eigen::VectorXd squares(count);
  for (std::size_t n = 0; n < count; ++n) {
    const Vec3 away = points_world[n] - middle;
    const auto row = static_cast<Eigen::Index>(n);
    rows.row(row) << 2 * away.dot(u), 2 * away.dot(v), 1;
    squares[row] = away.squaredNorm();
  }
  const Vec3 fit = rows.colPivHouseholderQr().solve(squares);
  const double square = fit.z() + fit.head<2>().squaredNorm();
  if (!fit.allFinite() || !(square > 0)) return {};
  const Vec3 centre = middle + fit.x() * u + fit.y() * v;
  const Vec3& first = points_world.front();
  const EdgeLine chord{first, (points_world.back() - first).normalized(), {}};
  double height = 0;
  double off = 0;
  for (const Vec3& p : points_world) {
    height = std::max(height, off_line(chord, p));
    off = std::max(
        {off, std::abs(axis.dot(p - centre)), std::abs((p - centre).norm() - std::sqrt(square))});
  }
  // Nearly straight ones would have their axis anywhere.
  if (!(height > tolerance_world && off <= std::min(tolerance_world, kRound * height))) return {};
  std::vector<Plane> planes;
  for (const Vec3& end : {points_world.front(), points_world.back()}) {
    planes.push_back({centre, axis.cross(end - centre).normalized()});
  }
  return planes;
}

}  // namespace vdb_offset
