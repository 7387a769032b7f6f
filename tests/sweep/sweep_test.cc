#include "vdb_offset/sweep/sweep.h"

#include <doctest/doctest.h>
#include <openvdb/openvdb.h>

#include <algorithm>
#include <cmath>
#include <cstring>

#include "support/shapes.h"
#include "support/threads.h"
#include "sweep/octant.h"
#include "vdb_offset/core/error.h"
#include "vdb_offset/surface/example.h"

using namespace vdb_offset;
using namespace vdb_offset::test;

namespace {

/// A band made by hand: seeds with their values, other voxels unreached.
class HandMade {
 public:
  explicit HandMade(double voxel) {
    band_.voxel_world = voxel;
    band_.distance_world = 1e6;
    band_.phi = openvdb::FloatGrid::create(Band::kUnreached);
    band_.phi->setTransform(openvdb::math::Transform::createLinearTransform(voxel));
  }
  void seed(const openvdb::Coord& at, float phi) {
    band_.phi->tree().setValueOn(at, phi);
    ++band_.seed_count;
  }
  void open(const openvdb::Coord& at) { band_.phi->tree().setValueOn(at, Band::kUnreached); }
  Band take() { return band_; }

 private:
  Band band_;
};

/// The exact band of a sphere of radius `radius` voxels: seeds from `inner` - 2 to `inner` voxels
/// outside.
DistanceField sphere_field(double radius, double inner, double outer) {
  HandMade hand(1);
  const int n = static_cast<int>(radius + outer) + 1;
  for (int x = -n; x <= n; ++x) {
    for (int y = -n; y <= n; ++y) {
      for (int z = -n; z <= n; ++z) {
        const double phi = Vec3(x, y, z).norm() - radius;
        if (phi < -inner || phi > outer) continue;
        if (std::abs(phi) <= inner) {
          hand.seed({x, y, z}, static_cast<float>(phi));
        } else {
          hand.open({x, y, z});
        }
      }
    }
  }
  return sweep(hand.take(), {.tolerance_voxels = 0});
}

/// Largest error against the distance to the polyhedron itself.
double worst_error(double voxel) {
  const Surface surface = build_surface(mapped(make_example("sphere", {.points = 65}),
                                               Eigen::Matrix3d::Identity(), {0.11, -0.23, 0.37}));
  const DistanceField field =
      sweep(rasterize(surface, {.distance_world = 0.625, .voxel_world = voxel}));
  double worst = 0;
  std::uint64_t n = 0;
  for (auto it = field.phi->cbeginValueOn(); it; ++it) {
    if (*it < 0 || n++ % 7 != 0) continue;
    const Vec3 p = voxel * Vec3(it.getCoord().x(), it.getCoord().y(), it.getCoord().z());
    const double exact = surface.wall->closest(p).distance_world;
    if (exact <= 0.625) worst = std::max(worst, std::abs(*it - exact));
  }
  return worst;
}

/// Algorithm 1 of the paper on a dense array, equations 8 and 9 as they stand there, in double.
class Reference {
 public:
  explicit Reference(const Band& band) : h_(band.voxel_world) {
    for (auto it = band.phi->cbeginValueOn(); it; ++it) {
      grid_.setValueOn(it.getCoord(), *it);
      if (std::abs(*it) < Band::kUnreached) seeds_.setValueOn(it.getCoord());
      box_.expand(it.getCoord());
    }
    while (round()) {
    }
  }
  double at(const openvdb::Coord& c) const { return std::abs(grid_.getValue(c)); }

 private:
  bool round() {
    bool moved = false;
    for (const unsigned o : kRound) moved = one(o) || moved;
    return moved;
  }
  bool one(unsigned o) {
    bool moved = false;
    const openvdb::Coord d = box_.dim();
    for (int i = 0; i < d.x(); ++i) {
      for (int j = 0; j < d.y(); ++j) {
        for (int k = 0; k < d.z(); ++k) {
          moved = update({octant_step(o, 0) > 0 ? box_.min().x() + i : box_.max().x() - i,
                          octant_step(o, 1) > 0 ? box_.min().y() + j : box_.max().y() - j,
                          octant_step(o, 2) > 0 ? box_.min().z() + k : box_.max().z() - k}) ||
                  moved;
        }
      }
    }
    return moved;
  }
  bool update(const openvdb::Coord& c) {
    if (!grid_.isValueOn(c) || seeds_.isValueOn(c)) return false;
    const double old = grid_.getValue(c);
    const auto least = [&](const openvdb::Coord& step) {
      const auto value = [&](const openvdb::Coord& at) {
        return grid_.isValueOn(at) ? std::abs(grid_.getValue(at))
                                   : static_cast<double>(Band::kUnreached);
      };
      return std::min(value(c - step), value(c + step));
    };
    std::array<double, 3> a{least({1, 0, 0}), least({0, 1, 0}), least({0, 0, 1})};
    std::sort(a.begin(), a.end());
    double phi = a[0] + h_;
    if (phi > a[1]) {
      phi = 0.5 * (a[0] + a[1] + std::sqrt(2 * h_ * h_ - (a[0] - a[1]) * (a[0] - a[1])));
      if (phi > a[2]) {
        const double sum = a[0] + a[1] + a[2];
        const double mixed =
            a[0] * a[1] + a[1] * a[2] + a[0] * a[2] - a[0] * a[0] - a[1] * a[1] - a[2] * a[2];
        phi = (sum + std::sqrt(3 * h_ * h_ + 2 * mixed)) / 3;
      }
    }
    if (!(phi < std::abs(old) - 1e-13)) return false;
    grid_.setValue(c, phi);
    return true;
  }

  openvdb::DoubleTree grid_{0.0};
  openvdb::BoolTree seeds_{false};
  double h_;
  openvdb::CoordBBox box_;
};

}  // namespace

TEST_CASE("sweep: the two-dimensional table of a fast-marching library is met") {
  const std::array<std::array<double, 4>, 4> expected{{{-1.20710678, -.5, .5, 1.5},
                                                       {-.5, -.35355339, .5, 1.5},
                                                       {.5, .5, 1.20710678, 2.04532893},
                                                       {1.5, 1.5, 2.04532893, 2.75243571}}};
  HandMade hand(1);
  const float corner = static_cast<float>(std::sqrt(0.125));
  for (int i = 0; i < 4; ++i) {
    for (int j = 0; j < 4; ++j) hand.open({i, j, 0});
  }
  for (const openvdb::Coord& c :
       {openvdb::Coord(0, 1, 0), openvdb::Coord(1, 0, 0), openvdb::Coord(0, 2, 0),
        openvdb::Coord(1, 2, 0), openvdb::Coord(2, 0, 0), openvdb::Coord(2, 1, 0)}) {
    hand.seed(c, 0.5F);
  }
  hand.seed({1, 1, 0}, corner);
  const DistanceField field = sweep(hand.take(), {.tolerance_voxels = 0});
  const auto phi = field.phi->getConstAccessor();
  for (int i = 0; i < 4; ++i) {
    for (int j = 0; j < 4; ++j) {
      CAPTURE(i);
      CAPTURE(j);
      const double value = phi.getValue({i, j, 0});
      CHECK(value ==
            doctest::Approx(
                std::abs(expected[static_cast<std::size_t>(i)][static_cast<std::size_t>(j)]))
                .epsilon(3e-7));
    }
  }
}

TEST_CASE("sweep: the upwind gradient is within one percent of 1 around a sphere") {
  const DistanceField field = sphere_field(60, 3, 12);
  const auto phi = field.phi->getConstAccessor();
  double least = 2;
  double most = 0;
  for (auto it = field.phi->cbeginValueOn(); it; ++it) {
    const openvdb::Coord c = it.getCoord();
    if (*it < 1) continue;  // needs all its upwind neighbours in the band
    double sum = 0;
    for (int axis = 0; axis < 3; ++axis) {
      openvdb::Coord step;
      step[axis] = 1;
      const double low = std::min(phi.getValue(c - step), phi.getValue(c + step));
      sum += std::pow(std::max(0.0, *it - low), 2);
    }
    least = std::min(least, std::sqrt(sum));
    most = std::max(most, std::sqrt(sum));
  }
  CHECK(least > 0.99);
  CHECK(most < 1.01);
}

TEST_CASE("sweep: eight sweeps settle a convex body, the next eight change nothing") {
  const DistanceField field = sphere_field(20, 2, 12);
  CHECK(field.report.converged);
  CHECK(field.report.sweeps == 16);
  CHECK(field.report.last_change_voxels == 0);
}

TEST_CASE("sweep: the distance outside a sphere converges at first order") {
  const double coarse = worst_error(1.0 / 16);
  const double fine = worst_error(1.0 / 32);
  CAPTURE(coarse);
  CAPTURE(fine);
  CHECK(std::log2(coarse / fine) > 0.7);  // h |log h|
  CHECK(fine < kSweepError / 32);
}

TEST_CASE("sweep: the result is that of the paper's algorithm on a dense array") {
  for (const char* name : {"u-slot", "sphere-pair"}) {
    CAPTURE(name);
    const Surface surface = build_surface(make_example(name, {.points = 9}));
    const auto band = [&] {
      return rasterize(surface, {.distance_world = 0.4, .voxel_world = 0.05, .both_sides = true});
    };
    const Reference reference(band());
    const DistanceField field = sweep(band(), {.tolerance_voxels = 0});
    double worst = 0;
    for (auto it = field.phi->cbeginValueOn(); it; ++it) {
      const double expected = reference.at(it.getCoord());
      worst = std::max(worst, std::abs(std::abs(*it) - expected) / expected);
    }
    CHECK(worst < 8 * std::pow(2.0, -24));
  }
}

TEST_CASE("sweep: permuting or mirroring the axes permutes or mirrors the result") {
  std::mt19937_64 random(4);
  std::uniform_int_distribution<int> place(-9, 9);
  std::uniform_real_distribution<float> value(0.1F, 0.9F);
  std::vector<std::pair<openvdb::Coord, float>> seeds;
  for (int n = 0; n < 12; ++n) {
    seeds.emplace_back(openvdb::Coord(place(random), place(random), place(random)), value(random));
  }
  const auto solve = [&](const std::array<int, 3>& axes, unsigned mirrors) {
    const auto map = [&](const openvdb::Coord& c) {
      openvdb::Coord m;
      for (int a = 0; a < 3; ++a) {
        m[a] = (mirrors >> static_cast<unsigned>(a) & 1U) != 0
                   ? -c[axes[static_cast<std::size_t>(a)]]
                   : c[axes[static_cast<std::size_t>(a)]];
      }
      return m;
    };
    HandMade hand(1);
    for (int x = -10; x <= 10; ++x) {
      for (int y = -10; y <= 10; ++y) {
        for (int z = -10; z <= 10; ++z) hand.open({x, y, z});
      }
    }
    for (const auto& [at, phi] : seeds) hand.seed(map(at), phi);
    const DistanceField field = sweep(hand.take(), {.tolerance_voxels = 0});
    std::vector<float> values;
    const auto phi = field.phi->getConstAccessor();
    for (int x = -10; x <= 10; ++x) {
      for (int y = -10; y <= 10; ++y) {
        for (int z = -10; z <= 10; ++z) values.push_back(phi.getValue(map({x, y, z})));
      }
    }
    return values;
  };
  const std::vector<float> straight = solve({0, 1, 2}, 0);
  std::array<int, 3> axes{0, 1, 2};
  do {
    for (unsigned mirrors = 0; mirrors < 8; ++mirrors) {
      const std::vector<float> turned = solve(axes, mirrors);
      CHECK(std::memcmp(straight.data(), turned.data(), straight.size() * sizeof(float)) == 0);
    }
  } while (std::next_permutation(axes.begin(), axes.end()));
}

TEST_CASE("sweep: seeds keep their values and their signs") {
  const Surface surface = build_surface(make_example("l-bar", {.points = 9}));
  const auto band = rasterize(surface, {.distance_world = 0.3, .both_sides = true});
  const auto before = band.phi->deepCopy();
  const DistanceField field = sweep(band);
  const auto phi = field.phi->getConstAccessor();
  for (auto it = before->cbeginValueOn(); it; ++it) {
    const float after = phi.getValue(it.getCoord());
    if (std::abs(*it) < Band::kUnreached) CHECK(after == *it);
    if (phi.isValueOn(it.getCoord())) CHECK(std::signbit(after) == std::signbit(*it));
  }
}

TEST_CASE("sweep: a closed surface gives a level set: inside negative everywhere") {
  const Surface surface = build_surface(make_example("cube", {.points = 9}));
  const DistanceField field =
      sweep(rasterize(surface, {.distance_world = 0.1, .voxel_world = 0.01}));
  const auto phi = field.phi->getConstAccessor();
  const auto at = [&](double x, double y, double z) {
    return phi.getValue(openvdb::Coord::round(openvdb::Vec3d(x, y, z) / 0.01));
  };
  const Vec3 centre = 0.5 * (surface.wall->bounds().lo + surface.wall->bounds().hi);
  CHECK(at(centre.x(), centre.y(), centre.z()) == -static_cast<float>(field.background_world));
  CHECK(at(9, 9, 9) == static_cast<float>(field.background_world));
}

TEST_CASE("sweep: a band without seeds and options out of range are refused by name") {
  HandMade hand(1);
  hand.open({0, 0, 0});
  CHECK_THROWS_AS(sweep(hand.take()), InputError);
  CHECK_THROWS_WITH(SweepOptions{.tolerance_voxels = std::nan("")}.validate(),
                    "sweep-tolerance = nan, but must be at least 0");
  CHECK_THROWS_AS(SweepOptions{.max_sweeps = 0}.validate(), InputError);
}

TEST_CASE("sweep: running out of sweeps is reported, not hidden") {
  HandMade hand(1);
  for (int x = -40; x <= 40; ++x) {
    for (int y = -40; y <= 40; ++y) hand.open({x, y, 0});
  }
  hand.seed({0, 0, 0}, 0.5F);
  const DistanceField field = sweep(hand.take(), {.tolerance_voxels = 0, .max_sweeps = 1});
  CHECK_FALSE(field.report.converged);
  CHECK(field.report.sweeps == 1);
}

TEST_CASE("sweep: one thread and two give the same bits") {
  const Surface surface = build_surface(make_example("sphere-pair", {.points = 17}));
  const auto run = [&] { return sweep(rasterize(surface, {.distance_world = 0.5})).phi; };
  const auto one = on_threads(1, run);
  const auto two = on_threads(2, run);
  CHECK(one->tree().hasSameTopology(two->tree()));
  auto other = two->getConstAccessor();
  bool same = true;
  for (auto it = one->cbeginValueAll(); it; ++it) {
    same = same && *it == other.getValue(it.getCoord());
  }
  CHECK(same);
}
