#include "surface/example_grid.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <unordered_map>

namespace vdb_offset::example {

int cells(const ExampleOptions& options, double share, int least) {
  return std::max(least, static_cast<int>(std::lround(share * (options.points - 1))));
}

Eigen::Vector2d turn(int k, int count) {
  const int quarter = count / 4;
  const int rest = k % quarter;
  const double angle = 2 * std::numbers::pi * rest / count;
  Eigen::Vector2d p(std::cos(angle), rest == 0 ? 0.0 : std::sin(angle));
  for (int q = (k / quarter) % 4; q > 0; --q) p = {0 - p.y(), p.x()};  // not -p.y(): no -0
  return p;
}

Curve line(const Vec3& a, const Vec3& b, int count) {
  Curve curve;
  for (int k = 0; k <= count; ++k) {
    const Vec3 p = (a * (count - k) + b * k) / count;
    // a * count / count need not be a: a line in a plane x = const must stay in it
    curve.push_back((a.array() == b.array()).select(a, p));
  }
  curve.front() = a;
  curve.back() = b;
  return curve;
}

Curve reversed(Curve curve) {
  std::reverse(curve.begin(), curve.end());
  return curve;
}

Curve join(Curve first, const Curve& second) {
  first.insert(first.end(), second.begin() + (first.empty() ? 0 : 1), second.end());
  return first;
}

namespace {

/// The root d > 0 of sinh(d) / d = b for b > 1, or of sin(d) / d = b for b < 1.
double stretch_parameter(double b) {
  const bool wide = b < 1;
  double lo = 0;
  double hi = wide ? std::acos(-1.0) : 60.0;
  for (int step = 0; step < 60; ++step) {
    const double d = 0.5 * (lo + hi);
    const bool below = wide ? std::sin(d) > b * d : std::sinh(d) < b * d;
    (below ? lo : hi) = d;
  }
  return 0.5 * (lo + hi);
}

/// The symmetric part of the stretching at x in [0, 1].
double symmetric_stretch(double x, double b, double d) {
  if (std::abs(b - 1) < 1e-3) return x * (1 + 2 * (b - 1) * (x - 0.5) * (1 - x));
  if (b > 1) return 0.5 * (1 + std::tanh(d * (x - 0.5)) / std::tanh(0.5 * d));
  return 0.5 * (1 + std::tan(d * (x - 0.5)) / std::tan(0.5 * d));
}

}  // namespace

std::vector<double> stretch(int count, double first, double last) {
  const double a = std::sqrt(last / first);
  const double b = 1.0 / (count * std::sqrt(first * last));
  const double d = stretch_parameter(b);
  std::vector<double> fraction{0.0};
  for (int k = 1; k < count; ++k) {
    const double u = symmetric_stretch(static_cast<double>(k) / count, b, d);
    fraction.push_back(u / (a + (1 - a) * u));
  }
  fraction.push_back(1.0);
  return fraction;
}

Patch transfinite(std::string name, const Sides& sides) {
  const auto& [south, east, north, west] = sides;
  assert(south.size() == north.size() && west.size() == east.size());
  const int ni = static_cast<int>(south.size());
  const int nj = static_cast<int>(west.size());
  return tabulate(std::move(name), ni, nj, [&](int i, int j) -> Vec3 {
    const auto ci = static_cast<std::size_t>(i);
    const auto cj = static_cast<std::size_t>(j);
    if (j == 0) return south[ci];
    if (j == nj - 1) return north[ci];
    if (i == 0) return west[cj];
    if (i == ni - 1) return east[cj];
    const double u = static_cast<double>(i) / (ni - 1);
    const double v = static_cast<double>(j) / (nj - 1);
    const Vec3 corners = (1 - v) * ((1 - u) * south.front() + u * south.back()) +
                         v * ((1 - u) * north.front() + u * north.back());
    return (1 - v) * south[ci] + v * north[ci] + (1 - u) * west[cj] + u * east[cj] - corners;
  });
}

Patch turned(Patch patch) {
  for (int j = 0; j < patch.nj; ++j) {
    const auto row = patch.points_world.begin() + static_cast<std::ptrdiff_t>(j) * patch.ni;
    std::reverse(row, row + patch.ni);
  }
  return patch;
}

Patches extrude(const Face& face, int count) {
  Patches patches;
  for (const auto& [name, curve] : face.outline) {
    const int ni = static_cast<int>(curve.size());
    patches.push_back(tabulate(name, ni, count + 1, [&curve, count](int i, int j) -> Vec3 {
      const Vec3& p = curve[static_cast<std::size_t>(i)];
      return {p.x(), p.y(), static_cast<double>(j) / count};
    }));
  }
  for (const Patch& part : face.parts) {
    Patch near = turned(part);
    near.name = "near end " + part.name;
    Patch far = moved(part, [](const Vec3& p) -> Vec3 { return {p.x(), p.y(), 1.0}; });
    far.name = "far end " + part.name;
    patches.push_back(std::move(near));
    patches.push_back(std::move(far));
  }
  stitch(patches);
  return patches;
}

void set_family(Patches& patches, const std::string& family) {
  for (Patch& patch : patches) patch.family = family;
}

namespace {

/// Side points by the cell of a fine lattice that they lie in.
class PointIndex {
 public:
  /// The point that `p` agrees with: one met before, or itself.
  Vec3 unify(const Vec3& p) {
    const std::array<std::int64_t, 3> home{cell(p.x()), cell(p.y()), cell(p.z())};
    for (int n = 0; n < 27; ++n) {
      const auto near =
          points_.find(key({home[0] + n % 3 - 1, home[1] + n / 3 % 3 - 1, home[2] + n / 9 - 1}));
      if (near == points_.end()) continue;
      for (const Vec3& q : near->second) {
        if ((q - p).cwiseAbs().maxCoeff() <= kTolerance) return q;
      }
    }
    points_[key(home)].push_back(p);
    return p;
  }

 private:
  // Rounding leaves 1e-15; the finest grid on offer has spacings of 1e-6.
  static constexpr double kTolerance = 1e-11;
  static constexpr double kCell = 1e-7;

  static std::int64_t cell(double x) { return std::llround(x / kCell); }
  static std::uint64_t key(const std::array<std::int64_t, 3>& c) {
    std::uint64_t hash = 0;
    for (const std::int64_t x : c) {
      hash = (hash ^ static_cast<std::uint64_t>(x)) * 0x9E3779B97F4A7C15ULL;
      hash ^= hash >> 29;
    }
    return hash;
  }

  std::unordered_map<std::uint64_t, Vec3List> points_;
};

}  // namespace

void stitch(Patches& patches) {
  PointIndex index;
  for (Patch& patch : patches) {
    for (int j = 0; j < patch.nj; ++j) {
      const bool end_row = j == 0 || j == patch.nj - 1;
      const int step = end_row ? 1 : patch.ni - 1;
      for (int i = 0; i < patch.ni; i += step) patch.at(i, j) = index.unify(patch.at(i, j));
    }
  }
}

}  // namespace vdb_offset::example
