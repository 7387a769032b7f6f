#include "bench/sweep_duel.h"

#include <openvdb/tools/ChangeBackground.h>
#include <openvdb/tree/LeafManager.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "bench/measure.h"
#include "sweep/sweep_with.h"

namespace vdb_offset::bench {

namespace {

using Leaf = openvdb::FloatTree::LeafNodeType;
using Leaves = openvdb::tree::LeafManager<openvdb::FloatTree>;

/// What the peer does after its sweeps, setting the background, it refuses without a sign.
bool is_signed(const openvdb::FloatGrid& narrow) {
  return narrow.getGridClass() == openvdb::GRID_LEVEL_SET;
}

/// An unsigned distance less one voxel: signed again.
openvdb::FloatGrid::Ptr shell_of(const openvdb::FloatGrid& distance) {
  openvdb::FloatGrid::Ptr shell = distance.deepCopy();
  Leaves(shell->tree()).foreach ([](Leaf& leaf, std::size_t) {
    for (auto it = leaf.beginValueOn(); it; ++it) it.setValue(*it - 1);
  });
  return shell;
}

/// A band for sweep() from what the peer has made ready: its voxels, and its values as the seeds.
Band band_of(const openvdb::FloatGrid& ready, bool closed) {
  Band band;
  band.voxel_world = 1;
  band.distance_world = 1e6;  // nothing is cut off
  band.closed = closed;
  band.both_sides = true;
  band.seed_count = 1;
  band.phi = ready.deepCopy();
  openvdb::tools::changeBackground(band.phi->tree(), Band::kUnreached);
  Leaves(band.phi->tree()).foreach ([](Leaf& leaf, std::size_t) {
    for (auto it = leaf.beginValueAll(); it; ++it) {
      const bool is_seed = it.isValueOn() && std::abs(*it) < Band::kUnreached;
      if (!is_seed) it.setValue(std::copysign(Band::kUnreached, *it));
    }
  });
  return band;
}

double worst_difference(const openvdb::FloatGrid& ours, const openvdb::FloatGrid& peer) {
  const auto other = ours.getConstAccessor();
  double worst = 0;
  for (auto it = peer.cbeginValueOn(); it; ++it) {
    worst = std::max(worst, std::abs(double(*it) - double(other.getValue(it.getCoord()))));
  }
  return worst;
}

}  // namespace

openvdb::FloatGrid::Ptr peer_field(const openvdb::FloatGrid& narrow, int band) {
  Peer peer;
  peer.initDilate(narrow, band - kNarrowVoxels);
  peer.sweep(1, is_signed(narrow));
  return peer.sdfGrid();
}

SweepDuel::SweepDuel(const Setting& setting, Start start)
    : start_(start), dilation_(setting.band - kNarrowVoxels) {
  const bool is_shell = start == Start::SdfToSdf && !setting.closed;
  const openvdb::FloatGrid& from = start == Start::DilateSdf ? setting.narrow : setting.field;
  input_ = is_shell ? shell_of(from) : from.deepCopy();
  finalize_ = setting.closed || is_shell;
  Peer peer;
  make_ready(peer);
  band_ = band_of(*peer.sdfGrid(), finalize_);
  active_ = band_.phi->activeVoxelCount();
  for (const std::size_t threads : setting.threads) times_[threads] = {};
}

void SweepDuel::make_ready(Peer& peer) const {
  if (start_ == Start::SdfToSdf) {
    peer.initSdf(*input_, 0.0F, true);
  } else {
    peer.initDilate(*input_, dilation_);
  }
}

void SweepDuel::repeat() {
  constexpr auto kLimit = tbb::global_control::max_allowed_parallelism;
  for (auto& [threads, times] : times_) {
    const tbb::global_control limit(kLimit, threads);
    times.plain.push_back(ours(kernels(Isa::Sse2) != nullptr ? Isa::Sse2 : Isa::Scalar));
    times.ours.push_back(ours(best_isa()));
  }
  for (auto& [threads, times] : times_) {
    const tbb::global_control limit(kLimit, threads);
    peer(times);
  }
}

double SweepDuel::ours(Isa isa) {
  Band band = band_;
  band.phi = band_.phi->deepCopy();
  const auto tiles = static_cast<double>(band.phi->tree().leafCount());
  DistanceField field;
  const double time = seconds([&] { field = sweep_with(*kernels(isa), std::move(band)); });
  visits_per_tile_ = static_cast<double>(field.report.tile_visits) / tiles;
  sweeps_ = field.report.sweeps;
  phi_ = field.phi;
  return time;
}

void SweepDuel::peer(Times& times) {
  Peer peer;
  const double init = seconds([&] { make_ready(peer); });
  times.peer.push_back(seconds([&] { peer.sweep(1, finalize_); }));
  times.whole.push_back(init + times.peer.back());
  if (worst_ < 0) worst_ = worst_difference(*phi_, *peer.sdfGrid());
}

SweepDuel::Cost SweepDuel::cost_ns(std::size_t threads) const {
  const Times& times = times_.at(threads);
  const double scale = 1e9 / static_cast<double>(active_);
  return {scale * median(times.ours), scale * median(times.plain), scale * median(times.peer),
          scale * median(times.whole)};
}

}  // namespace vdb_offset::bench
