#pragma once

#include <openvdb/openvdb.h>

#include "vdb_offset/core/progress.h"
#include "vdb_offset/io/vdb.h"
#include "vdb_offset/sweep/sweep.h"

namespace vdb_offset {

/// Unit vectors along the gradient of the signed distance times `sign`, on the active voxels of
/// phi.
/// Throws Cancelled.
openvdb::Vec3SGrid::Ptr normal_grid(const DistanceField& field, float sign,
                                    const Progress& progress);

/// Number of the nearest face of `options.feature_of` (see write_vdb), on the active voxels of phi;
/// background -1. Throws Cancelled.
openvdb::Int32Grid::Ptr feature_grid(const DistanceField& field, const VdbWriteOptions& options,
                                     const Progress& progress);

}  // namespace vdb_offset
