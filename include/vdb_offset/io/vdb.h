#pragma once

#include <filesystem>

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
  /// Store floats as 16 bits: half the file, 3 digits (a distance of 20 voxels is off by 1/100).
  bool half = false;
};

/// Write the grids asked for and, with `layers`, `level` (the outermost level's points, a
/// PointDataGrid, in node order within a voxel).
///
/// `phi` is GRID_LEVEL_SET for a closed surface: negative behind the wall, inactive voxels too,
/// background = half-width in world units. A closed surface that the blocks fill from inside (a
/// duct) is signed as well, but GRID_UNKNOWN: level sets cannot be negative out to infinity. Filled
/// on both sides, it is turned round to be a level set.
/// An open surface gives GRID_UNKNOWN and |phi|.
/// `normal` points to the marching side (out of what is turned round) on either side of the wall:
/// central differences, one-sided at the band's rim; zero where all differences vanish.
/// `feature` is the index of the nearest quad, counted from 0 over the patches in their order, i
/// fastest; exact in every voxel (a query, not carried along); of equally near quads any, but
/// always the same; patches doubled by MarchSide::Both count once. Voxels outside the band hold -1.
/// Cost    a copy of the tree where its values change, unless `field` is its only owner (moved in):
/// a level set's do not; about 0.1 microsecond a voxel for `normal`, 2 to 4 for `feature`.
/// The same trees and metadata for any thread count.
/// Throws  IoError naming the file: also, before anything is written, for voxels below
/// kLeastVdbVoxel (OpenVDB refuses them) and for distances that 16 bits cannot hold. By temporary
/// file and rename.
void write_vdb(const std::filesystem::path& file, DistanceField field,
               const Layers* layers = nullptr, const VdbWriteOptions& options = {});

}  // namespace vdb_offset
