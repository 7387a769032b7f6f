#pragma once

#include <cstdint>
#include <vector>

#include "vdb_offset/blocks/multi_block.h"
#include "vdb_offset/blocks/quality.h"
#include "vdb_offset/core/progress.h"
#include "vdb_offset/surface/surface.h"

namespace vdb_offset {

struct RepairOptions {
  /// Whether columns are moved at all.
  bool on = true;
  /// Least scaled Jacobian that cells are brought to, where the wall's own corners allow it: at
  /// most 0.7 of what a face has at its corners where the columns leave the wall. Columns that move
  /// aim at twice as much. A larger one takes longer, and moves more columns.  Range: [0, 1).
  double quality = 0.2;
  /// Most memory that windows may take, about 1.4 kilobytes a point. 0: 3/4 of what is free.
  std::uint64_t memory_bytes = 0;

  void validate() const;
};

struct RepairReport {
  int windows = 0;     ///< connected regions whose columns moved
  int columns = 0;     ///< that could move, or are lower
  int lowered = 0;     ///< of them, that end lower than the march had them, by a thousandth or more
  double beyond = 0;   ///< ends farther from the wall than asked, the most, relative to that
  int steps = 0;       ///< Newton steps, the most of any window
  int unmended = 0;    ///< windows that hold a cell that is not positive still
  int fall_short = 0;  ///< faces of the wall with a cell over them below the quality asked for
};

struct RepairResult {
  QualityField quality;  ///< of all cells, afterwards
  RepairReport report;
};

/// Judge all cells, and move the columns around those that are not positive, have collapsed or are
/// worse than asked until they are valid. A foldover-free map (Garanzha, Kaporin, Kudryavtseva,
/// Protais, Ray, Sokolov, Foldover-free maps in 50 lines of code, 2021), with levels held to their
/// true distances.
///
/// In        mesh: the march's; points on the wall do not move, those on boundaries stay on them,
///           ends of columns on internal surfaces too unless they have to be lowered, and columns
///           that go through none do not afterwards; points of the domain stay in it.
/// Out       columns elsewhere are the same bit for bit. Where no place is valid heights sink,
///           as in corners sharper than about 53 degrees; to nothing where no direction is free:
///           cells lose edges. Where ends moved `stop` is Stop::Repaired, heights measured anew.
///           Outermost levels are parted anew where ends left an internal surface.
/// Accuracy  in windows levels lower than a twentieth of the shortest edge beside them, first cells
///           mostly, keep every bit where their cells are good; others end at their heights to 1e-9
///           where cells stay good, else within a part of their layer of them.
/// Cost      windows: 0.05 to 0.2 milliseconds and 1 kilobyte a point; elsewhere as `judge`.
/// Threads   bitwise the same for any count.
/// Throws    InputError for options out of range; LimitError beyond `memory_bytes`; Cancelled.
RepairResult repair(const Surface& surface, MultiBlock& mesh, const RepairOptions& options = {},
                    const Progress& progress = {});

}  // namespace vdb_offset
