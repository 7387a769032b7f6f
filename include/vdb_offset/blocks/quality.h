#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "vdb_offset/blocks/multi_block.h"

namespace vdb_offset {

/// Quality of one hexahedron; a cell with collapsed edges is judged as the prism or pyramid it is.
struct CellQuality {
  /// Verdict's: least normalised Jacobian of the eight corners and the centre, in [-1, 1]; of the
  /// corners alone for a cell with collapsed edges.
  double scaled_jacobian = 0;
  double min_jacobian = 0;  ///< least corner Jacobian, world units^3
  double volume = 0;        ///< world units^3, by six tetrahedra
  bool positive = false;    ///< all corner Jacobians and all six tetrahedra are above zero
                            ///< (tetrahedra that collapsed edges leave flat do not count)
};

/// In   corners: VTK_HEXAHEDRON order, world; equal corners (bit for bit) are collapsed edges.
/// Out  a cell with no volume at all, or a coordinate that is not finite, is not positive; the
///      latter has a scaled Jacobian of -1.
CellQuality cell_quality(const std::array<Vec3, 8>& corners_world);

struct QualityReport {
  double min_scaled_jacobian = 0;
  double mean_scaled_jacobian = 0;
  std::uint64_t nonpositive_cells = 0;
  double min_volume = 0;
  double first_cell_min = 0;  ///< true distance of level 1 over all nodes, world units
  double first_cell_median = 0;
  double first_cell_max = 0;
  double growth_max = 1;  ///< largest ratio of a cell's height to the one below it in a column
};

/// Quality of every cell: per block, i fastest, then j, then k.
struct QualityField {
  std::vector<std::vector<float>> scaled_jacobian;
  std::vector<std::vector<float>> volume;
  QualityReport report;
};

/// Judge all cells. Cell heights for the growth are lengths along the column. Cost about 0.15
/// microseconds a cell. Threads: bitwise the same for any count.
QualityField judge(const MultiBlock& mesh, const Progress& progress = {});

/// Coverage (reached height / requested height) over the nodes of one block.
struct Coverage {
  double mean = 1;
  double min = 1;
};
std::vector<Coverage> coverage(const MultiBlock& mesh);

}  // namespace vdb_offset
