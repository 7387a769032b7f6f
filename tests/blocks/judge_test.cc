// The whole mesh: what `judge`, `cell_fields` and `coverage` make of cells that `cell_quality` and
// `cell_shape` judge one by one.

#include <doctest/doctest.h>

#include <array>
#include <cmath>
#include <limits>

#include "support/hand_made.h"
#include "support/threads.h"
#include "vdb_offset/blocks/quality.h"

namespace vdb_offset::test {
namespace {

using Cell = std::array<Vec3, 8>;

constexpr double kRounding = 64 * std::numeric_limits<double>::epsilon();

/// A cell of a block, in VTK's order.
Cell cell_of(const MultiBlock& mesh, const Block& block, int i, int j, int k) {
  const auto p = [&](int a, int b, int c) { return mesh.point(block, i + a, j + b, k + c); };
  return {p(0, 0, 0), p(1, 0, 0), p(1, 1, 0), p(0, 1, 0),
          p(0, 0, 1), p(1, 0, 1), p(1, 1, 1), p(0, 1, 1)};
}

/// Largest height of the cell over the height below, of its four columns; 1 at the wall.
double growth_of(const Cell& cell, const Cell* below) {
  if (below == nullptr) return 1;
  double growth = 0;
  for (std::size_t n = 0; n < 4; ++n) {
    growth =
        std::max(growth, (cell[n + 4] - cell[n]).norm() / ((*below)[n + 4] - (*below)[n]).norm());
  }
  return growth;
}

void include(const Cell& cell, double growth, QualityMinima& row) {
  const CellQuality q = cell_quality(cell);
  const CellShape s = cell_shape(cell);
  if (row.cells == 0) row.min_scaled_jacobian = row.min_jacobian = row.min_volume = 1e300;
  ++row.cells;
  row.nonpositive_cells += q.positive ? 0 : 1;
  row.min_scaled_jacobian = std::min(row.min_scaled_jacobian, q.scaled_jacobian);
  row.min_jacobian = std::min(row.min_jacobian, q.min_jacobian);
  row.min_volume = std::min(row.min_volume, q.volume);
  row.max_skewness = std::max(row.max_skewness, s.skewness);
  row.max_aspect_ratio = std::max(row.max_aspect_ratio, s.aspect_ratio);
  row.min_orthogonality = std::min(row.min_orthogonality, s.orthogonality);
  row.growth_max = std::max(row.growth_max, growth);
}

void check_same(const QualityMinima& row, const QualityMinima& expected) {
  CHECK(row.cells == expected.cells);
  CHECK(row.nonpositive_cells == expected.nonpositive_cells);
  CHECK(row.min_scaled_jacobian == expected.min_scaled_jacobian);
  CHECK(row.min_jacobian == expected.min_jacobian);
  CHECK(row.min_volume == expected.min_volume);
  CHECK(row.max_skewness == expected.max_skewness);
  CHECK(row.max_aspect_ratio == expected.max_aspect_ratio);
  CHECK(row.min_orthogonality == expected.min_orthogonality);
  CHECK(row.growth_max == doctest::Approx(expected.growth_max).epsilon(kRounding));
}

/// Two blocks over one plate, of which the second has a row of columns collapsed into one.
MultiBlock plate_with_pole(int layers) {
  MultiBlock mesh = wavy_plate(9, 5, layers);
  Block right = mesh.blocks[0];
  right.name = "right";
  mesh.blocks[0].ni = 4;
  right.ni = 6;
  mesh.blocks[0].columns.clear();
  right.columns.clear();
  for (int n = 0; n < 45; ++n) {
    if (n % 9 <= 3) mesh.blocks[0].columns.push_back(n);
    if (n % 9 >= 3) right.columns.push_back(n % 9 == 8 ? 26 : n);
  }
  mesh.blocks.push_back(right);
  return mesh;
}

TEST_CASE(
    "judge: every cell is judged in its place, i fastest, then j, then k, collapsed ones too") {
  for (const int layers : {1, 3, 32, 33, 70}) {
    CAPTURE(layers);
    const MultiBlock mesh = plate_with_pole(layers);
    const QualityField field = judge(mesh);
    QualityMinima all;
    std::vector<QualityMinima> levels(static_cast<std::size_t>(layers));
    double sum = 0;
    for (std::size_t b = 0; b < 2; ++b) {
      const Block& block = mesh.blocks[b];
      const CellFields fields = cell_fields(mesh, block);
      QualityMinima patch;
      std::size_t c = 0;
      for (int k = 0; k + 1 < block.nk; ++k) {
        for (int j = 0; j + 1 < block.nj; ++j) {
          for (int i = 0; i + 1 < block.ni; ++i, ++c) {
            const Cell cell = cell_of(mesh, block, i, j, k);
            const Cell below = cell_of(mesh, block, i, j, std::max(k - 1, 0));
            const double growth = growth_of(cell, k > 0 ? &below : nullptr);
            const CellQuality q = cell_quality(cell);
            const CellShape s = cell_shape(cell);
            CHECK(field.scaled_jacobian[b][c] == static_cast<float>(q.scaled_jacobian));
            CHECK(fields.volume[c] == static_cast<float>(q.volume));
            CHECK(fields.min_jacobian[c] == static_cast<float>(q.min_jacobian));
            CHECK(fields.skewness[c] == static_cast<float>(s.skewness));
            CHECK(fields.aspect_ratio[c] == static_cast<float>(s.aspect_ratio));
            CHECK(fields.orthogonality[c] == static_cast<float>(s.orthogonality));
            CHECK(fields.growth[c] == doctest::Approx(growth).epsilon(1e-6));  // of a float
            for (QualityMinima* row : {&all, &patch, &levels[static_cast<std::size_t>(k)]}) {
              include(cell, growth, *row);
            }
            sum += q.scaled_jacobian;
          }
        }
      }
      REQUIRE(fields.volume.size() == c);
      check_same(field.report.patches[b], patch);
    }
    REQUIRE(field.report.levels.size() == levels.size());
    for (std::size_t k = 0; k < levels.size(); ++k) check_same(field.report.levels[k], levels[k]);
    check_same(field.report, all);
    const auto cells = static_cast<double>(all.cells);
    CHECK(field.report.mean_scaled_jacobian ==
          doctest::Approx(sum / cells).epsilon(kRounding * cells));
  }
}

TEST_CASE("judge: a coordinate that is not finite spoils its eight cells and no others") {
  MultiBlock mesh = wavy_plate(6, 5, 40);
  const QualityField good = judge(mesh);
  mesh.layers.points_world[41 * (2 * 6 + 3) + 20].y() = std::nan("");
  const QualityField bad = judge(mesh);
  CHECK(bad.report.nonpositive_cells == good.report.nonpositive_cells + 8);
  CHECK(bad.report.min_scaled_jacobian == -1);
  CHECK(bad.report.levels[19].nonpositive_cells == good.report.levels[19].nonpositive_cells + 4);
  CHECK(bad.report.levels[18].min_volume == good.report.levels[18].min_volume);
  for (std::size_t c = 0; c < good.scaled_jacobian[0].size(); ++c) {
    const std::size_t k = c / 20;
    const std::size_t j = c / 5 % 4;
    const std::size_t i = c % 5;
    const bool touched = (k == 19 || k == 20) && (j == 1 || j == 2) && (i == 2 || i == 3);
    CHECK(bad.scaled_jacobian[0][c] == (touched ? -1.0F : good.scaled_jacobian[0][c]));
  }
}

/// A flat block of `xs` by `ys` with layers of equal height, wider by `flare` a level.
MultiBlock plate(const std::vector<double>& xs, const std::vector<double>& ys, double flare) {
  const auto ni = static_cast<int>(xs.size());
  const auto nj = static_cast<int>(ys.size());
  Surface surface;
  std::vector<int> nodes;
  for (int n = 0; n < ni * nj; ++n) nodes.push_back(n);
  add_patch(surface, "plate", ni, nj, nodes);
  return build_blocks(surface, make_layers(ni * nj, 2, [&](int n, int k) -> Vec3 {
                        const double x = xs[static_cast<std::size_t>(n % ni)];
                        const double y = ys[static_cast<std::size_t>(n / ni)];
                        return {x + flare * k * x * x, y, 0.1 * k};
                      }));
}

TEST_CASE("judge: side growth is the ratio of edges that follow one another, either way round") {
  const auto largest = [](const MultiBlock& mesh) { return judge(mesh).report.side_growth_max; };
  CHECK(largest(plate({0, 1, 2}, {0, 1, 2}, 0)) == doctest::Approx(1).epsilon(kRounding));
  CHECK(largest(plate({0, 1, 4}, {0, 1, 2}, 0)) == doctest::Approx(3).epsilon(kRounding));
  CHECK(largest(plate({0, 3, 4}, {0, 1, 2}, 0)) == doctest::Approx(3).epsilon(kRounding));
  CHECK(largest(plate({0, 1, 2}, {0, 1, 2, 2.25}, 0)) == doctest::Approx(4).epsilon(kRounding));
  CHECK(largest(plate({0, 1, 1}, {0, 1, 2}, 0)) == doctest::Approx(1).epsilon(kRounding));

  // x + k x^2 / 10: edges 1.1 and 1.3 on level 1, 1.2 and 1.6 on level 2
  const QualityReport report = judge(plate({0, 1, 2}, {0, 1}, 0.1)).report;
  CHECK(report.levels[0].side_growth_max == doctest::Approx(1.3 / 1.1).epsilon(kRounding));
  CHECK(report.levels[1].side_growth_max == doctest::Approx(1.6 / 1.2).epsilon(kRounding));
  CHECK(report.patches[0].side_growth_max == report.side_growth_max);
}

TEST_CASE("judge: side growth goes across interfaces, also where blocks run against each other") {
  // two rows of quads of width 1 and 2.5 that meet in x = 0; the second block runs down, j along -x
  Surface surface;
  add_patch(surface, "left", 2, 3, {0, 1, 2, 3, 4, 5});
  add_patch(surface, "right", 3, 2, {8, 7, 6, 5, 3, 1});
  const Edge meeting{EdgeKind::Interface, {0, Side::IMax, 0, 2}, {1, Side::JMax, 2, 0}, {}};
  const auto blocks_of = [&](bool connected) {
    surface.topology.edges.clear();
    if (connected) surface.topology.edges.push_back(meeting);
    return build_blocks(surface, make_layers(9, 2, [](int n, int k) -> Vec3 {
                          const double x = n >= 6 ? 2.5 : n % 2 - 1.0;
                          const double y = n >= 6 ? n - 6 : n / 2;
                          return {x, y, 0.1 * k};
                        }));
  };
  const QualityReport apart = judge(blocks_of(false)).report;
  CHECK(apart.side_growth_max == doctest::Approx(1).epsilon(kRounding));
  const QualityReport joined = judge(blocks_of(true)).report;
  CHECK(joined.side_growth_max == doctest::Approx(2.5).epsilon(kRounding));
  for (const QualityMinima& patch : joined.patches) {
    CHECK(patch.side_growth_max == joined.side_growth_max);
  }
}

TEST_CASE("judge: the report counts bad cells, and knows first cells and growth") {
  MultiBlock mesh = wavy_plate(5, 4, 3);
  Layers& layers = mesh.layers;
  for (int n = 0; n < mesh.nodes(); ++n) {  // flat, growing by 1.5 and then by 2
    const double first = 0.01 * (n + 1);
    Vec3* column = &layers.points_world[static_cast<std::size_t>(4 * n)];
    column[0] = Vec3(n % 5, n / 5, 0);
    column[1] = column[0] + first * Vec3::UnitZ();
    column[2] = column[1] + 1.5 * first * Vec3::UnitZ();
    column[3] = column[2] + 3.0 * first * Vec3::UnitZ();
    layers.first_cell_world[static_cast<std::size_t>(n)] = first;
  }
  const QualityReport good = judge(mesh).report;
  CHECK(good.nonpositive_cells == 0);
  CHECK(good.growth_max == doctest::Approx(2).epsilon(1e3 * kRounding));
  CHECK(good.first_cell_min == 0.01);
  CHECK(good.first_cell_max == 0.01 * 20);
  CHECK(good.first_cell_median == doctest::Approx(0.105).epsilon(kRounding));

  // one inner node of level 1 pushed below the wall spoils the four cells under it
  layers.points_world[4 * (1 * 5 + 2) + 1].z() = -0.5;
  const QualityField bad = judge(mesh);
  CHECK(bad.report.nonpositive_cells == 4);
  CHECK(bad.report.min_scaled_jacobian < 0);
  const std::vector<CellPlace> named = nonpositive_cells(mesh, bad, 100);
  REQUIRE(named.size() == 4);
  for (const CellPlace& cell : named) {
    CHECK(cell.block == 0);
    CHECK((cell.i == 1 || cell.i == 2));
    CHECK((cell.j == 0 || cell.j == 1));
    CHECK(cell.k == 0);
  }
  CHECK(nonpositive_cells(mesh, bad, 3).size() == 3);
}

TEST_CASE("judge: the same bits on one thread and on four") {
  const MultiBlock mesh = wavy_plate(40, 30, 45);
  const QualityField one = on_threads(1, [&] { return judge(mesh); });
  const QualityField four = on_threads(4, [&] { return judge(mesh); });
  CHECK(one.scaled_jacobian == four.scaled_jacobian);
  CHECK(one.report.mean_scaled_jacobian == four.report.mean_scaled_jacobian);
  check_same(one.report, four.report);
  for (std::size_t k = 0; k < one.report.levels.size(); ++k) {
    check_same(one.report.levels[k], four.report.levels[k]);
    CHECK(one.report.levels[k].growth_max == four.report.levels[k].growth_max);
    CHECK(one.report.levels[k].side_growth_max == four.report.levels[k].side_growth_max);
  }
  const auto fields = [&] { return cell_fields(mesh, mesh.blocks[0]); };
  const CellFields first = on_threads(1, fields);
  const CellFields second = on_threads(4, fields);
  CHECK(first.volume == second.volume);
  CHECK(first.growth == second.growth);
  CHECK(first.skewness == second.skewness);
}

TEST_CASE("coverage: reached over requested height, each node of a block once") {
  Surface surface;
  add_patch(surface, "pole", 2, 3, {0, 1, 0, 2, 0, 3});  // node 0 three times
  Layers layers = any_layers(4, 1);
  layers.distance_world = 2;
  layers.asked_world.assign(4, 2);
  layers.height_world = {0.5, 1.0, 2.0, 2.0000001};
  const MultiBlock mesh = build_blocks(surface, std::move(layers));
  const std::vector<Coverage> result = coverage(mesh);
  REQUIRE(result.size() == 1);
  CHECK(result[0].min == 0.25);
  CHECK(result[0].mean == (0.25 + 0.5 + 1 + 1) / 4);
}

}  // namespace
}  // namespace vdb_offset::test
