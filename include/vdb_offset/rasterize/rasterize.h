#pragma once

#include <cstdint>
#include <memory>

#include "vdb_offset/core/progress.h"
#include "vdb_offset/core/vdb_fwd.h"
#include "vdb_offset/surface/surface.h"

namespace vdb_offset {

/// Unless more is asked for, every voxel centre within this of the wall, in voxels, is a seed on
/// either side; it covers all nodes of every cell that the surface crosses (sqrt 3), and the
/// stencil of a gradient there.
inline constexpr double kSeedReachVoxels = 2.5;

struct RasterizeOptions {
  /// Reach of the band from the wall, world units.  Range: > 0, finite.
  double distance_world = 0;
  /// Voxel edge, world units.  Range: > 0, at most 1000 times the surface's size; 0 chooses
  /// min(distance / 12, median surface edge), enlarged until the estimate fits `memory_bytes`.
  /// Halving it costs 8 times the voxels.
  double voxel_world = 0;
  /// Most that the whole run may allocate.  0: three quarters of the machine's free memory.
  std::uint64_t memory_bytes = 0;
  /// Bytes that the run will need besides the band (the process itself, layers, blocks).
  std::uint64_t other_bytes = 0;
  /// Bytes that the output will hold for each leaf tile, when the sweep is over.
  std::uint64_t output_tile_bytes = 0;
  /// Fill the band behind the wall too, not just the two voxels that gradients need.
  bool both_sides = false;
  /// With both sides of an open surface, which has no inside: phi >= 0 everywhere. Saves the search
  /// for the nearest place of every voxel past a free edge.
  bool unsigned_if_open = false;
  /// Voxel centres within this of the wall are seeds, on either side.
  /// Range: [kSeedReachVoxels, 16].  Costs its square in time.
  double exact_voxels = kSeedReachVoxels;

  void validate() const;
};

/// Which rule chose the voxel.
enum class VoxelRule { Given, Distance, SurfaceEdge, Memory };

/// What a band will take, known before anything large is allocated.
struct BandPlan {
  double voxel_world = 0;
  VoxelRule rule = VoxelRule::Given;
  std::uint64_t tiles = 0;        ///< leaf tiles of 8^3 voxels, an upper estimate
  std::uint64_t bytes = 0;        ///< of the band, with the larger of sweep and output
  std::uint64_t total_bytes = 0;  ///< with the surface and `other_bytes`
  std::uint64_t limit_bytes = 0;
};

/// The sparse set of active voxels around a surface, and its seeds.
///
/// The lattice is anchored at the world's zero: voxel (i, j, k) sits at `voxel_world * (i, j, k)`.
struct Band {
  std::shared_ptr<FloatGrid> phi;  ///< seeds: exact signed distance, world units (negative behind,
                                   ///< unless `unsigned_if_open` asked for no sign);
                                   ///< other active voxels: +kUnreached, or -kUnreached behind
  double voxel_world = 0;
  double distance_world = 0;
  bool closed = false;
  bool both_sides = false;
  bool flat = false;  ///< of a flat surface: one slice of voxels, in z = 0
  std::shared_ptr<const Boundaries> boundaries;  ///< no active voxel beyond them; null: none
  std::shared_ptr<const Wall> wall;              ///< what is mirrored on them; null without them
  std::uint64_t seed_count = 0;
  BandPlan plan;

  /// Magnitude of phi at voxels that no sweep has reached.
  static constexpr float kUnreached = 1e30F;
};

/// OpenVDB refuses transforms whose determinant is below 3e-15: grids with smaller voxels keep the
/// identity, and cannot be written. Columns and blocks do not depend on it.
inline constexpr double kLeastVdbVoxel = 1.45e-5;
/// The band reaches past the distance asked for by this many voxels, so that gradients exist there.
inline constexpr double kBandMarginVoxels = 4.0;

/// Choose the voxel and count the band's tiles without building them.
/// Cost     seconds at most, at any distance.
/// Throws   LimitError when `voxel_world` is given and does not fit, with the voxel that would, and
///          when none up to 1000 times the surface's size fits; Cancelled.
BandPlan plan_band(const Surface& surface, const RasterizeOptions& options,
                   const Progress& progress = {});

/// Mark the band and seed it with exact distances.
///
/// Accuracy seeds: exact point-triangle distance in double, rounded once to float.
/// Cost     about 1 microsecond a seed. Threads: tiles side by side, bitwise the same for any
/// count. Throws   InputError for options out of range; LimitError as plan_band; Cancelled.
Band rasterize(const Surface& surface, const RasterizeOptions& options,
               const Progress& progress = {});

}  // namespace vdb_offset
