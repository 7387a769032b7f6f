#pragma once

#include <openvdb/openvdb.h>

#include "vdb_offset/surface/surface.h"
#include "vdb_offset/sweep/sweep.h"

namespace vdb_offset {

/// Unit vectors along the gradient of the signed distance times `sign`, on the active voxels of
/// phi.
openvdb::Vec3SGrid::Ptr normal_grid(const DistanceField& field, float sign);

/// Index of the surface's nearest quad, on the active voxels of phi; background -1.
openvdb::Int32Grid::Ptr feature_grid(const DistanceField& field, const Surface& surface);

}  // namespace vdb_offset
