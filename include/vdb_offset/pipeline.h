#pragma once

#include <functional>
#include <string_view>

#include "vdb_offset/blocks/check_crossings.h"
#include "vdb_offset/blocks/check_sides.h"
#include "vdb_offset/blocks/conditions.h"
#include "vdb_offset/blocks/multi_block.h"
#include "vdb_offset/blocks/quality.h"
#include "vdb_offset/blocks/repair.h"
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
  RepairOptions repair;
  ConditionOptions conditions;

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

struct MeshResult : FieldResult {
  MultiBlock mesh;
  QualityField quality;
  RepairReport repair;
  SidesReport sides;
  CrossingsReport crossings;
};

/// Called after each stage ("surface", "rasterize", "sweep", "march", "blocks") with what is there
/// so far; after "march" that is `mesh.layers` only.
using AfterFieldStage = std::function<void(std::string_view stage, const FieldResult& so_far)>;
using AfterMeshStage = std::function<void(std::string_view stage, const MeshResult& so_far)>;

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
                       const Progress& progress = {}, const AfterFieldStage& after_stage = {});

/// Patches to blocks: every stage once, in order. Families whose layers are off are no wall: their
/// patches are a boundary surface of that name, which their neighbours' layers end on where they
/// meet it at an angle; where the wall goes on into them smoothly layers taper to nothing.
/// Throws InputError, LimitError, Cancelled.
MeshResult make_mesh(Patches patches, const PipelineOptions& options, const Progress& progress = {},
                     const AfterMeshStage& after_stage = {});

}  // namespace vdb_offset
