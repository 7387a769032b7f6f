#include "vdb_offset/blocks/quality.h"

#include <doctest/doctest.h>

#include <Eigen/Dense>
#include <cmath>
#include <fstream>
#include <limits>
#include <numbers>
#include <random>
#include <sstream>

#include "support/hand_made.h"
#include "support/threads.h"
#include "support/vtk_python.h"
#include "vdb_offset/core/units.h"

namespace vdb_offset::test {
namespace {

using Cell = std::array<Vec3, 8>;

constexpr double kRounding = 64 * std::numeric_limits<double>::epsilon();

/// The parallelepiped of three edges, in VTK's order.
Cell parallelepiped(const Vec3& a, const Vec3& b, const Vec3& c) {
  const Vec3 o(0.3, -0.7, 0.2);
  return {o, o + a, o + a + b, o + b, o + c, o + a + c, o + a + b + c, o + b + c};
}

Cell unit_cube() { return parallelepiped(Vec3::UnitX(), Vec3::UnitY(), Vec3::UnitZ()); }

/// The same solid with its indices turned: i -> j -> k -> i, which keeps the handedness.
Cell turned(const Cell& c) { return {c[0], c[3], c[7], c[4], c[1], c[2], c[6], c[5]}; }

/// A prism over a triangle, as the hexahedron whose base has corner `twice` doubled.
Cell prism(const std::array<Vec3, 3>& triangle, double height, std::size_t twice) {
  Cell cell;
  for (std::size_t n = 0, t = 0; n < 4; ++n) {
    cell[n] = triangle[t];
    cell[n + 4] = triangle[t] + height * Vec3::UnitZ();
    if (n != twice) t = (t + 1) % 3;
  }
  return cell;
}

double angle(const Vec3& at, const Vec3& a, const Vec3& b) {
  return std::acos((a - at).normalized().dot((b - at).normalized()));
}

Cell random_cell(std::mt19937_64& random, double spread) {
  std::uniform_real_distribution<double> shift(-spread, spread);
  Cell cell = unit_cube();
  for (Vec3& p : cell) p += Vec3(shift(random), shift(random), shift(random));
  return cell;
}

TEST_CASE("quality: a cube is perfect") {
  const CellQuality q = cell_quality(unit_cube());
  CHECK(q.scaled_jacobian == doctest::Approx(1).epsilon(kRounding));
  CHECK(q.min_jacobian == doctest::Approx(1).epsilon(kRounding));
  CHECK(q.volume == doctest::Approx(1).epsilon(kRounding));
  CHECK(q.positive);
}

TEST_CASE("quality: a parallelepiped has the triple product as volume and Jacobian") {
  const Vec3 a(2, 0.1, 0.3);
  const Vec3 b(-0.4, 0.7, 0.2);
  const Vec3 c(0.5, 0.6, 1.1);
  const double volume = a.cross(b).dot(c);
  const CellQuality q = cell_quality(parallelepiped(a, b, c));
  CHECK(q.volume == doctest::Approx(volume).epsilon(kRounding));
  CHECK(q.min_jacobian == doctest::Approx(volume).epsilon(kRounding));
  const double scaled = volume / (a.norm() * b.norm() * c.norm());
  CHECK(q.scaled_jacobian == doctest::Approx(scaled).epsilon(kRounding));

  SUBCASE("and its mirror image the same below zero") {
    const CellQuality m = cell_quality(parallelepiped(b, a, c));
    CHECK(m.volume == doctest::Approx(-volume).epsilon(kRounding));
    CHECK(m.scaled_jacobian == doctest::Approx(-scaled).epsilon(kRounding));
    CHECK_FALSE(m.positive);
  }
}

TEST_CASE("quality: thin cells keep their quality") {
  const double thin = 1e-6;
  const CellQuality q =
      cell_quality(parallelepiped(Vec3::UnitX(), Vec3::UnitY(), thin * Vec3::UnitZ()));
  // the corners' coordinates carry one rounding error of size 1, which the thin side feels
  CHECK(q.scaled_jacobian == doctest::Approx(1).epsilon(kRounding));
  CHECK(q.volume == doctest::Approx(thin).epsilon(kRounding / thin));
  CHECK(q.positive);
}

TEST_CASE("quality: size does not matter, nor the order of the axes") {
  std::mt19937_64 random(7);
  for (int n = 0; n < 200; ++n) {
    const Cell cell = random_cell(random, 0.5);
    const CellQuality q = cell_quality(cell);
    for (const int power : {-60, 60}) {  // exact in binary
      Cell scaled = cell;
      for (Vec3& p : scaled) p *= std::ldexp(1.0, power);
      const CellQuality s = cell_quality(scaled);
      CHECK(s.scaled_jacobian == q.scaled_jacobian);
      CHECK(s.volume == std::ldexp(q.volume, 3 * power));
      CHECK(s.positive == q.positive);
    }
    const CellQuality t = cell_quality(turned(cell));
    CHECK(std::abs(t.scaled_jacobian - q.scaled_jacobian) < kRounding);
    CHECK(std::abs(t.volume - q.volume) < kRounding);
    CHECK(t.positive == q.positive);
  }
}

TEST_CASE("quality: one corner pushed through the opposite face makes a cell not positive") {
  Cell cell = unit_cube();
  CHECK(cell_quality(cell).positive);
  cell[6] -= 1.5 * Vec3::Ones();
  const CellQuality q = cell_quality(cell);
  CHECK_FALSE(q.positive);
  CHECK(q.min_jacobian < 0);
}

TEST_CASE("quality: a cell with a collapsed side is the prism that it is") {
  const std::array<Vec3, 3> triangle{Vec3(0, 0, 0), Vec3(1.3, 0.2, 0), Vec3(0.4, 0.9, 0)};
  const double height = 0.01;
  const Vec3 u = triangle[1] - triangle[0];
  const Vec3 v = triangle[2] - triangle[0];
  const double area = 0.5 * u.cross(v).z();
  double sharpest = 1;
  for (std::size_t n = 0; n < 3; ++n) {
    const double corner = angle(triangle[n], triangle[(n + 1) % 3], triangle[(n + 2) % 3]);
    sharpest = std::min(sharpest, std::sin(corner));
  }
  for (std::size_t twice = 0; twice < 4; ++twice) {
    Cell cell = prism(triangle, height, twice);
    for (int turn = 0; turn < 3; ++turn, cell = turned(cell)) {
      CAPTURE(twice);
      CAPTURE(turn);
      const CellQuality q = cell_quality(cell);
      CHECK(q.positive);
      CHECK(q.volume == doctest::Approx(area * height).epsilon(kRounding / height));
      CHECK(q.min_jacobian == doctest::Approx(2 * area * height).epsilon(kRounding / height));
      CHECK(q.scaled_jacobian == doctest::Approx(sharpest).epsilon(kRounding / height));
    }
    CHECK_FALSE(cell_quality(prism(triangle, -height, twice)).positive);
  }
}

TEST_CASE("quality: a cell with a face collapsed to a point is the pyramid that it is") {
  const double height = 0.8;
  const std::array<Vec3, 4> base{Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(1, 1, 0), Vec3(0, 1, 0)};
  Cell standing;
  Cell hanging;
  for (std::size_t n = 0; n < 4; ++n) {
    standing[n] = hanging[n + 4] = base[n];
    standing[n + 4] = Vec3(0.5, 0.5, height);
    hanging[n] = Vec3(0.5, 0.5, -height);
  }
  // three edges of length `slant` meet at the apex and span the same volume as at the base
  const double slant = std::sqrt(0.5 + height * height);
  const double expected = std::min(height / slant, height / (slant * slant * slant));
  for (Cell pyramid : {standing, hanging}) {
    for (int turn = 0; turn < 3; ++turn, pyramid = turned(pyramid)) {
      const CellQuality q = cell_quality(pyramid);
      CHECK(q.positive);
      CHECK(q.volume == doctest::Approx(height / 3).epsilon(kRounding));
      CHECK(q.min_jacobian == doctest::Approx(height).epsilon(kRounding));
      CHECK(q.scaled_jacobian == doctest::Approx(expected).epsilon(kRounding));
    }
  }
}

TEST_CASE("quality: a cell without volume, or without numbers, is not positive") {
  Cell point;
  point.fill(Vec3(1, 2, 3));
  Cell flat = unit_cube();  // top on bottom
  for (std::size_t n = 0; n < 4; ++n) flat[n + 4] = flat[n];
  Cell line = unit_cube();  // two sides collapsed
  for (const std::size_t n : {1U, 2U, 5U, 6U}) line[n] = line[n == 1 || n == 2 ? 0 : 4];
  line[3] = line[0];
  line[7] = line[4];
  for (const Cell& cell : {point, flat, line}) {
    const CellQuality q = cell_quality(cell);
    CHECK_FALSE(q.positive);
    CHECK(q.volume == 0);
    CHECK(std::isfinite(q.scaled_jacobian));
    CHECK(std::isfinite(q.min_jacobian));
  }
  for (std::size_t n = 0; n < 8; ++n) {
    for (const double bad : {std::nan(""), std::numeric_limits<double>::infinity()}) {
      Cell cell = unit_cube();
      cell[n].y() = bad;
      const CellQuality q = cell_quality(cell);
      CHECK_FALSE(q.positive);
      CHECK(q.scaled_jacobian == -1);
    }
  }
}

TEST_CASE("quality: VTK finds the same scaled Jacobian, centre included") {
  if (!has_vtk()) {
    MESSAGE("skipped: VTK's Python is not installed");
    return;
  }
  const TempFolder folder;
  std::mt19937_64 random(11);
  std::vector<double> ours;
  {
    std::ofstream cells(folder / "cells.txt");
    cells.precision(17);
    for (int n = 0; n < 1000; ++n) {
      // well shaped, bent, and tangled ones, where the centre can be the worst place
      const Cell cell = random_cell(random, n < 400 ? 0.25 : n < 800 ? 0.5 : 1.5);
      ours.push_back(cell_quality(cell).scaled_jacobian);
      for (const Vec3& p : cell) cells << p.x() << ' ' << p.y() << ' ' << p.z() << '\n';
    }
  }
  std::istringstream theirs(run_vtk(folder, R"(
points = vtk.vtkPoints()
points.SetDataTypeToDouble()
for line in open('cells.txt'):
    points.InsertNextPoint([float(x) for x in line.split()])
grid = vtk.vtkUnstructuredGrid()
grid.SetPoints(points)
for n in range(points.GetNumberOfPoints() // 8):
    grid.InsertNextCell(vtk.VTK_HEXAHEDRON, 8, list(range(8 * n, 8 * n + 8)))
judge = vtk.vtkMeshQuality()
judge.SetInputData(grid)
judge.SetHexQualityMeasureToScaledJacobian()
judge.Update()
quality = judge.GetOutput().GetCellData().GetArray('Quality')
for n in range(quality.GetNumberOfTuples()):
    print(repr(quality.GetValue(n)))
)"));
  std::size_t compared = 0;
  for (double value = 0; theirs >> value; ++compared) {
    REQUIRE(compared < ours.size());
    CHECK(std::abs(value - ours[compared]) < kRounding);
  }
  CHECK(compared == ours.size());
}

TEST_CASE("judge: every cell is judged in its place, i fastest, then j, then k") {
  const MultiBlock mesh = wavy_plate(6, 5, 7);
  const Block& block = mesh.blocks[0];
  const QualityField field = judge(mesh);
  std::size_t cell = 0;
  double least = 1;
  double sum = 0;
  for (int k = 0; k + 1 < block.nk; ++k) {
    for (int j = 0; j + 1 < block.nj; ++j) {
      for (int i = 0; i + 1 < block.ni; ++i, ++cell) {
        const auto p = [&](int a, int b, int c) { return mesh.point(block, i + a, j + b, k + c); };
        const CellQuality q = cell_quality({p(0, 0, 0), p(1, 0, 0), p(1, 1, 0), p(0, 1, 0),
                                            p(0, 0, 1), p(1, 0, 1), p(1, 1, 1), p(0, 1, 1)});
        CHECK(field.scaled_jacobian[0][cell] == static_cast<float>(q.scaled_jacobian));
        CHECK(field.volume[0][cell] == static_cast<float>(q.volume));
        least = std::min(least, q.scaled_jacobian);
        sum += q.scaled_jacobian;
      }
    }
  }
  REQUIRE(field.volume[0].size() == cell);
  CHECK(field.report.min_scaled_jacobian == least);
  const double mean = sum / static_cast<double>(cell);
  CHECK(field.report.mean_scaled_jacobian ==
        doctest::Approx(mean).epsilon(kRounding * static_cast<double>(cell)));
  CHECK(field.report.nonpositive_cells == 0);
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
  const QualityReport bad = judge(mesh).report;
  CHECK(bad.nonpositive_cells == 4);
  CHECK(bad.min_scaled_jacobian < 0);
}

TEST_CASE("judge: the same bits on one thread and on four") {
  const MultiBlock mesh = wavy_plate(40, 30, 20);
  const QualityField one = on_threads(1, [&] { return judge(mesh); });
  const QualityField four = on_threads(4, [&] { return judge(mesh); });
  CHECK(one.scaled_jacobian == four.scaled_jacobian);
  CHECK(one.volume == four.volume);
  CHECK(one.report.mean_scaled_jacobian == four.report.mean_scaled_jacobian);
  CHECK(one.report.min_volume == four.report.min_volume);
  CHECK(one.report.growth_max == four.report.growth_max);
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
