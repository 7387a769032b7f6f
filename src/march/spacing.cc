// The sum of a geometric series over N cells has no closed inverse in its ratio. Both laws solved
// here have the form log(sum of exp(a_k + x s_k)) = log(height / first cell): log-sum-exp is convex
// and rising in x, so that Newton's method started anywhere right of the root falls onto it without
// safeguards, for ratios near 1 and for first cells of 1e-10 alike.

#include "vdb_offset/march/spacing.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "vdb_offset/core/error.h"

namespace vdb_offset {
namespace {

constexpr int kMaxLayers = 10000;
constexpr int kDefaultLayers = 32;
constexpr double kDefaultGrowth = 1.2;
/// Three wishes at once agree when the height they give is within this of the height asked for.
constexpr double kConsistent = 1e-6;
/// A first cell below this part of the height drowns in the rounding of coordinates.
constexpr double kLeastFirstCell = 1e-13;

/// Logarithm of a sum, and its derivative by the unknown.
struct LogSum {
  double value;
  double slope;
};

/// log(1 + r + ... + r^(n-1)) for r = exp b. Mirrored for b > 0, where the powers overflow.
LogSum series(double b, int n) {
  if (std::abs(b) < 1e-9 / n) return {std::log(n) + 0.5 * (n - 1) * b, 0.5 * (n - 1)};
  const double m = -std::abs(b);
  const double top = std::expm1(n * m);
  const double bottom = std::expm1(m);
  const double slope = n * (1 + 1 / top) - (1 + 1 / bottom);
  if (b < 0) return {std::log(top / bottom), slope};
  return {std::log(top / bottom) + (n - 1) * b, (n - 1) - slope};
}

/// log of the sum of exp(b k + c k (n-1-k)); its slope by b, or by c.
LogSum quadratic(double b, double c, int n, bool by_c) {
  double sum = 0;
  double weighted = 0;
  for (int k = 0; k < n; ++k) {
    const double bow = static_cast<double>(k) * (n - 1 - k);
    const double term = std::exp(b * k + c * bow);
    sum += term;
    weighted += term * (by_c ? bow : k);
  }
  return {std::log(sum), weighted / sum};
}

/// Root of `law(x).value = target` for a convex, rising law, from a start right of it.
template <typename Law>
double newton(double x, double target, const Law& law) {
  for (int round = 0; round < 100; ++round) {
    const LogSum at = law(x);
    const double next = x - (at.value - target) / at.slope;
    // Monotone up to rounding: the first step that does not fall is noise.
    if (!(next < x)) break;
    x = next;
  }
  return x;
}

/// log of the ratio with which n cells from `first` fill `height`. n >= 2.
double solve_ratio(double height, double first, int n) {
  const double target = std::log(height / first);
  const double start = n * first > height ? 0.0 : target / (n - 1);
  return newton(start, target, [n](double b) { return series(b, n); });
}

double first_for(double height, double b, int n) { return height / std::exp(series(b, n).value); }

/// Real number of cells of ratio exp b that fill the height.
double layers_for(double height, double first, double b) {
  const double cells = height / first;
  return b < 1e-12 ? cells : std::log1p(cells * std::expm1(b)) / b;
}

int round_up(double layers) {
  return static_cast<int>(std::ceil(std::min(layers - 1e-9, kMaxLayers + 1.0)));
}

/// `first` and ratio exp b to the heights of the levels; the last is the height to the bit.
std::vector<double> geometric_levels(double height, double first, double b, int n) {
  std::vector<double> levels(static_cast<std::size_t>(n) + 1);
  const double unit = std::expm1(b);
  for (int k = 0; k < n; ++k) {
    levels[static_cast<std::size_t>(k)] =
        std::abs(b) < 1e-15 ? first * k : first * (std::expm1(k * b) / unit);
  }
  levels.back() = height;
  return levels;
}

std::vector<double> quadratic_levels(double height, double first, double b, double c, int n) {
  std::vector<double> levels(static_cast<std::size_t>(n) + 1);
  for (int k = 0; k + 1 < n; ++k) {
    const auto at = static_cast<std::size_t>(k);
    levels[at + 1] =
        levels[at] + first * std::exp(b * k + c * static_cast<double>(k) * (n - 1 - k));
  }
  levels.back() = height;
  return levels;
}

[[noreturn]] void refuse_thick(double height, double first, int n) {
  if (first > height) {
    throw InputError(fmt::format(
        "the first cell, {:.6g}, is larger than the distance, {:.6g}; {} layer{} need a first cell "
        "of at most {:.6g}",
        first, height, n, n == 1 ? "" : "s", height / n));
  }
  throw InputError(fmt::format(
      "{} layers of at least the first cell, {:.6g}, are {:.6g} high, but the distance is {:.6g}; "
      "at most {} such layers fit, or {} layers with a first cell of at most {:.6g}",
      n, first, n * first, height, static_cast<int>(height / first), n, height / n));
}

[[noreturn]] void refuse_growth(double height, double first, int n, const SpacingOptions& options) {
  const double limit = std::log(options.max_growth);
  const double enough = std::ceil(layers_for(height, first, limit) - 1e-9);
  const double growth = n > 1 ? std::exp(solve_ratio(height, first, n)) : 0.0;
  const std::string need = n > 1 ? fmt::format("need a growth of {:.6g}", growth)
                                 : std::string("cannot grow to fill it");
  throw InputError(fmt::format(
      "{} layer{} from a first cell of {:.6g} to a distance of {:.6g} {}, but the largest growth "
      "is {:.6g}; give at least {:.0f} layers, or a first cell of at least {:.6g}",
      n, n == 1 ? "" : "s", first, height, need, options.max_growth, enough,
      first_for(height, limit, n)));
}

[[noreturn]] void refuse_contradiction(double height, const SpacingOptions& options) {
  const int n = *options.layers;
  const double first = *options.first_cell_world;
  const double b = std::log(*options.growth);
  std::string drop_growth = "not possible, these layers do not fit";
  if (n > 1 && n * first <= height) {
    drop_growth = fmt::format("growth {:.6g}", std::exp(solve_ratio(height, first, n)));
  }
  throw InputError(fmt::format(
      "{} layers from a first cell of {:.6g} with growth {:.6g} are {:.6g} high, but the distance "
      "is {:.6g}; drop one of the three: without layers: {:.0f} layers; without first cell: first "
      "cell {:.6g}; without growth: {}",
      n, first, *options.growth, first * std::exp(series(b, n).value), height,
      std::max(1.0, std::ceil(layers_for(height, first, b) - 1e-9)), first_for(height, b, n),
      drop_growth));
}

void check_first_cell(double height, double first) {
  if (first >= kLeastFirstCell * height) return;
  throw InputError(fmt::format(
      "a first cell of {:.6g} in a distance of {:.6g} is lost in rounding; it must be at least "
      "{:.6g}: take fewer layers, a smaller growth or a larger first cell",
      first, height, kLeastFirstCell * height));
}

LayerSpacing geometric(double height, double first, int n, const SpacingOptions& options) {
  check_first_cell(height, first);
  const double fill = n * first / height;
  LayerSpacing out;
  out.layers = n;
  out.height_world = height;
  out.growth_requested = options.growth.value_or(0.0);
  double b = 0;
  if (std::abs(fill - 1) <= 1e-14) {
    first = height / n;
  } else if (n == 1) {
    fill > 1 ? refuse_thick(height, first, n) : refuse_growth(height, first, n, options);
  } else {
    b = solve_ratio(height, first, n);
  }
  // A growth that was asked for is in range already, and may come back with rounding.
  if (!options.growth && std::exp(b) > options.max_growth * (1 + 1e-12)) {
    refuse_growth(height, first, n, options);
  }
  out.heights_world = geometric_levels(height, first, b, n);
  out.first_cell_world = first;
  out.last_cell_world = first * std::exp(b * (n - 1));
  out.growth = std::exp(b);
  return out;
}

/// First cell and growth: N rounds up. Equal or nearly equal cells that do not divide the height
/// then shrink outward a little, which keeps the first cell as asked.
LayerSpacing from_first_and_growth(double height, double growth, const SpacingOptions& options) {
  const double first = *options.first_cell_world;
  check_first_cell(height, first);
  if (first > height) refuse_thick(height, first, 1);
  const int n = std::max(1, round_up(layers_for(height, first, std::log(growth))));
  if (n > kMaxLayers) {
    throw InputError(fmt::format(
        "a first cell of {:.6g} with growth {:.6g} needs {:.0f} layers to a distance of {:.6g}, "
        "but at most {} are made; take a larger first cell or growth",
        first, growth, layers_for(height, first, std::log(growth)), height, kMaxLayers));
  }
  if (n > 1 && n * first > height &&
      solve_ratio(height, first, n) < -std::log(options.max_growth)) {
    throw InputError(fmt::format(
        "cells from a first one of {:.6g} with growth {:.6g} do not fill a distance of {:.6g}: {} "
        "are too few and {} leave a sliver; take a first cell of {:.6g} or {:.6g}",
        first, growth, height, n - 1, n, height / (n - 1), height / n));
  }
  LayerSpacing out = geometric(height, first, n, options);
  out.growth_requested = growth;
  return out;
}

/// Nobody asked for the first cell: say what of layers and growth makes it vanish.
[[noreturn]] void refuse_vanishing(double height, int n, double growth) {
  const double b = std::log(growth);
  const double powers = series(b, n).value / std::log(10.0);
  throw InputError(fmt::format(
      "{} layers with growth {:.6g} in a distance of {:.6g} begin with a first cell of 1e{:.0f} of "
      "it, which is lost in rounding; give at most {:.0f} layers, or a growth of at most {:.4f}",
      n, growth, height, -powers, std::floor(layers_for(1, kLeastFirstCell, b)),
      std::floor(1e4 * std::exp(solve_ratio(1, kLeastFirstCell, n))) / 1e4));
}

LayerSpacing from_layers_and_growth(double height, int n, double growth,
                                    const SpacingOptions& options) {
  const double first = first_for(height, std::log(growth), n);
  if (!(first >= kLeastFirstCell * height)) refuse_vanishing(height, n, growth);
  LayerSpacing out = geometric(height, first, n, options);
  out.growth = n > 1 ? growth : 1.0;
  out.growth_requested = growth;
  return out;
}

[[noreturn]] void refuse_last_cell(double height, const SpacingOptions& options, double ratio) {
  const int n = *options.layers;
  const double first = *options.first_cell_world;
  std::string hint = "take fewer layers, or smaller cells";
  if (n > 1 && n * first <= height) {
    const double b = solve_ratio(height, first, n);
    hint = fmt::format(
        "without a last cell it would be {:.6g} with growth {:.6g}; ask for one nearer to that, or "
        "change the number of layers",
        first * std::exp(b * (n - 1)), std::exp(b));
  }
  const std::string why =
      ratio > 0 ? fmt::format(
                      "need neighbours that differ by a factor of {:.6g}, but the largest "
                      "growth is {:.6g}",
                      ratio, options.max_growth)
                : std::string("do not fill it whatever lies between");
  throw InputError(
      fmt::format("{} layers from a first cell of {:.6g} to a last cell of {:.6g} in a distance of "
                  "{:.6g} {}; {}",
                  n, first, *options.last_cell_world, height, why, hint));
}

/// One or two cells leave nothing between the ends to adjust; more need room between them.
bool ends_fit(double height, double first, double last, int n) {
  const double ends = n == 1 ? first : first + last;
  if (n > 2) return ends < height;
  if (n == 1 && std::abs(last / first - 1) > kConsistent) return false;
  return std::abs(ends / height - 1) <= kConsistent;
}

/// c for which n > 2 cells fill exp(target) first cells.
double solve_curvature(double target, double b, int n) {
  const int mid = (n - 1) / 2;
  const bool bows_out = quadratic(b, 0, n, true).value < target;
  const double start =
      bows_out ? (target - b * mid) / (static_cast<double>(mid) * (n - 1 - mid)) : 0.0;
  return newton(start, target, [&](double x) { return quadratic(b, x, n, true); });
}

/// b from the two end cells, c from the height.
LayerSpacing with_last_cell(double height, const SpacingOptions& options) {
  const int n = *options.layers;
  const double first = *options.first_cell_world;
  const double last = *options.last_cell_world;
  check_first_cell(height, std::min(first, last));
  if (!ends_fit(height, first, last, n)) refuse_last_cell(height, options, 0);
  const double b = n == 1 ? 0.0 : std::log(last / first) / (n - 1);
  const double c = n > 2 ? solve_curvature(std::log(height / first), b, n) : 0.0;
  const double steepest = std::abs(b) + std::abs(c) * (n - 2);
  if (n > 1 && steepest > std::log(options.max_growth) + 1e-12) {
    refuse_last_cell(height, options, std::exp(steepest));
  }
  LayerSpacing out;
  out.layers = n;
  out.height_world = height;
  out.first_cell_world = first;
  out.last_cell_world = last;
  out.growth = n == 1 ? 1.0 : std::exp(b + std::abs(c) * (n - 2));
  out.curvature = c;
  out.heights_world = quadratic_levels(height, first, b, c, n);
  return out;
}

void check_range(const char* name, double value, bool inside, const std::string& rule) {
  if (inside) return;
  throw InputError(fmt::format("SpacingOptions::{} = {}, but must be {}", name, value, rule));
}

}  // namespace

void SpacingOptions::validate() const {
  const auto positive = [](double x) { return x > 0 && std::isfinite(x); };
  if (layers)
    check_range("layers", *layers, *layers >= 1 && *layers <= kMaxLayers, "in [1, 10000]");
  if (first_cell_world) {
    check_range("first_cell_world", *first_cell_world, positive(*first_cell_world),
                "> 0 and finite");
  }
  check_range("max_growth", max_growth, max_growth > 1 && max_growth <= 10, "in (1, 10]");
  if (growth) {
    check_range("growth", *growth, *growth >= 1 && *growth <= 10, "in [1, 10]");
    check_range("growth", *growth, *growth <= max_growth,
                fmt::format("at most max_growth = {}", max_growth));
  }
  if (!last_cell_world) return;
  check_range("last_cell_world", *last_cell_world, positive(*last_cell_world), "> 0 and finite");
  if (!layers || !first_cell_world) {
    throw InputError(
        "a last cell needs the number of layers and the first cell too; give both, or drop it");
  }
  if (growth) {
    throw InputError(fmt::format(
        "layers, first cell and last cell ({:.6g}) leave no freedom for growth = {:.6g}; drop the "
        "last cell or the growth",
        *last_cell_world, *growth));
  }
}

LayerSpacing solve_spacing(double height_world, const SpacingOptions& options) {
  if (!(height_world > 0) || !std::isfinite(height_world)) {
    throw InputError(
        fmt::format("the height of the layers (the distance) = {}, but must be > 0 "
                    "and finite",
                    height_world));
  }
  options.validate();
  if (options.last_cell_world) return with_last_cell(height_world, options);
  // The default gives way to the limit; a growth that was asked for does not.
  const double growth = options.growth.value_or(std::min(kDefaultGrowth, options.max_growth));
  const int layers = options.layers.value_or(kDefaultLayers);
  if (!options.first_cell_world) {
    return from_layers_and_growth(height_world, layers, growth, options);
  }
  if (!options.layers) return from_first_and_growth(height_world, growth, options);
  const double first = *options.first_cell_world;
  if (options.growth) {
    const double sum = first * std::exp(series(std::log(growth), layers).value);
    if (!(std::abs(sum / height_world - 1) <= kConsistent)) {
      refuse_contradiction(height_world, options);
    }
  } else if (layers * first > height_world * (1 + 1e-14)) {
    refuse_thick(height_world, first, layers);
  }
  if (options.growth && layers == 1) {
    return from_layers_and_growth(height_world, 1, growth, options);
  }
  return geometric(height_world, first, layers, options);
}

std::vector<double> squeeze(const LayerSpacing& spacing, double height_world) {
  if (height_world >= spacing.height_world) return spacing.heights_world;
  const int n = spacing.layers;
  const double first = spacing.first_cell_world;
  const double room = height_world - n * first;
  if (n * first >= spacing.height_world) {
    // A law that shrinks outward keeps its proportions, which joins the full height smoothly.
    std::vector<double> levels = spacing.heights_world;
    for (double& level : levels) level *= height_world / spacing.height_world;
    levels.back() = height_world;
    return levels;
  }
  if (room <= 0) return geometric_levels(height_world, height_world / n, 0, n);
  if (spacing.curvature == 0) {
    return geometric_levels(height_world, first, solve_ratio(height_world, first, n), n);
  }
  // The bow fades with the room left over: the law turns into equal cells without a step.
  const double c = spacing.curvature * room / (spacing.height_world - n * first);
  const double target = std::log(height_world / first);
  const double b =
      newton(target / (n - 1), target, [&](double x) { return quadratic(x, c, n, false); });
  return quadratic_levels(height_world, first, b, c, n);
}

std::vector<double> rescale(const LayerSpacing& spacing, double height_world,
                            double first_cell_world) {
  const int n = spacing.layers;
  if (height_world <= spacing.height_world && first_cell_world == spacing.first_cell_world) {
    return squeeze(spacing, height_world);
  }
  if (n * first_cell_world >= height_world)
    return geometric_levels(height_world, height_world / n, 0, n);
  return geometric_levels(height_world, first_cell_world,
                          solve_ratio(height_world, first_cell_world, n), n);
}

}  // namespace vdb_offset
