#pragma once

#include "vdb_offset/pipeline.h"

namespace vdb_offset::test {

/// Twelve layers that grow as they have to.
inline PipelineOptions options_for(double distance, double voxel) {
  PipelineOptions options;
  options.distance_world = distance;
  options.rasterize.voxel_world = voxel;
  options.spacing.layers = 12;
  options.spacing.first_cell_world = 1e-3;
  options.spacing.max_growth = 10;
  return options;
}

}  // namespace vdb_offset::test
