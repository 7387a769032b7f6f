// Scaled Jacobian as the Verdict library computes it (Stimpson, Ernst, Knupp, Pebay, Thompson,
// The Verdict Geometric Quality Library, 2007); collapsed cells are judged at the corners of the
// prism or pyramid that is left.

#include "vdb_offset/blocks/quality.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/parallel.h"

namespace vdb_offset {
namespace {

/// Corners by bits: corner b lies at i = b & 1, j = b >> 1 & 1, k = b >> 2. The neighbour along
/// axis a is b ^ (1 << a), which VTK's circular order hides.
using Corners = std::array<Vec3, 8>;

constexpr double kInfinity = std::numeric_limits<double>::infinity();
/// The ring of corners around the diagonal 0-7; each neighbouring pair makes a tetrahedron with it.
constexpr std::array<std::size_t, 7> kRing{1, 3, 2, 6, 4, 5, 1};

double det(const Vec3& a, const Vec3& b, const Vec3& c) {
  return (a.y() * b.z() - a.z() * b.y()) * c.x() + (a.z() * b.x() - a.x() * b.z()) * c.y() +
         (a.x() * b.y() - a.y() * b.x()) * c.z();
}

/// The twelve edges; edge [a][n] runs along axis a, n counts the other two axes' bits in order.
struct EdgeFrame {
  std::array<std::array<Vec3, 4>, 3> edge;
  std::array<std::array<double, 4>, 3> inverse_length;

  explicit EdgeFrame(const Corners& q) {
    for (std::size_t n = 0; n < 4; ++n) {
      const std::size_t low = n & 1U;
      const std::size_t high = n >> 1U;
      edge[0][n] = q[2 * n + 1] - q[2 * n];
      edge[1][n] = q[low + 2 + 4 * high] - q[low + 4 * high];
      edge[2][n] = q[n + 4] - q[n];
    }
    for (std::size_t a = 0; a < 3; ++a) {
      for (std::size_t n = 0; n < 4; ++n) {
        inverse_length[a][n] = 1.0 / std::sqrt(edge[a][n].squaredNorm());
      }
    }
  }

  /// False if some edge is collapsed: its inverse length is infinite then.
  bool proper() const {
    double sum = 0;
    for (const auto& axis : inverse_length) {
      for (const double value : axis) sum += value;
    }
    return sum < kInfinity;
  }
};

/// Normalised Jacobian of the principal axes.
double centre_jacobian(const EdgeFrame& f) {
  std::array<Vec3, 3> axis;
  double lengths = 1;
  for (std::size_t a = 0; a < 3; ++a) {
    axis[a] = f.edge[a][0] + f.edge[a][1] + f.edge[a][2] + f.edge[a][3];
    lengths *= axis[a].norm();
  }
  // Opposite edges that cancel leave no axis: such a cell is folded flat at its centre.
  return lengths > 0 ? det(axis[0], axis[1], axis[2]) / lengths : 0.0;
}

CellQuality judge_hexahedron(const Corners& q, const EdgeFrame& f) {
  CellQuality result;
  result.min_jacobian = kInfinity;
  result.scaled_jacobian = centre_jacobian(f);
  for (std::size_t b = 0; b < 8; ++b) {
    const std::size_t x = b >> 1U;
    const std::size_t y = (b & 1U) + 2 * (b >> 2U);
    const std::size_t z = b & 3U;
    const double jacobian = det(f.edge[0][x], f.edge[1][y], f.edge[2][z]);
    const double scaled =
        jacobian * f.inverse_length[0][x] * f.inverse_length[1][y] * f.inverse_length[2][z];
    result.min_jacobian = std::min(result.min_jacobian, jacobian);
    result.scaled_jacobian = std::min(result.scaled_jacobian, scaled);
  }
  const Vec3 diagonal = q[7] - q[0];
  double least = kInfinity;
  for (std::size_t t = 0; t < 6; ++t) {
    const double six_fold = det(q[kRing[t]] - q[0], q[kRing[t + 1]] - q[0], diagonal);
    least = std::min(least, six_fold);
    result.volume += six_fold / 6;
  }
  result.positive = result.min_jacobian > 0 && least > 0;
  return result;
}

/// The corners that an edge from `b` along `axis` may lead to: its neighbour, or, where that
/// coincides, the next vertices of the two faces.
struct Steps {
  std::array<std::size_t, 2> to{};
  std::size_t count = 0;
};

Steps steps_along(const Corners& q, std::size_t b, std::size_t axis) {
  Steps steps;
  const std::size_t next = b ^ (std::size_t{1} << axis);
  if (q[next] != q[b]) {
    steps.to[steps.count++] = next;
    return steps;
  }
  for (std::size_t other = 0; other < 3; ++other) {
    const std::size_t bit = std::size_t{1} << other;
    if (other == axis || q[next ^ bit] == q[b]) continue;
    steps.to[steps.count++] = next ^ bit;
  }
  return steps;
}

/// Takes one corner's three edges into account; where two lead to one point (a face collapsed to a
/// line) there is no corner.
void judge_triad(const Corners& q, std::size_t b, const std::array<std::size_t, 3>& to,
                 CellQuality& result) {
  if (q[to[0]] == q[to[1]] || q[to[1]] == q[to[2]] || q[to[2]] == q[to[0]]) return;
  const std::array<Vec3, 3> e{q[to[0]] - q[b], q[to[1]] - q[b], q[to[2]] - q[b]};
  const bool mirrored = ((b ^ (b >> 1U) ^ (b >> 2U)) & 1U) != 0;
  const double jacobian = mirrored ? -det(e[0], e[1], e[2]) : det(e[0], e[1], e[2]);
  const double lengths = e[0].norm() * e[1].norm() * e[2].norm();
  result.min_jacobian = std::min(result.min_jacobian, jacobian);
  result.scaled_jacobian = std::min(result.scaled_jacobian, lengths > 0 ? jacobian / lengths : 0.0);
}

void judge_corner(const Corners& q, std::size_t b, CellQuality& result) {
  const std::array<Steps, 3> steps{steps_along(q, b, 0), steps_along(q, b, 1),
                                   steps_along(q, b, 2)};
  const std::size_t triads = steps[0].count * steps[1].count * steps[2].count;
  for (std::size_t t = 0; t < triads; ++t) {
    const std::size_t x = t % steps[0].count;
    const std::size_t y = t / steps[0].count % steps[1].count;
    const std::size_t z = t / (steps[0].count * steps[1].count);
    judge_triad(q, b, {steps[0].to[x], steps[1].to[y], steps[2].to[z]}, result);
  }
}

CellQuality judge_collapsed(const Corners& q) {
  CellQuality result;
  result.min_jacobian = kInfinity;
  result.scaled_jacobian = kInfinity;
  for (std::size_t b = 0; b < 8; ++b) judge_corner(q, b, result);
  double least = kInfinity;
  for (std::size_t t = 0; t < 6; ++t) {
    const Vec3& a = q[kRing[t]];
    const Vec3& c = q[kRing[t + 1]];
    const bool flat = q[0] == q[7] || a == q[0] || a == q[7] || c == q[0] || c == q[7] || a == c;
    if (flat) continue;
    const double six_fold = det(a - q[0], c - q[0], q[7] - q[0]);
    least = std::min(least, six_fold);
    result.volume += six_fold / 6;
  }
  const bool nothing_left = result.min_jacobian == kInfinity || least == kInfinity;
  if (nothing_left && std::isfinite(result.volume)) return {};
  result.positive = result.min_jacobian > 0 && least > 0;
  return result;
}

CellQuality judge_cell(const Corners& q) {
  const EdgeFrame f(q);
  CellQuality result = f.proper() ? judge_hexahedron(q, f) : judge_collapsed(q);
  if (!std::isfinite(result.volume + result.scaled_jacobian)) return {-1, 0, 0, false};
  return result;
}

/// What a slab of cells or columns adds to the report; slabs are combined in their order, so that
/// sums do not depend on threads.
struct Partial {
  double min_scaled_jacobian = kInfinity;
  double sum_scaled_jacobian = 0;
  double min_volume = kInfinity;
  double growth_max = 1;
  std::uint64_t nonpositive = 0;

  void add(const Partial& other) {
    min_scaled_jacobian = std::min(min_scaled_jacobian, other.min_scaled_jacobian);
    sum_scaled_jacobian += other.sum_scaled_jacobian;
    min_volume = std::min(min_volume, other.min_volume);
    growth_max = std::max(growth_max, other.growth_max);
    nonpositive += other.nonpositive;
  }
};

/// One row of cell columns along i: a slab.
struct Row {
  std::size_t block = 0;
  int j = 0;
};

struct CellArrays {
  std::vector<float>& scaled_jacobian;
  std::vector<float>& volume;
};

Partial judge_row(const MultiBlock& mesh, const Row& row, CellArrays out) {
  const Block& block = mesh.blocks[row.block];
  const auto cells_i = static_cast<std::size_t>(block.ni - 1);
  const std::size_t layer = cells_i * static_cast<std::size_t>(block.nj - 1);
  Partial partial;
  for (int i = 0; i + 1 < block.ni; ++i) {
    std::array<const Vec3*, 4> column;
    for (int n = 0; n < 4; ++n) {
      column[static_cast<std::size_t>(n)] = &mesh.point(block, i + (n & 1), row.j + (n >> 1), 0);
    }
    std::size_t cell = static_cast<std::size_t>(row.j) * cells_i + static_cast<std::size_t>(i);
    Corners q;
    for (std::size_t n = 0; n < 4; ++n) q[n + 4] = column[n][0];
    for (int k = 1; k < block.nk; ++k, cell += layer) {
      for (std::size_t n = 0; n < 4; ++n) q[n] = q[n + 4];
      for (std::size_t n = 0; n < 4; ++n) q[n + 4] = column[n][k];
      const CellQuality quality = judge_cell(q);
      out.scaled_jacobian[cell] = static_cast<float>(quality.scaled_jacobian);
      out.volume[cell] = static_cast<float>(quality.volume);
      partial.min_scaled_jacobian = std::min(partial.min_scaled_jacobian, quality.scaled_jacobian);
      partial.sum_scaled_jacobian += quality.scaled_jacobian;
      partial.min_volume = std::min(partial.min_volume, quality.volume);
      partial.nonpositive += quality.positive ? 0 : 1;
    }
  }
  return partial;
}

/// Largest growth along a column; a cell without height has no growth.
double column_growth(const Layers& layers, int node) {
  const Vec3* p = &layers.at(node, 0);
  double growth = 1;
  double below = 0;
  for (int k = 1; k < layers.levels(); ++k) {
    const double height = (p[k] - p[k - 1]).norm();
    if (below > 0) growth = std::max(growth, height / below);
    below = height;
  }
  return growth;
}

double max_growth(const Layers& layers) {
  constexpr std::size_t kSlab = 1024;
  const std::size_t nodes = layers.stop.size();
  std::vector<double> growth((nodes + kSlab - 1) / kSlab, 1.0);
  parallel::for_ranges(growth.size(), 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t s = begin; s < end; ++s) {
      for (std::size_t n = s * kSlab; n < std::min(nodes, (s + 1) * kSlab); ++n) {
        growth[s] = std::max(growth[s], column_growth(layers, static_cast<int>(n)));
      }
    }
  });
  return growth.empty() ? 1.0 : *std::max_element(growth.begin(), growth.end());
}

void report_first_cells(std::vector<double> heights, QualityReport& report) {
  if (heights.empty()) return;
  const auto middle = heights.begin() + static_cast<std::ptrdiff_t>(heights.size() / 2);
  std::nth_element(heights.begin(), middle, heights.end());
  const auto below = std::max_element(heights.begin(), middle);
  report.first_cell_median = heights.size() % 2 == 1 ? *middle : 0.5 * (*below + *middle);
  report.first_cell_min = below == middle ? *middle : *std::min_element(heights.begin(), middle);
  report.first_cell_max = *std::max_element(middle, heights.end());
}

}  // namespace

CellQuality cell_quality(const std::array<Vec3, 8>& c) {
  return judge_cell({c[0], c[1], c[3], c[2], c[4], c[5], c[7], c[6]});
}

QualityField judge(const MultiBlock& mesh, const Progress& progress) {
  QualityField field;
  std::vector<Row> rows;
  for (std::size_t b = 0; b < mesh.blocks.size(); ++b) {
    field.scaled_jacobian.emplace_back(mesh.blocks[b].cell_count());
    field.volume.emplace_back(mesh.blocks[b].cell_count());
    for (int j = 0; j + 1 < mesh.blocks[b].nj; ++j) rows.push_back({b, j});
  }
  std::vector<Partial> partials(rows.size());
  const parallel::Stage stage{progress, "blocks"};
  parallel::for_ranges(stage, rows.size(), 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t r = begin; r < end; ++r) {
      const std::size_t b = rows[r].block;
      partials[r] = judge_row(mesh, rows[r], {field.scaled_jacobian[b], field.volume[b]});
    }
  });
  Partial total;
  for (const Partial& partial : partials) total.add(partial);
  QualityReport& report = field.report;
  if (mesh.cells() > 0) {
    report.min_scaled_jacobian = total.min_scaled_jacobian;
    report.mean_scaled_jacobian = total.sum_scaled_jacobian / static_cast<double>(mesh.cells());
    report.min_volume = total.min_volume;
  }
  report.nonpositive_cells = total.nonpositive;
  report.growth_max = max_growth(mesh.layers);
  report_first_cells(mesh.layers.first_cell_world, report);
  return field;
}

std::vector<Coverage> coverage(const MultiBlock& mesh) {
  std::vector<Coverage> result;
  for (const Block& block : mesh.blocks) {
    std::vector<int> nodes = block.columns;  // a pole's or a seam's node counts once
    std::sort(nodes.begin(), nodes.end());
    nodes.erase(std::unique(nodes.begin(), nodes.end()), nodes.end());
    Coverage c;
    double sum = 0;
    for (const int node : nodes) {
      sum += mesh.coverage(node);
      c.min = std::min(c.min, mesh.coverage(node));
    }
    if (!nodes.empty()) c.mean = sum / static_cast<double>(nodes.size());
    result.push_back(c);
  }
  return result;
}

}  // namespace vdb_offset
