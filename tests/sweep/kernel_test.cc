#include "sweep/kernel.h"

#include <doctest/doctest.h>
#include <openvdb/openvdb.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <random>
#include <vector>

#include "support/threads.h"
#include "sweep/sweep_with.h"

using namespace vdb_offset;
using namespace vdb_offset::test;

namespace {

constexpr double kUlp = 0x1p-23;  // spacing of floats in [1, 2), the widest relative one

/// Random blobs of voxels with random seeds of either sign; holes, and bodies far apart.
Band random_band(unsigned seed, double voxel) {
  std::mt19937 random(seed);
  std::uniform_int_distribution<int> centre(-30, 30);
  std::uniform_int_distribution<int> radius(4, 17);
  std::uniform_real_distribution<float> level(0.0F, 2.5F);
  std::uniform_int_distribution<int> dice(0, 99);
  Band band;
  band.voxel_world = voxel;
  band.distance_world = 1e6;
  band.phi = openvdb::FloatGrid::create(Band::kUnreached);
  band.phi->setTransform(openvdb::math::Transform::createLinearTransform(voxel));
  auto voxels = band.phi->getAccessor();
  for (int blob = 0; blob < 6; ++blob) {
    const openvdb::Coord c(centre(random) + (blob == 5 ? 5000 : 0), centre(random), centre(random));
    const int r = radius(random);
    for (int x = -r; x <= r; ++x) {
      for (int y = -r; y <= r; ++y) {
        for (int z = -r; z <= r; ++z) {
          if (x * x + y * y + z * z > r * r || dice(random) < 3) continue;
          const float sign = dice(random) < 50 ? 1.0F : -1.0F;
          const bool first = x == 0 && y == 0 && z == 0;
          const float size = first || dice(random) == 0 ? level(random) * static_cast<float>(voxel)
                                                        : Band::kUnreached;
          voxels.setValueOn(c + openvdb::Coord(x, y, z), sign * size);
        }
      }
    }
  }
  band.seed_count = 1;
  return band;
}

/// All values of a field, active or not.
std::vector<float> values(const DistanceField& field) {
  std::vector<float> all;
  for (auto it = field.phi->cbeginValueAll(); it; ++it) all.push_back(*it);
  return all;
}

bool same_bits(const std::vector<float>& a, const std::vector<float>& b) {
  return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(float)) == 0;
}

/// The paper's algorithm 1 on a dense array of floats: every voxel in each of the eight orders,
/// until no bit changes.
class DenseReference {
 public:
  explicit DenseReference(const Band& band) : h_(static_cast<float>(band.voxel_world)) {
    box_ = band.phi->evalActiveVoxelBoundingBox();
    box_.expand(1);
    phi_.assign(static_cast<std::size_t>(box_.volume()), Band::kUnreached);
    open_.assign(phi_.size(), 0);
    for (auto it = band.phi->cbeginValueOn(); it; ++it) {
      phi_[index(it.getCoord())] = std::abs(*it);
      open_[index(it.getCoord())] = std::abs(*it) >= Band::kUnreached ? 1 : 0;
    }
    while (round()) {
    }
  }
  float at(const openvdb::Coord& c) const { return phi_[index(c)]; }

 private:
  std::size_t index(const openvdb::Coord& c) const {
    const openvdb::Coord d = box_.dim();
    const openvdb::Coord o = c - box_.min();
    return (static_cast<std::size_t>(o.x()) * static_cast<std::size_t>(d.y()) +
            static_cast<std::size_t>(o.y())) *
               static_cast<std::size_t>(d.z()) +
           static_cast<std::size_t>(o.z());
  }
  bool round() {
    bool moved = false;
    for (const unsigned octant : kRound) {
      const openvdb::Coord d = box_.dim();
      for (int i = 1; i + 1 < d.x(); ++i) {
        for (int j = 1; j + 1 < d.y(); ++j) {
          for (int k = 1; k + 1 < d.z(); ++k) {
            const openvdb::Coord o((octant & 1U) != 0 ? d.x() - 1 - i : i,
                                   (octant & 2U) != 0 ? d.y() - 1 - j : j,
                                   (octant & 4U) != 0 ? d.z() - 1 - k : k);
            moved = update(index(box_.min() + o)) || moved;
          }
        }
      }
    }
    return moved;
  }
  bool update(std::size_t n) {
    if (open_[n] == 0) return false;
    const auto dz = static_cast<std::size_t>(box_.dim().z());
    const std::size_t steps[3] = {dz * static_cast<std::size_t>(box_.dim().y()), dz, 1};
    double a[3];
    for (int axis = 0; axis < 3; ++axis) {
      a[axis] = std::min(phi_[n - steps[axis]], phi_[n + steps[axis]]);
    }
    const auto fresh = static_cast<float>(solve(a));
    if (!(fresh < phi_[n])) return false;
    phi_[n] = fresh;
    return true;
  }
  /// Equations 8 and 9, the field kept in float and each update rounded once.
  double solve(double* a) const {
    const double h = h_;
    std::sort(a, a + 3);
    double phi = a[0] + h;
    if (phi <= a[1]) return phi;
    phi = 0.5 * (a[0] + a[1] + std::sqrt(2 * h * h - (a[0] - a[1]) * (a[0] - a[1])));
    if (phi <= a[2]) return phi;
    const double p = a[1] - a[0];
    const double q = a[2] - a[0];
    return a[0] + (p + q + std::sqrt(3 * h * h - 2 * (p * p - p * q + q * q))) / 3;
  }

  float h_;
  openvdb::CoordBBox box_;
  std::vector<float> phi_;
  std::vector<char> open_;
};

}  // namespace

TEST_CASE("sweep: every instruction set gives the bits of plain C++, on one thread and on two") {
  for (unsigned seed = 0; seed < 4; ++seed) {
    for (const double tolerance : {0.0, 1e-4}) {
      const double voxel = 0.013;
      const auto run = [&](Isa isa) {
        return values(
            sweep_with(*kernels(isa), random_band(seed, voxel), {.tolerance_voxels = tolerance}));
      };
      const std::vector<float> plain = run(Isa::Scalar);
      for (const Isa isa : {Isa::Sse2, Isa::Avx2, Isa::Avx512}) {
        if (kernels(isa) == nullptr) {
          MESSAGE("skipped: this machine has no instruction set " << static_cast<int>(isa));
          continue;
        }
        CAPTURE(static_cast<int>(isa));
        for (const std::size_t threads : {1U, 2U}) {
          CHECK(same_bits(plain, on_threads(threads, [&] { return run(isa); })));
        }
      }
    }
  }
}

TEST_CASE("sweep: a field swept until no bit changes is the dense reference's to four units") {
  Band band = random_band(11, 0.7);
  for (auto it = band.phi->beginValueOn(); it; ++it) {
    if (it.getCoord().x() > 1000) it.setValueOff();  // keeps the dense array small
  }
  const DenseReference reference(band);
  const DistanceField field = sweep(band, {.tolerance_voxels = 0});
  double worst = 0;
  std::size_t reached = 0;
  for (auto it = field.phi->cbeginValueOn(); it; ++it) {
    const double expected = reference.at(it.getCoord());
    if (expected == 0) {
      CHECK(*it == 0);
      continue;
    }
    ++reached;
    worst = std::max(worst, std::abs(std::abs(*it) - expected) / expected);
  }
  CHECK(field.report.converged);
  CHECK(reached > 10000);
  CHECK(worst <= 4 * kUlp);
}

TEST_CASE("sweep: a tile is visited when something may fall in it, and visits are counted") {
  const auto visits = [](int seed_x) {
    Band band;
    band.voxel_world = 1;
    band.distance_world = 1e6;
    band.phi = openvdb::FloatGrid::create(Band::kUnreached);
    for (int x = 0; x < 80; ++x) band.phi->tree().setValueOn({x, 3, 3}, Band::kUnreached);
    band.phi->tree().setValueOn({seed_x, 3, 3}, 0.25F);
    band.seed_count = 1;
    return sweep(band, {.tolerance_voxels = 0}).report.tile_visits;
  };
  CHECK(visits(0) >= 10);      // every one of the ten tiles
  CHECK(visits(0) <= 4 * 10);  // the octants towards +x
  CHECK(visits(79) == visits(0));
}
