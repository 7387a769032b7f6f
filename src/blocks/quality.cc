#include "vdb_offset/blocks/quality.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "blocks/cell_row.h"
#include "blocks/side_growth.h"
#include "core/parallel.h"
#include "vdb_offset/blocks/bare_stacks.h"

namespace vdb_offset {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
/// Columns of cells of a slab, at least: what a slab keeps for each layer weighs little then.
constexpr int kSlabColumns = 256;

/// Rows of a block's stacks, [begin, end) along i and along j; of polygons part of their one row.
/// Slabs do not depend on threads.
struct Slab {
  std::size_t block = 0;
  std::array<int, 2> i = {0, 0};
  std::array<int, 2> j = {0, 0};

  std::size_t cells_i() const { return static_cast<std::size_t>(i[1] - i[0]); }
};

void add_slabs(const Block& block, std::size_t index, std::vector<Slab>& slabs) {
  const int cells_i = block.stacks_i();
  const int wide = block.is_grid() ? std::max(cells_i, 1) : kSlabColumns;
  const int rows = (kSlabColumns + wide - 1) / wide;
  for (int j = 0; j < block.stacks_j(); j += rows) {
    for (int i = 0; i < cells_i; i += wide) {
      slabs.push_back(
          {index, {i, std::min(i + wide, cells_i)}, {j, std::min(j + rows, block.stacks_j())}});
    }
  }
}

std::vector<Slab> slabs_of(const MultiBlock& mesh) {
  std::vector<Slab> slabs;
  for (std::size_t b = 0; b < mesh.blocks.size(); ++b) {
    add_slabs(mesh.blocks[b], b, slabs);
  }
  return slabs;
}

/// The worst of a layer's cells, so far.
struct Worst {
  double scaled_jacobian = kInfinity;
  double sum_scaled_jacobian = 0;
  double jacobian = kInfinity;
  double volume = kInfinity;
  double skewness = 0;
  double aspect2 = 1;
  double orthogonality = 1;
  double growth2 = 1;
  std::uint64_t nonpositive = 0;
  std::uint64_t cells = 0;

  void add(const Worst& other) {
    scaled_jacobian = std::min(scaled_jacobian, other.scaled_jacobian);
    sum_scaled_jacobian += other.sum_scaled_jacobian;
    jacobian = std::min(jacobian, other.jacobian);
    volume = std::min(volume, other.volume);
    skewness = std::max(skewness, other.skewness);
    aspect2 = std::max(aspect2, other.aspect2);
    orthogonality = std::min(orthogonality, other.orthogonality);
    growth2 = std::max(growth2, other.growth2);
    nonpositive += other.nonpositive;
    cells += other.cells;
  }

  void put_into(QualityMinima& minima) const {
    if (cells == 0) return;
    minima.cells = cells;
    minima.nonpositive_cells = nonpositive;
    minima.min_scaled_jacobian = scaled_jacobian;
    minima.min_jacobian = jacobian;
    minima.min_volume = volume;
    minima.max_skewness = skewness;
    minima.max_aspect_ratio = std::sqrt(aspect2);
    minima.min_orthogonality = orthogonality;
    minima.growth_max = std::sqrt(growth2);
  }
};

/// The worst of each layer over one slab, a line a measure: loops over layers become vectors.
struct WorstLines {
  using Line = CellRow::Line;
  Line scaled_jacobian, sum, jacobian, volume, skewness, aspect2, orthogonality, growth2;
  std::array<std::uint64_t, CellRow::kStack> nonpositive;

  WorstLines() {
    for (Line* line : {&scaled_jacobian, &jacobian, &volume}) line->fill(kInfinity);
    for (Line* line : {&sum, &skewness}) line->fill(0);
    for (Line* line : {&aspect2, &orthogonality, &growth2}) line->fill(1);
    nonpositive.fill(0);
  }

  Worst at(std::size_t k) const {
    return {scaled_jacobian[k], sum[k],           jacobian[k], volume[k],      skewness[k],
            aspect2[k],         orthogonality[k], growth2[k],  nonpositive[k], 0};
  }
};

VDB_OFFSET_CLONES void add_stack(const CellRow::Stack& stack, std::size_t count,
                                 WorstLines& worst) {
  for (std::size_t k = 0; k < count; ++k) {
    worst.sum[k] += stack.scaled_jacobian[k];
    worst.scaled_jacobian[k] = std::min(worst.scaled_jacobian[k], stack.scaled_jacobian[k]);
    worst.jacobian[k] = std::min(worst.jacobian[k], stack.min_jacobian[k]);
    worst.volume[k] = std::min(worst.volume[k], stack.volume[k]);
  }
  for (std::size_t k = 0; k < count; ++k) {
    worst.skewness[k] = std::max(worst.skewness[k], stack.skewness[k]);
    worst.aspect2[k] = std::max(worst.aspect2[k], stack.aspect2[k]);
    worst.orthogonality[k] = std::min(worst.orthogonality[k], stack.orthogonality[k]);
    worst.growth2[k] = std::max(worst.growth2[k], stack.growth2[k]);
  }
  for (std::size_t k = 0; k < count; ++k) {
    const bool positive = (stack.least_part[k] > 0) & (stack.scaled_jacobian[k] >= kFlat);
    worst.nonpositive[k] += positive ? 0U : 1U;
  }
}

/// Where stacks leave a value of their cells: a row's, each layer together, before it goes to the
/// block's field; single values would be far apart there.
class RowBuffer {
 public:
  RowBuffer(const Block& block, const Slab& slab)
      : cells_i_(slab.cells_i()),
        first_(static_cast<std::size_t>(slab.i[0])),
        row_(static_cast<std::size_t>(block.stacks_i())),
        layer_(row_ * static_cast<std::size_t>(block.stacks_j())),
        values_(cells_i_ * CellRow::kStack) {}

  void put(std::size_t i, std::size_t count, const CellRow::Line& line) {
    for (std::size_t k = 0; k < count; ++k) {
      values_[k * cells_i_ + i] = static_cast<float>(line[k]);
    }
  }
  /// Of squares; 1 for 0, which stands for a growth from nothing.
  void put_roots(std::size_t i, std::size_t count, const CellRow::Line& line) {
    for (std::size_t k = 0; k < count; ++k) {
      values_[k * cells_i_ + i] = line[k] > 0 ? static_cast<float>(std::sqrt(line[k])) : 1.0F;
    }
  }
  void send(int j, int first, std::size_t count, std::vector<float>& field) const {
    for (std::size_t k = 0; k < count; ++k) {
      const std::size_t cell = (static_cast<std::size_t>(first) + k) * layer_ +
                               static_cast<std::size_t>(j) * row_ + first_;
      std::copy_n(values_.data() + k * cells_i_, cells_i_, field.data() + cell);
    }
  }

 private:
  std::size_t cells_i_;
  std::size_t first_;  // along i
  std::size_t row_;
  std::size_t layer_;
  std::vector<float> values_;
};

/// Some layers of a row of cells.
struct Part {
  int j = 0;
  int first = 0;
  int count = 0;
};

/// A slab's parts, all rows of the lowest layers first.
std::vector<Part> parts_of(const Block& block, const Slab& slab) {
  const int layers = block.nk - 1;
  constexpr int kStack = static_cast<int>(CellRow::kStack);
  std::vector<Part> parts;
  for (int first = 0; first < layers; first += kStack) {
    for (int j = slab.j[0]; j < slab.j[1]; ++j) {
      parts.push_back({j, first, std::min(kStack, layers - first)});
    }
  }
  return parts;
}

/// Judges a slab: `worst` has a place for each of its layers.
void judge_slab(const MultiBlock& mesh, const Slab& slab, std::vector<float>& scaled_jacobian,
                std::vector<Worst>& worst) {
  const Block& block = mesh.blocks[slab.block];
  const std::size_t cells_i = slab.cells_i();
  RowBuffer buffer(block, slab);
  CellRow row(mesh, block);
  WorstLines lines;
  std::uint64_t bare = 0;  // stacks, which are not judged
  CellRow::Line ones;
  ones.fill(1);
  for (const Part& part : parts_of(block, slab)) {
    const auto count = static_cast<std::size_t>(part.count);
    if (part.j == slab.j[0]) {
      lines = {};
      bare = 0;
    }
    row.turn_to({slab.i[0], part.j}, part.first, part.count);
    for (std::size_t i = 0; i < cells_i; ++i) {
      const CellRow::Stack& stack = row.next();
      if (is_bare(mesh, block, slab.i[0] + static_cast<int>(i), part.j)) {
        buffer.put(i, count, ones);
        ++bare;
        continue;
      }
      add_stack(stack, count, lines);
      buffer.put(i, count, stack.scaled_jacobian);
    }
    buffer.send(part.j, part.first, count, scaled_jacobian);
    if (part.j + 1 < slab.j[1]) continue;
    for (std::size_t k = 0; k < count; ++k) {
      Worst& layer = worst[static_cast<std::size_t>(part.first) + k];
      layer = lines.at(k);
      layer.cells = cells_i * static_cast<std::uint64_t>(slab.j[1] - slab.j[0]) - bare;
    }
  }
}

/// Slabs are combined in their order, so that sums do not depend on threads.
void combine(const std::vector<Slab>& slabs, const std::vector<std::vector<Worst>>& worst,
             QualityReport& report) {
  Worst all;
  std::vector<Worst> levels(report.levels.size());
  std::vector<Worst> patches(report.patches.size());
  for (std::size_t s = 0; s < slabs.size(); ++s) {
    for (std::size_t k = 0; k < worst[s].size(); ++k) {
      levels[k].add(worst[s][k]);
      patches[slabs[s].block].add(worst[s][k]);
    }
  }
  for (std::size_t k = 0; k < levels.size(); ++k) levels[k].put_into(report.levels[k]);
  for (std::size_t b = 0; b < patches.size(); ++b) {
    patches[b].put_into(report.patches[b]);
    all.add(patches[b]);
  }
  all.put_into(report);
  if (all.cells > 0) {
    report.mean_scaled_jacobian = all.sum_scaled_jacobian / static_cast<double>(all.cells);
  }
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

std::array<std::vector<float>*, 6> fields_of(CellFields& fields) {
  return {&fields.min_jacobian, &fields.volume,        &fields.skewness,
          &fields.aspect_ratio, &fields.orthogonality, &fields.growth};
}

/// In VTK_HEXAHEDRON order.
std::array<Vec3, 8> corners_of(const MultiBlock& mesh, const Block& block, const CellPlace& at) {
  std::array<Vec3, 8> corners;
  const std::array<int, 4> ring = block.stack(at.i, at.j);
  for (std::size_t c = 0; c < 8; ++c) {
    corners[c] = mesh.layers.at(ring[c % 4], at.k + (c < 4 ? 0 : 1));
  }
  return corners;
}

/// A slab's part of the fields of a block.
void fill_slab(const MultiBlock& mesh, const Block& block, const Slab& slab, CellFields& fields) {
  const std::array<std::vector<float>*, 6> all = fields_of(fields);
  std::vector<RowBuffer> buffers(all.size(), RowBuffer(block, slab));
  CellRow row(mesh, block);
  for (const Part& part : parts_of(block, slab)) {
    const auto count = static_cast<std::size_t>(part.count);
    row.turn_to({slab.i[0], part.j}, part.first, part.count);
    for (std::size_t i = 0; i < slab.cells_i(); ++i) {
      const CellRow::Stack& s = row.next();
      buffers[0].put(i, count, s.min_jacobian);
      buffers[1].put(i, count, s.volume);
      buffers[2].put(i, count, s.skewness);
      buffers[3].put_roots(i, count, s.aspect2);
      buffers[4].put(i, count, s.orthogonality);
      buffers[5].put_roots(i, count, s.growth2);
    }
    for (std::size_t f = 0; f < all.size(); ++f) {
      buffers[f].send(part.j, part.first, count, *all[f]);
    }
  }
}

}  // namespace

QualityField judge(const MultiBlock& mesh, const Progress& progress) {
  QualityField field;
  for (const Block& block : mesh.blocks) field.scaled_jacobian.emplace_back(block.cell_count());
  const std::vector<Slab> slabs = slabs_of(mesh);
  std::vector<std::vector<Worst>> worst(slabs.size());
  const parallel::Stage stage{progress, "blocks"};
  parallel::for_ranges(stage, slabs.size(), 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t s = begin; s < end; ++s) {
      const std::size_t b = slabs[s].block;
      worst[s].resize(static_cast<std::size_t>(mesh.blocks[b].nk - 1));
      judge_slab(mesh, slabs[s], field.scaled_jacobian[b], worst[s]);
    }
  });
  QualityReport& report = field.report;
  report.levels.resize(static_cast<std::size_t>(mesh.layers.levels() - 1));
  report.patches.resize(mesh.blocks.size());
  combine(slabs, worst, report);
  report_side_growth(mesh, report);
  report_first_cells(mesh.layers.first_cell_world, report);
  return field;
}

std::vector<CellPlace> nonpositive_cells(const MultiBlock& mesh, const QualityField& quality,
                                         std::size_t most) {
  // Six tetrahedra are not inverted between corners better than this.
  constexpr float kSurelyPositive = 0.3F;
  std::vector<CellPlace> found;
  if (quality.report.nonpositive_cells == 0) return found;
  for (std::size_t b = 0; b < mesh.blocks.size(); ++b) {
    const Block& block = mesh.blocks[b];
    const std::vector<float>& values = quality.scaled_jacobian[b];
    const int ni = block.stacks_i();
    const int nj = block.stacks_j();
    for (std::size_t cell = 0; cell < values.size() && found.size() < most; ++cell) {
      if (values[cell] > kSurelyPositive) continue;
      const int n = static_cast<int>(cell % static_cast<std::size_t>(ni * nj));
      const int k = static_cast<int>(cell / static_cast<std::size_t>(ni * nj));
      const CellPlace place{static_cast<int>(b), n % ni, n / ni, k,
                            static_cast<double>(values[cell])};
      if (!cell_quality(corners_of(mesh, block, place)).positive) found.push_back(place);
    }
  }
  return found;
}

CellFields cell_fields(const MultiBlock& mesh, const Block& block) {
  CellFields fields;
  for (std::vector<float>* field : fields_of(fields)) field->resize(block.cell_count());
  std::vector<Slab> slabs;
  add_slabs(block, 0, slabs);
  parallel::for_ranges(slabs.size(), 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t s = begin; s < end; ++s) fill_slab(mesh, block, slabs[s], fields);
  });
  return fields;
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
