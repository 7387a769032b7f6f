#pragma once

#include "sweep/kernel.h"
#include "vdb_offset/sweep/sweep.h"

namespace vdb_offset {

/// sweep() with the kernels of one instruction set: the same bits whichever it is.
DistanceField sweep_with(const Kernels& kernels, Band band, const SweepOptions& options = {},
                         const Progress& progress = {});

}  // namespace vdb_offset
