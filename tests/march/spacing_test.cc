#include "vdb_offset/march/spacing.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <string>

#include "vdb_offset/core/error.h"

using namespace vdb_offset;

namespace {

/// Relative accuracy that the header promises for first cell and height.
constexpr double kPromise = 1e-14;
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

std::string message_of(double height, const SpacingOptions& options) {
  try {
    solve_spacing(height, options);
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

bool mentions(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

double cell(const std::vector<double>& levels, int k) {
  return levels[static_cast<std::size_t>(k) + 1] - levels[static_cast<std::size_t>(k)];
}

bool rises(const std::vector<double>& levels) {
  return std::adjacent_find(levels.begin(), levels.end(), std::greater_equal<>()) == levels.end();
}

/// Worst departure of neighbouring ratios from `ratio`, with the rounding of the levels allowed
/// for.
double ratio_error(const LayerSpacing& s, double ratio) {
  double worst = 0;
  for (int k = 0; k + 1 < s.layers; ++k) {
    const double a = cell(s.heights_world, k);
    const double b = cell(s.heights_world, k + 1);
    const double rounding = 8e-16 * s.heights_world[static_cast<std::size_t>(k) + 2] / a;
    worst = std::max(worst, std::abs(b / a - ratio) / ratio - 4 * rounding);
  }
  return worst;
}

void check_law(const LayerSpacing& s, double height) {
  CHECK(s.heights_world.size() == static_cast<std::size_t>(s.layers) + 1);
  CHECK(s.heights_world.front() == 0.0);
  CHECK(s.heights_world.back() == height);
  CHECK(rises(s.heights_world));
  CHECK(std::abs(s.heights_world[1] / s.first_cell_world - 1) <= kPromise * s.layers);
}

}  // namespace

TEST_CASE("spacing: 80 layers from 4e-6 to 1100 grow by 1.25324") {
  SpacingOptions options;
  options.layers = 80;
  options.first_cell_world = 4e-6;
  const LayerSpacing s = solve_spacing(1100, options);
  CHECK(std::abs(s.growth - 1.25324) < 5e-6);
  CHECK(s.growth_requested == 0.0);
  check_law(s, 1100);
}

TEST_CASE("spacing: without wishes there are 32 layers with growth 1.2") {
  const LayerSpacing s = solve_spacing(2.0, {});
  CHECK(s.layers == 32);
  CHECK(s.growth == 1.2);
  check_law(s, 2.0);
  CHECK(ratio_error(s, 1.2) < 1e-12);
}

TEST_CASE("spacing: layers and growth give the first cell of the geometric series") {
  SpacingOptions options;
  options.layers = 10;
  options.growth = 2.0;
  const LayerSpacing s = solve_spacing(1023.0, options);  // 2^10 - 1
  CHECK(std::abs(s.first_cell_world - 1.0) <= kPromise);
  CHECK(std::abs(s.last_cell_world - 512.0) <= 512 * kPromise);
  check_law(s, 1023.0);
}

TEST_CASE("spacing: growth alone takes 32 layers, first cell alone growth 1.2 rounded up") {
  SpacingOptions options;
  options.growth = 1.1;
  CHECK(solve_spacing(1, options).layers == 32);
  options = {};
  options.first_cell_world = 0.01;
  const LayerSpacing s = solve_spacing(1, options);
  // (1.2^n - 1) / 0.2 = 100 at n = 16.7
  CHECK(s.layers == 17);
  CHECK(s.growth_requested == 1.2);
  CHECK(s.growth < 1.2);
  CHECK(s.growth > 1.18);
  check_law(s, 1);
}

TEST_CASE("spacing: first cell and growth that divide the height need no rounding up") {
  SpacingOptions options;
  options.first_cell_world = 1.0;
  options.growth = 2.0;
  CHECK(solve_spacing(1023.0, options).layers == 10);
  CHECK(std::abs(solve_spacing(1023.0, options).growth - 2.0) < 1e-14);
  CHECK(solve_spacing(1023.1, options).layers == 11);
  options.growth = 1.0;
  options.first_cell_world = 0.1;
  CHECK(solve_spacing(1.0, options).layers == 10);
  CHECK(solve_spacing(1.0, options).growth == 1.0);
}

TEST_CASE("spacing: equal cells that do not divide the height shrink a little") {
  SpacingOptions options;
  options.first_cell_world = 0.3;
  options.growth = 1.0;
  const LayerSpacing s = solve_spacing(1.0, options);
  CHECK(s.layers == 4);
  CHECK(s.growth < 1);
  check_law(s, 1.0);
  CHECK(ratio_error(s, s.growth) < 1e-12);
  options.first_cell_world = 0.99;  // a second cell would be a sliver
  CHECK(mentions(message_of(1.0, options), "sliver"));
}

TEST_CASE("spacing: three wishes must agree, and the message says what each would become") {
  SpacingOptions options;
  options.layers = 10;
  options.first_cell_world = 1.0;
  options.growth = 2.0;
  CHECK(solve_spacing(1023.0 * (1 + 5e-7), options).layers == 10);
  const std::string text = message_of(2000.0, options);
  CHECK(mentions(text, "1023"));
  CHECK(mentions(text, "2000"));
  CHECK(mentions(text, "without layers: 11 layers"));
  CHECK(mentions(text, "first cell 1.95503"));  // 2000 / 1023
  SpacingOptions dropped = options;
  dropped.growth.reset();
  dropped.max_growth = 10;
  const LayerSpacing s = solve_spacing(2000.0, dropped);
  CHECK(mentions(text, "growth " + std::to_string(s.growth).substr(0, 6)));
}

TEST_CASE("spacing: layers that do not fit are refused with what would fit") {
  SpacingOptions options;
  options.layers = 10;
  options.first_cell_world = 0.3;
  const std::string text = message_of(1.0, options);
  CHECK(mentions(text, "at most 3 such layers"));
  CHECK(mentions(text, "at most 0.1"));
  options.first_cell_world = 0.1;  // exactly equal cells
  CHECK(solve_spacing(1.0, options).growth == 1.0);
}

TEST_CASE("spacing: too large a growth is refused, and both ways out work") {
  SpacingOptions options;
  options.layers = 5;
  options.first_cell_world = 1e-4;
  const std::string text = message_of(1.0, options);
  // 1e-4 (2^n - 1) >= 1 from n = 14; 1 / (2^5 - 1) = 0.0322581
  CHECK(mentions(text, "at least 14 layers"));
  CHECK(mentions(text, "0.0322581"));
  options.layers = 14;
  CHECK(solve_spacing(1.0, options).growth <= 2.0);
  options.layers = 13;
  CHECK_THROWS_AS(solve_spacing(1.0, options), InputError);
  options.layers = 5;
  options.first_cell_world = 1.0 / 31;
  CHECK(std::abs(solve_spacing(1.0, options).growth - 2.0) < 1e-12);
}

TEST_CASE("spacing: one layer is the whole height") {
  SpacingOptions options;
  options.layers = 1;
  CHECK(solve_spacing(3.0, options).first_cell_world == 3.0);
  options.first_cell_world = 3.0;
  CHECK(solve_spacing(3.0, options).heights_world == std::vector<double>{0.0, 3.0});
  options.first_cell_world = 2.0;
  CHECK_THROWS_AS(solve_spacing(3.0, options), InputError);
  options.first_cell_world = 4.0;
  CHECK_THROWS_AS(solve_spacing(3.0, options), InputError);
}

TEST_CASE("spacing: a last cell bends the law, and c = 0 is the geometric series") {
  SpacingOptions options;
  options.layers = 40;
  options.first_cell_world = 1e-3;
  const LayerSpacing plain = solve_spacing(2.0, options);
  options.last_cell_world = plain.last_cell_world;
  const LayerSpacing same = solve_spacing(2.0, options);
  CHECK(std::abs(same.curvature) < 1e-14);
  for (const double factor : {0.4, 0.8, 1.3}) {
    CAPTURE(factor);
    options.last_cell_world = factor * plain.last_cell_world;
    const LayerSpacing s = solve_spacing(2.0, options);
    check_law(s, 2.0);
    CHECK(std::abs(cell(s.heights_world, 39) / *options.last_cell_world - 1) < 1e-12);
    // Second differences of the logarithm are -2c throughout: the law itself.
    for (int k = 1; k < 39; ++k) {
      const double bend = std::log(cell(s.heights_world, k + 1)) +
                          std::log(cell(s.heights_world, k - 1)) -
                          2 * std::log(cell(s.heights_world, k));
      CHECK(std::abs(bend + 2 * s.curvature) < 1e-11);
    }
    CHECK((s.curvature > 0) == (factor < 1));
  }
  options.last_cell_world = 2.5;
  CHECK(mentions(message_of(2.0, options), "2.5"));
  options.last_cell_world = 1e-9;
  CHECK(mentions(message_of(2.0, options), "without a last cell it would be"));
}

TEST_CASE("spacing: a last cell needs layers and first cell, and excludes a growth") {
  SpacingOptions options;
  options.last_cell_world = 0.1;
  CHECK(mentions(message_of(1.0, options), "needs the number of layers"));
  options.layers = 20;
  options.first_cell_world = 0.01;
  options.growth = 1.1;
  CHECK(mentions(message_of(1.0, options), "drop"));
}

TEST_CASE("spacing: values out of range and NaN are refused by name") {
  const auto refused = [](const char* name, auto&& set) {
    CAPTURE(name);
    SpacingOptions options;
    set(options);
    CHECK(mentions(message_of(1.0, options), name));
  };
  refused("layers = 0", [](SpacingOptions& o) { o.layers = 0; });
  refused("layers = 10001", [](SpacingOptions& o) { o.layers = 10001; });
  refused("first_cell_world = 0", [](SpacingOptions& o) { o.first_cell_world = 0.0; });
  refused("first_cell_world = nan", [](SpacingOptions& o) { o.first_cell_world = kNan; });
  refused("growth = 0.9", [](SpacingOptions& o) { o.growth = 0.9; });
  refused("growth = nan", [](SpacingOptions& o) { o.growth = kNan; });
  refused("growth = 3", [](SpacingOptions& o) { o.growth = 3.0; });
  refused("max_growth = 1", [](SpacingOptions& o) { o.max_growth = 1.0; });
  refused("max_growth = nan", [](SpacingOptions& o) { o.max_growth = kNan; });
  refused("last_cell_world = nan", [](SpacingOptions& o) { o.last_cell_world = kNan; });
  for (const double height : {0.0, -1.0, kNan, std::numeric_limits<double>::infinity()}) {
    CHECK_THROWS_AS(solve_spacing(height, {}), InputError);
  }
}

TEST_CASE("spacing: a first cell lost in rounding is refused") {
  SpacingOptions options;
  options.layers = 500;
  options.growth = 1.2;  // 1.2^-500 = 2.6e-40
  CHECK(mentions(message_of(1.0, options), "lost in rounding"));
}

TEST_CASE("spacing: random wishes are met, from any two of the three") {
  std::mt19937 random(20240611);
  std::uniform_real_distribution<double> unit(0, 1);
  int solved = 0;
  for (int round = 0; round < 3000; ++round) {
    const int n = 1 + static_cast<int>(std::pow(2000.0, unit(random)));
    // Growth as near to 1 as 1e-9, and first cells down to 1e-9 of the height.
    const double b = std::min(std::pow(10.0, -9 + 8.5 * unit(random)), 20.0 / n);
    const double height = std::pow(10.0, -4 + 8 * unit(random));
    SpacingOptions options;
    options.layers = n;
    options.growth = std::exp(b);
    const LayerSpacing first = solve_spacing(height, options);
    CAPTURE(n);
    CAPTURE(b);
    CAPTURE(height);
    check_law(first, height);
    options.growth.reset();
    options.first_cell_world = first.first_cell_world;
    const LayerSpacing growth = solve_spacing(height, options);
    check_law(growth, height);
    // Sums differ by rounding only; a sum's derivative by b is at least (n - 1) / 2 of itself.
    CHECK(std::abs(std::log(growth.growth) - b) <= (100 + 4 * b * n) * 2.3e-16);
    options.layers.reset();
    options.growth = std::exp(b) * (1 + 1e-15 + 1e-9 / n);
    const LayerSpacing layers = solve_spacing(height, options);
    CHECK(layers.layers == n);
    ++solved;
  }
  CHECK(solved == 3000);
}

TEST_CASE("squeeze: the first cell is kept while the layers fit, then all are equal") {
  SpacingOptions options;
  options.layers = 48;
  options.first_cell_world = 1e-3;
  const LayerSpacing full = solve_spacing(2.0, options);
  CHECK(squeeze(full, 2.0) == full.heights_world);
  std::mt19937 random(7);
  std::uniform_real_distribution<double> part(0.001, 1);
  for (int round = 0; round < 500; ++round) {
    const double height = 2.0 * part(random);
    CAPTURE(height);
    const std::vector<double> levels = squeeze(full, height);
    CHECK(levels.size() == 49);
    CHECK(levels.front() == 0.0);
    CHECK(levels.back() == height);
    CHECK(rises(levels));
    const double first = std::min(1e-3, height / 48);
    CHECK(std::abs(levels[1] / first - 1) <= 48 * kPromise);
    CHECK(cell(levels, 47) >= cell(levels, 0) * (1 - 1e-11));
  }
}

TEST_CASE("squeeze: every law joins the full height, and equal cells, without a step") {
  for (const double last : {0.0, 0.05, 0.2}) {
    CAPTURE(last);
    SpacingOptions options;
    options.layers = 30;
    options.first_cell_world = 1e-3;
    if (last > 0) options.last_cell_world = last;
    const LayerSpacing full = solve_spacing(1.0, options);
    const double eps = 1e-9;
    const auto worst = [](const std::vector<double>& a, const std::vector<double>& b) {
      double w = 0;
      for (std::size_t k = 0; k < a.size(); ++k) w = std::max(w, std::abs(a[k] - b[k]));
      return w;
    };
    CHECK(worst(squeeze(full, 1.0 - eps), full.heights_world) < 100 * eps);
    CHECK(worst(squeeze(full, 0.03 + eps), squeeze(full, 0.03 - eps)) < 100 * eps);
    CHECK(rises(squeeze(full, 0.5)));
    CHECK(std::abs(squeeze(full, 0.5)[1] / 1e-3 - 1) < 30 * kPromise);
  }
}

TEST_CASE("squeeze: a law that shrinks outward keeps its proportions") {
  SpacingOptions options;
  options.first_cell_world = 0.3;
  options.growth = 1.0;
  const LayerSpacing full = solve_spacing(1.0, options);
  const std::vector<double> half = squeeze(full, 0.5);
  for (std::size_t k = 0; k < half.size(); ++k) {
    CHECK(std::abs(half[k] - 0.5 * full.heights_world[k]) <= 1e-15);
  }
}
