#pragma once

#include "vdb_offset/blocks/multi_block.h"
#include "vdb_offset/blocks/quality.h"

namespace vdb_offset {

/// Fills in `side_growth_max` of the report, its levels and its patches (whose sizes are set).
/// Edges without length are passed over. Bitwise the same for any number of threads.
void report_side_growth(const MultiBlock& mesh, QualityReport& report);

}  // namespace vdb_offset
