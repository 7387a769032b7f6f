#pragma once

// The sweep against OpenVDB's tools::FastSweeping: the same voxels, seeds and threads, in one
// process, by turns.

#include <fmt/format.h>
#include <openvdb/openvdb.h>
#include <openvdb/tools/ChangeBackground.h>
#include <openvdb/tools/FastSweeping.h>
#include <openvdb/tools/LevelSetSphere.h>
#include <openvdb/tree/LeafManager.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <string>
#include <vector>

#include "sweep/kernel.h"
#include "sweep/sweep_with.h"
#include "vdb_offset/sweep/sweep.h"

namespace vdb_offset::bench {

/// What one case measured: medians over the repeats. Times are nanoseconds an active voxel.
struct SweepRow {
  std::string name;
  std::size_t threads = 1;
  std::uint64_t active_voxels = 0;
  double sweep_ns = 0;       ///< sweep(), from a band of seeds to the finished field
  double plain_ns = 0;       ///< the same with the kernels of plain x86-64
  double peer_sweep_ns = 0;  ///< FastSweeping::sweep alone
  double peer_whole_ns = 0;  ///< dilateSdf or sdfToSdf, which also make the voxels to sweep
  double visits_per_tile = 0;
  int sweeps = 0;
};

inline double median(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  const std::size_t n = values.size();
  return n == 0 ? 0 : (values[(n - 1) / 2] + values[n / 2]) / 2;
}

/// Seconds that `work` takes.
template <typename Work>
double seconds(const Work& work) {
  const auto start = std::chrono::steady_clock::now();
  work();
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

/// A sphere about a point off the lattice, and a band to fill on both sides.
struct SphereCase {
  float radius = 100;  // voxels, as all lengths here
  int band = 20;
  bool from_scratch = false;  // sdfToSdf: seeds are the voxels beside the surface, not a band of 3

  std::string name() const {
    return fmt::format("sphere-{:.0f}-band-{}-{}", radius, band,
                       from_scratch ? "sdfToSdf" : "dilateSdf");
  }
};

constexpr int kNarrow = 3;
inline const openvdb::Vec3f kCentre(0.11F, -0.23F, 0.37F);

inline openvdb::FloatGrid::Ptr narrow_band(const SphereCase& sphere) {
  return openvdb::tools::createLevelSetSphere<openvdb::FloatGrid>(sphere.radius, kCentre, 1.0F,
                                                                  static_cast<float>(kNarrow));
}

/// The band for sweep(): the active voxels of `voxels`, with exact distances at the seeds.
inline Band band_of(const openvdb::FloatGrid& voxels, const SphereCase& sphere) {
  Band band;
  band.voxel_world = 1;
  band.distance_world = 1e6;  // nothing is cut off
  band.closed = true;
  band.both_sides = true;
  band.seed_count = 1;
  band.phi = voxels.deepCopy();
  openvdb::tools::changeBackground(band.phi->tree(), Band::kUnreached);
  const auto distance = [&](const openvdb::Coord& c) {
    return (openvdb::Vec3f(c.asVec3s()) - kCentre).length() - sphere.radius;
  };
  const auto seed = [&](const openvdb::Coord& c, float phi) {
    if (!sphere.from_scratch) return std::abs(phi) < static_cast<float>(kNarrow);
    if (std::abs(phi) > 1) return false;
    return std::any_of(std::begin(openvdb::util::COORD_OFFSETS),
                       std::begin(openvdb::util::COORD_OFFSETS) + 6,
                       [&](const openvdb::Coord& o) { return (distance(c + o) < 0) != (phi < 0); });
  };
  openvdb::tree::LeafManager<openvdb::FloatTree> leaves(band.phi->tree());
  leaves.foreach ([&](openvdb::FloatTree::LeafNodeType& leaf, std::size_t) {
    for (auto it = leaf.beginValueAll(); it; ++it) {
      const float phi = distance(it.getCoord());
      it.setValue(
          it.isValueOn() && seed(it.getCoord(), phi) ? phi : std::copysign(Band::kUnreached, phi));
    }
  });
  return band;
}

inline Band copy_of(const Band& band) {
  Band copy = band;
  copy.phi = band.phi->deepCopy();
  return copy;
}

/// One repeat of a case: ours, ours with plain kernels, and the peer.
class SweepDuel {
 public:
  explicit SweepDuel(const SphereCase& sphere) : sphere_(sphere), input_(narrow_band(sphere)) {
    Peer peer;
    peer.initDilate(*input_, sphere.band - kNarrow);
    if (sphere.from_scratch) {
      peer.sweep();
      input_ = peer.sdfGrid();
    }
    band_ = band_of(*peer.sdfGrid(), sphere);
    active_ = static_cast<double>(band_.phi->activeVoxelCount());
  }

  void repeat(bool with_peer) {
    ours_.push_back(ours(best_isa()));
    plain_.push_back(ours(kernels(Isa::Sse2) != nullptr ? Isa::Sse2 : Isa::Scalar));
    if (with_peer) peer();
  }

  SweepRow row(std::size_t threads) const {
    return {.name = sphere_.name(),
            .threads = threads,
            .active_voxels = static_cast<std::uint64_t>(active_),
            .sweep_ns = median(ours_) * 1e9 / active_,
            .plain_ns = median(plain_) * 1e9 / active_,
            .peer_sweep_ns = median(peer_) * 1e9 / active_,
            .peer_whole_ns = median(whole_) * 1e9 / active_,
            .visits_per_tile = visits_per_tile_,
            .sweeps = sweeps_};
  }

 private:
  using Peer = openvdb::tools::FastSweeping<openvdb::FloatGrid>;

  double ours(Isa isa) {
    Band band = copy_of(band_);
    const double tiles = static_cast<double>(band.phi->tree().leafCount());
    DistanceField field;
    const double time = seconds([&] { field = sweep_with(*kernels(isa), std::move(band)); });
    visits_per_tile_ = static_cast<double>(field.report.tile_visits) / tiles;
    sweeps_ = field.report.sweeps;
    return time;
  }

  void peer() {
    Peer peer;
    const double init = seconds([&] {
      if (sphere_.from_scratch) {
        peer.initSdf(*input_, 0.0F, true);
      } else {
        peer.initDilate(*input_, sphere_.band - kNarrow);
      }
    });
    peer_.push_back(seconds([&] { peer.sweep(); }));
    whole_.push_back(init + peer_.back());
  }

  SphereCase sphere_;
  openvdb::FloatGrid::Ptr input_;
  Band band_;
  double active_ = 0;
  std::vector<double> ours_, plain_, peer_, whole_;
  double visits_per_tile_ = 0;
  int sweeps_ = 0;
};

}  // namespace vdb_offset::bench
