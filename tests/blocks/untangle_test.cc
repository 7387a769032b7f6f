// The parts of the repair: energy, its derivatives, the linear system.

#include "blocks/untangle.h"

#include <doctest/doctest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <random>

#include "blocks/triad_energy.h"
#include "blocks/window.h"

namespace vdb_offset::test {
namespace {

constexpr std::size_t kLevels = 4;
constexpr auto kWhole = [](std::size_t) { return false; };  // faces that are in tetrahedra

/// One face of four free columns, points moved at random; edges of length 2 and 1, layers of 0.5.
struct Stack {
  Window window;
  ColumnVector x{4, kLevels};
  std::vector<double> heights{0, 0.5, 1, 1.5};
  std::vector<double> first = std::vector<double>(kLevels, 2.0);
  std::vector<double> second = std::vector<double>(kLevels, 1.0);

  explicit Stack(double noise) {
    window.nodes = {0, 1, 2, 3};
    window.free = 4;
    window.faces = {{{0, 1, 2, 3}, 4}};
    std::mt19937 random(7);
    std::uniform_real_distribution<double> shift(-noise, noise);
    const std::array<Vec3, 4> foot{Vec3(0, 0, 0), Vec3(2, 0, 0), Vec3(2, 1, 0), Vec3(0, 1, 0)};
    for (std::size_t c = 0; c < 4; ++c) {
      for (std::size_t k = 0; k < kLevels; ++k) {
        const Vec3 off(shift(random), shift(random), shift(random));
        x.set(c, k, foot[c] + heights[k] * Vec3::UnitZ() + (k > 0 ? off : Vec3(Vec3::Zero())));
      }
    }
  }
  /// The corner of column 0, below or above.
  Triad corner(int up) const {
    Triad triad;
    triad.points = {{{0, up}, {1, up}, {3, up}, {0, 1 - up}}};
    triad.edges[0] = {0, 1, &first, static_cast<std::size_t>(up)};
    triad.edges[1] = {0, 2, &second, static_cast<std::size_t>(up)};
    triad.edges[2] = up == 0 ? Triad::Edge{0, 3} : Triad::Edge{3, 0};
    triad.heights_world = &heights;
    return triad;
  }
};

double dot(const ColumnVector& a, const ColumnVector& b) {
  double sum = 0;
  for (std::size_t n = 0; n < a.values().size(); ++n) sum += a.values()[n] * b.values()[n];
  return sum;
}

/// Random above the wall.
ColumnVector random_vector(unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> number(-1, 1);
  ColumnVector v(4, kLevels);
  for (std::size_t c = 0; c < 4; ++c) {
    for (std::size_t k = 1; k < kLevels; ++k) {
      v.set(c, k, {number(random), number(random), number(random)});
    }
  }
  return v;
}

/// Cubes apart, the first ones upside down.
WindowShape cubes(std::size_t count, std::size_t inverted) {
  WindowShape shape;
  shape.points_world = ColumnVector(4 * count, 2);
  for (std::size_t f = 0; f < count; ++f) {
    const int first = static_cast<int>(4 * f);
    shape.window.faces.push_back({{first, first + 1, first + 2, first + 3}, 4});
    for (std::size_t c = 0; c < 4; ++c) {
      const Vec3 foot(c == 1 || c == 2 ? 1 : 0, c > 1 ? 1 : 0, 0);
      shape.points_world.set(4 * f + c, 0, foot);
      shape.points_world.set(4 * f + c, 1, foot + (f < inverted ? -1 : 1) * Vec3::UnitZ());
      shape.window.nodes.push_back(first + static_cast<int>(c));
    }
  }
  return shape;
}

}  // namespace

TEST_CASE("triad energy: it is 1 a cell, and at rest, where cells are ideal") {
  const Stack stack(0);
  for (const int up : {0, 1}) {
    ColumnVector gradient(4, kLevels);
    ColumnSystem system(stack.window, kLevels, kWhole);
    TriadEnergy energy(kLevels, 1e-9);
    const TriadEnergy::Sum sum = energy.expand(stack.corner(up), stack.x, {gradient, system});
    CHECK(sum.energy == doctest::Approx(kLevels - 1.0).epsilon(1e-12));
    CHECK(sum.least == doctest::Approx(1).epsilon(1e-12));
    CHECK(std::sqrt(dot(gradient, gradient)) < 1e-12);
  }
}

TEST_CASE("triad energy: its gradient is that of its values") {
  for (const double noise : {0.1, 0.6}) {  // the latter inverts corners
    const Stack stack(noise);
    const ColumnVector direction = random_vector(3);
    for (const int up : {0, 1}) {
      TriadEnergy energy(kLevels, 0.3);
      ColumnVector gradient(4, kLevels);
      ColumnSystem system(stack.window, kLevels, kWhole);
      energy.expand(stack.corner(up), stack.x, {gradient, system});
      const double h = 1e-5;
      std::array<double, 2> ends{};
      for (std::size_t s = 0; s < 2; ++s) {
        ColumnVector moved = stack.x;
        for (std::size_t n = 0; n < moved.values().size(); ++n) {
          moved.values()[n] += (s == 0 ? -h : h) * direction.values()[n];
        }
        ends[s] = energy.value(stack.corner(up), moved).energy;
      }
      const double slope = (ends[1] - ends[0]) / (2 * h);
      CHECK(dot(gradient, direction) == doctest::Approx(slope).epsilon(1e-5));
    }
  }
}

TEST_CASE("triad energy: its curvature is never negative, and right along stretches of the ideal") {
  const Stack bent(0.6);
  ColumnVector gradient(4, kLevels);
  ColumnSystem system(bent.window, kLevels, kWhole);
  TriadEnergy energy(kLevels, 0.3);
  for (const int up : {0, 1}) energy.expand(bent.corner(up), bent.x, {gradient, system});
  for (unsigned seed = 1; seed < 50; ++seed) {
    const ColumnVector v = random_vector(seed);
    ColumnVector product(4, kLevels);
    system.multiply(v, product);
    CHECK(dot(v, product) >= -1e-9 * dot(v, v));
  }
}

TEST_CASE("column system: the matrix is symmetric, and the columns' factors undo it alone") {
  const Stack stack(0.2);
  ColumnVector gradient(4, kLevels);
  ColumnSystem system(stack.window, kLevels, [](std::size_t) { return true; });
  TriadEnergy energy(kLevels, 0.3);
  for (const int up : {0, 1}) energy.expand(stack.corner(up), stack.x, {gradient, system});
  for (std::size_t c = 0; c < 4; ++c) {
    for (std::size_t k = 1; k < kLevels; ++k) {
      system.add_diagonal(c, k, Eigen::Matrix3d::Identity());
    }
  }
  const ColumnVector a = random_vector(11);
  const ColumnVector b = random_vector(12);
  ColumnVector pa(4, kLevels);
  ColumnVector pb(4, kLevels);
  system.multiply(a, pa);
  system.multiply(b, pb);
  CHECK(dot(b, pa) == doctest::Approx(dot(a, pb)).epsilon(1e-12));
  // A vector on column 0 alone sees that column's blocks alone there.
  ColumnVector one(4, kLevels);
  for (std::size_t k = 1; k < kLevels; ++k) one.set(0, k, a.get(0, k));
  ColumnVector product(4, kLevels);
  system.multiply(one, product);
  for (std::size_t c = 1; c < 4; ++c) {
    for (std::size_t k = 0; k < kLevels; ++k) product.set(c, k, Vec3::Zero());
  }
  system.factor_columns();
  ColumnVector back(4, kLevels);
  system.solve_columns(product, back);
  for (std::size_t k = 1; k < kLevels; ++k) {
    CHECK((back.get(0, k) - one.get(0, k)).norm() < 1e-9);
  }
}

TEST_CASE("untangle: a large window is given up soon where much of it stays inverted") {
  CHECK(is_hopeless(cubes(5000, 650), 5));
  CHECK(!is_hopeless(cubes(5000, 550), 5));  // the draft tube has had 6 % left by then
  CHECK(!is_hopeless(cubes(500, 35), 5));    // it costs little
  CHECK(is_hopeless(cubes(5000, 260), 10));
  CHECK(!is_hopeless(cubes(5000, 240), 10));
  CHECK(!is_hopeless(cubes(5000, 0), 20));
}

}  // namespace vdb_offset::test
