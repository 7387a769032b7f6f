#pragma once

#include "vdb_offset/blocks/multi_block.h"
#include "vdb_offset/core/progress.h"
#include "vdb_offset/surface/surface.h"

namespace vdb_offset {

struct RepairOptions {
  bool on = true;
  /// Least scaled Jacobian to aim for, where the wall's own corners allow it.  Range: [0, 1).
  double quality = 0.2;

  void validate() const;
};

struct RepairReport {
  int windows = 0;
  int columns = 0;       ///< that moved
  int free_nodes = 0;    ///< points that moved
  int steps = 0;         ///< Newton steps, the most of any window
};

RepairReport repair(const Surface& surface, const RepairOptions& options, MultiBlock& mesh,
                    const Progress& progress = {});

}  // namespace vdb_offset
