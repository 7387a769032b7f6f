#pragma once

#include <openvdb/openvdb.h>
#include <openvdb/tools/FastSweeping.h>

#include <cstdint>
#include <map>
#include <vector>

#include "bench/inputs.h"
#include "sweep/kernel.h"
#include "vdb_offset/rasterize/rasterize.h"

namespace vdb_offset::bench {

using Peer = openvdb::tools::FastSweeping<openvdb::FloatGrid>;

/// The peer's names for two starts: from the narrow band outwards, or over the whole band from the
/// voxels beside the surface alone.
enum class Start { DilateSdf, SdfToSdf };

/// The peer's own field: its narrow band dilated to `band` voxels, and swept.
openvdb::FloatGrid::Ptr peer_field(const openvdb::FloatGrid& narrow, int band);

/// The sweep against openvdb::tools::FastSweeping: the same voxels and seeds, by turns. SdfToSdf
/// needs a sign: for an open input the shell at one voxel from the wall stands for the wall.
class SweepDuel {
 public:
  struct Setting {
    const openvdb::FloatGrid& narrow;  ///< from RasterDuel
    const openvdb::FloatGrid& field;   ///< from peer_field
    bool closed;
    int band;
    std::vector<std::size_t> threads;
  };

  SweepDuel(const Setting& setting, Start start);

  /// Ours, and ours with the kernels of plain x86-64, with each number of threads in turn; then the
  /// peer with each of them.
  void repeat();

  /// Medians for a number of threads, nanoseconds an active voxel.
  struct Cost {
    double ours;   ///< sweep(), from a band of seeds to the finished field
    double plain;  ///< the same with plain kernels
    double peer;   ///< FastSweeping::sweep alone
    double whole;  ///< dilateSdf or sdfToSdf, which also make the voxels to sweep
  };
  Cost cost_ns(std::size_t threads) const;
  std::uint64_t active_voxels() const { return active_; }
  double visits_per_tile() const { return visits_per_tile_; }
  int sweeps() const { return sweeps_; }
  /// Largest difference of the two fields, voxels: the peer stops after eight sweeps.
  double worst_voxels() const { return worst_; }

 private:
  void make_ready(Peer& peer) const;
  double ours(Isa isa);
  struct Times {
    std::vector<double> ours, plain, peer, whole;
  };
  void peer(Times& times);

  Start start_;
  int dilation_;
  bool finalize_;                  // the peer sets a background after its sweeps
  openvdb::FloatGrid::Ptr input_;  // the peer's
  Band band_;                      // ours
  std::uint64_t active_ = 0;
  openvdb::FloatGrid::ConstPtr phi_;  // the last field of ours
  std::map<std::size_t, Times> times_;
  double visits_per_tile_ = 0;
  int sweeps_ = 0;
  double worst_ = -1;  // not known yet
};

}  // namespace vdb_offset::bench
