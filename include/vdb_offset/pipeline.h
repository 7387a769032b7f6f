#pragma once

#include <string>

#include "vdb_offset/blocks/multi_block.h"
#include "vdb_offset/blocks/quality.h"
#include "vdb_offset/core/progress.h"
#include "vdb_offset/march/march.h"
#include "vdb_offset/march/spacing.h"
#include "vdb_offset/rasterize/rasterize.h"
#include "vdb_offset/surface/surface.h"
#include "vdb_offset/sweep/sweep.h"

namespace vdb_offset {

/// The stages' options together. `distance_world` sets the reach of the band and the height of the
/// layers.
struct PipelineOptions {
  double distance_world = 0;  ///< thickness of the layers, true distance.  Range: > 0, finite.
  SurfaceOptions surface;
  RasterizeOptions rasterize;  ///< its distance is taken from `distance_world`
  SweepOptions sweep;
  SpacingOptions spacing;
  MarchOptions march;

  void validate() const;
};

/// Seconds by stage.
struct StageTimes {
  double surface = 0, rasterize = 0, sweep = 0, march = 0, blocks = 0;
};

struct FieldResult {
  Surface surface;
  BandPlan plan;
  DistanceField field;
  StageTimes time;
};

struct MeshResult {
  Surface surface;
  BandPlan plan;
  DistanceField field;
  MultiBlock mesh;
  QualityField quality;
  StageTimes time;
};

/// What a run would make and take.
struct Plan {
  Surface surface;
  LayerSpacing spacing;
  BandPlan band;
};

/// Surface and sizes only: nothing large is allocated. Throws as the stages do, LimitError
/// included.
Plan plan_mesh(Patches patches, const PipelineOptions& options, const Progress& progress = {});

/// Patches to distance field. Throws InputError, LimitError, Cancelled.
FieldResult make_field(Patches patches, const PipelineOptions& options,
                       const Progress& progress = {});

/// Patches to blocks: every stage once, in order. Throws InputError, LimitError, Cancelled.
MeshResult make_mesh(Patches patches, const PipelineOptions& options,
                     const Progress& progress = {});

}  // namespace vdb_offset
