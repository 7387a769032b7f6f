#include "blocks/side_growth.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <mutex>
#include <span>
#include <vector>

#include "core/clones.h"
#include "core/parallel.h"

namespace vdb_offset {
namespace {

/// Squared ratios, one a level of points.
using Ratios2 = std::vector<double>;

/// The same levels of three columns that follow one another.
struct Columns {
  const Vec3* before;
  const Vec3* here;
  const Vec3* after;
};

VDB_OFFSET_CLONES void widen(const Columns& columns, std::span<double> ratios2) {
  for (std::size_t k = 0; k < ratios2.size(); ++k) {
    const double a2 = (columns.here[k] - columns.before[k]).squaredNorm();
    const double b2 = (columns.after[k] - columns.here[k]).squaredNorm();
    const double shorter2 = std::min(a2, b2);
    const double ratio2 = std::max(a2, b2) / shorter2;
    ratios2[k] = std::max(ratios2[k], shorter2 > 0 ? ratio2 : 1.0);
  }
}

/// All edges within a block that meet in points of row j.
void widen_row(const MultiBlock& mesh, const Block& block, int j, Ratios2& ratios2) {
  const auto column = [&](int i, int row) { return &mesh.point(block, i, row, 0); };
  for (int i = 0; i < block.ni; ++i) {
    if (i > 0 && i + 1 < block.ni) {
      widen({column(i - 1, j), column(i, j), column(i + 1, j)}, ratios2);
    }
    if (j > 0 && j + 1 < block.nj) {
      widen({column(i, j - 1), column(i, j), column(i, j + 1)}, ratios2);
    }
  }
}

/// Walks over the columns of an interface's side, each with the one inside its block.
struct FaceWalk {
  const MultiBlock& mesh;
  const BlockRange& range;

  int count() const {
    return std::max(std::abs(range.end[0] - range.begin[0]),
                    std::abs(range.end[1] - range.begin[1])) +
           1;
  }
  const Vec3* column(int step, int inward) const {
    const Block& block = mesh.blocks[static_cast<std::size_t>(range.block)];
    const auto sign = [](int x) { return (x > 0) - (x < 0); };
    int i = range.begin[0] + step * sign(range.end[0] - range.begin[0]);
    int j = range.begin[1] + step * sign(range.end[1] - range.begin[1]);
    if (range.face == BlockFace::IMin) i += inward;
    if (range.face == BlockFace::IMax) i -= inward;
    if (range.face == BlockFace::JMin) j += inward;
    if (range.face == BlockFace::JMax) j -= inward;
    return &mesh.point(block, i, j, 0);
  }
};

void widen_interface(const MultiBlock& mesh, const Interface& face, Ratios2& ratios2) {
  const FaceWalk first{mesh, face.first};
  const FaceWalk second{mesh, face.second};
  for (int n = 0; n < first.count(); ++n) {
    widen({first.column(n, 1), first.column(n, 0), second.column(n, 1)}, ratios2);
  }
}

void raise(const Ratios2& ratios2, Ratios2& worst2) {
  for (std::size_t k = 0; k < worst2.size(); ++k) worst2[k] = std::max(worst2[k], ratios2[k]);
}

/// Within a block; the largest of numbers does not depend on who comes first.
Ratios2 within(const MultiBlock& mesh, const Block& block) {
  Ratios2 worst2(static_cast<std::size_t>(mesh.layers.levels()), 1.0);
  std::mutex mutex;
  parallel::for_ranges(static_cast<std::size_t>(block.nj), 8,
                       [&](std::size_t begin, std::size_t end) {
                         Ratios2 ratios2(worst2.size(), 1.0);
                         for (std::size_t j = begin; j < end; ++j) {
                           widen_row(mesh, block, static_cast<int>(j), ratios2);
                         }
                         const std::lock_guard lock(mutex);
                         raise(ratios2, worst2);
                       });
  return worst2;
}

}  // namespace

void report_side_growth(const MultiBlock& mesh, QualityReport& report) {
  std::vector<Ratios2> blocks;
  for (const Block& block : mesh.blocks) blocks.push_back(within(mesh, block));
  for (const Interface& face : mesh.interfaces) {
    Ratios2 ratios2(static_cast<std::size_t>(mesh.layers.levels()), 1.0);
    widen_interface(mesh, face, ratios2);
    raise(ratios2, blocks[static_cast<std::size_t>(face.first.block)]);
    raise(ratios2, blocks[static_cast<std::size_t>(face.second.block)]);
  }
  const auto widest = [](double& number, double ratio2) {
    number = std::max(number, std::sqrt(ratio2));
  };
  for (std::size_t b = 0; b < blocks.size(); ++b) {
    for (std::size_t k = 0; k < blocks[b].size(); ++k) {
      widest(report.patches[b].side_growth_max, blocks[b][k]);
      // a level's edges are of the cells below and above
      if (k > 0) widest(report.levels[k - 1].side_growth_max, blocks[b][k]);
      if (k < report.levels.size()) widest(report.levels[k].side_growth_max, blocks[b][k]);
      widest(report.side_growth_max, blocks[b][k]);
    }
  }
}

}  // namespace vdb_offset
