#pragma once

#include <openvdb/openvdb.h>
#include <openvdb/tools/FastSweeping.h>

#include <cstdint>
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
  };

  SweepDuel(const Setting& setting, Start start);

  /// Ours, ours with the kernels of plain x86-64, and the peer.
  void repeat();

  // Medians, nanoseconds an active voxel.
  double ours_ns() const;   ///< sweep(), from a band of seeds to the finished field
  double plain_ns() const;  ///< the same with plain kernels
  double peer_ns() const;   ///< FastSweeping::sweep alone
  double whole_ns() const;  ///< dilateSdf or sdfToSdf, which also make the voxels to sweep
  std::uint64_t active_voxels() const { return active_; }
  double visits_per_tile() const { return visits_per_tile_; }
  int sweeps() const { return sweeps_; }
  /// Largest difference of the two fields, voxels: the peer stops after eight sweeps.
  double worst_voxels() const { return worst_; }

 private:
  void make_ready(Peer& peer) const;
  double ours(Isa isa, openvdb::FloatGrid::ConstPtr& phi);
  void peer(const openvdb::FloatGrid& ours);
  double per_voxel(const std::vector<double>& times) const;

  Start start_;
  int dilation_;
  bool finalize_;                  // the peer sets a background after its sweeps
  openvdb::FloatGrid::Ptr input_;  // the peer's
  Band band_;                      // ours
  std::uint64_t active_ = 0;
  std::vector<double> ours_, plain_, peer_, whole_;
  double visits_per_tile_ = 0;
  int sweeps_ = 0;
  double worst_ = 0;
};

}  // namespace vdb_offset::bench
