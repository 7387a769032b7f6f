#pragma once

#include <openvdb/openvdb.h>

#include <cstdint>
#include <vector>

#include "bench/inputs.h"
#include "vdb_offset/rasterize/rasterize.h"

namespace vdb_offset::bench {

/// Rasterize against openvdb::tools::meshToVolume: the same triangles and narrow band, by turns.
/// Ours includes building the wall, with its hierarchy and pseudonormals.
class RasterDuel {
 public:
  explicit RasterDuel(const Input& input) : input_(input) {}

  void repeat();

  double ours_s() const;  ///< medians
  double wall_s() const;  ///< the part of it that the wall takes
  double peer_s() const;
  /// Largest errors on the peer's voxels against the exact distance, voxels.
  double worst_voxels() const { return worst_; }
  double peer_worst_voxels() const { return peer_worst_; }
  /// What the peer made: voxels within kNarrowVoxels; unsigned if the input is open.
  openvdb::FloatGrid::Ptr narrow() const { return narrow_; }

 private:
  void judge(const Wall& wall, const Band& band);

  const Input& input_;
  openvdb::FloatGrid::Ptr narrow_;
  std::vector<double> ours_, wall_, peer_;
  double worst_ = 0, peer_worst_ = 0;
};

}  // namespace vdb_offset::bench
