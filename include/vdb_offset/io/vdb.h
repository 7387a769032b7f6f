#pragma once

#include <filesystem>
#include <vector>

#include "vdb_offset/core/progress.h"
#include "vdb_offset/march/march.h"
#include "vdb_offset/surface/surface.h"
#include "vdb_offset/sweep/sweep.h"

namespace vdb_offset {

/// Which grids a file gets besides the points of `layers`, and how.
struct VdbWriteOptions {
  bool phi = true;
  /// `normal`: Vec3s, unit vectors along the gradient of the signed distance, on phi's voxels.
  bool normal = false;
  /// `feature`: Int32, the nearest cell of this surface, on phi's voxels; null: no such grid.
  const Surface* feature_of = nullptr;
  /// Of each of its patches the numbers of its cells, polygons in their order, grids i fastest; or
  /// none, and they count on behind the highest number so far. Without any: from 0 over the
  /// patches.
  std::vector<std::vector<int>> face_numbers = {};
  /// Store floats as 16 bits: half the file, 3 digits (a distance of 20 voxels is off by 1/100).
  bool half = false;
};

/// Throws IoError naming the file for what `write_vdb` refuses: voxels below kLeastVdbVoxel, which
/// OpenVDB does not hold, and with `half` a `reach_world` of the band that 16 bits cannot hold.
void check_vdb_limits(const std::filesystem::path& file, double voxel_world, double reach_world,
                      bool half);

/// Write the grids asked for and, with `layers`, `level` (the outermost level's points, a
/// PointDataGrid, in node order within a voxel).
///
/// `phi` is GRID_LEVEL_SET for a closed surface: negative behind the wall, inactive voxels too,
/// background = half-width in world units. A closed surface that the blocks fill from inside (a
/// duct) is signed as well, but GRID_UNKNOWN: level sets cannot be negative out to infinity. Filled
/// on both sides, it is turned round to be a level set.
/// An open surface gives GRID_UNKNOWN and |phi|. Closed curves are as closed surfaces, in z = 0.
/// `normal` points to the marching side (out of what is turned round) on either side of the wall:
/// central differences, one-sided at the band's rim; zero where all differences vanish.
/// `feature` is the number of the nearest face (see `face_numbers`); exact in every voxel (a query,
/// not carried along); of equally near faces any, but always the same; patches doubled by
/// MarchSide::Both count once. Voxels outside the band hold -1.
/// Cost    a copy of the tree where its values change, unless `field` is its only owner (moved in):
/// a level set's do not; about 0.1 microsecond a voxel for `normal`, 2 to 4 for `feature`.
/// The same trees and metadata for any thread count.
/// Throws  IoError naming the file: also, before anything is written, as check_vdb_limits.
/// Cancelled, and no file is left. By temporary file and rename.
void write_vdb(const std::filesystem::path& file, DistanceField field,
               const Layers* layers = nullptr, const VdbWriteOptions& options = {},
               const Progress& progress = {});

}  // namespace vdb_offset
