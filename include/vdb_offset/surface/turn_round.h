#pragma once

#include "vdb_offset/surface/patch.h"

namespace vdb_offset {

/// Turns a patch's normal round: reverses i, or the sense of its faces and of its rim.
void turn_round(Patch& patch);

}  // namespace vdb_offset
