#pragma once

#include <vector>

#include "command.h"
#include "outputs.h"
#include "vdb_offset/pipeline.h"

namespace vdb_offset::command {

/// --sign closed is for surfaces that are: throws InputError for others.
void refuse_open(const Surface& surface, const Settings& settings);

/// How the side is told, where that was chosen by what the surface is, and where the nearest face
/// does not tell it.
void print_sign(const Console& console, const Surface& surface, const Settings& settings);

/// Warns of a gap that voxels resolve, but that welding closed.
void print_closed_gap(const Console& console, const FieldResult& result, const PolygonUse& read,
                      const Settings& settings);

/// Throws IoError for outputs that cannot hold the voxels or distances of a band of `surface`,
/// before it is made. Cost: nothing, but for bands that may be refused that of plan_band.
void refuse_unwritable(const Surface& surface, const PipelineOptions& pipeline,
                       const std::vector<Output>& outputs, const Settings& settings);

/// The numbers of the surface's cells in the files, a vector a patch, for VdbWriteOptions.
std::vector<std::vector<int>> numbers_in_files(const Surface& surface, const PolygonUse& read,
                                               MarchSide side);

}  // namespace vdb_offset::command
