#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "vdb_offset/blocks/multi_block.h"

namespace vdb_offset {

/// Quality of one hexahedron; a cell with collapsed edges is judged as the prism or pyramid it is.
struct CellQuality {
  double scaled_jacobian =
      0;                    ///< Verdict's: least of the corners' normalised Jacobians, in [-1, 1]
  double min_jacobian = 0;  ///< least corner Jacobian, world units^3
  double volume = 0;        ///< world units^3, by six tetrahedra
  bool positive = false;    ///< all corner Jacobians and all six tetrahedra are above zero
};

/// In  corners: VTK_HEXAHEDRON order, world; equal corners (bit for bit) are collapsed edges.
CellQuality cell_quality(const std::array<Vec3, 8>& corners_world);

struct QualityReport {
  double min_scaled_jacobian = 0;
  double mean_scaled_jacobian = 0;
  std::uint64_t nonpositive_cells = 0;
  double min_volume = 0;
  double first_cell_min = 0;  ///< true distance of level 1 over all nodes, world units
  double first_cell_median = 0;
  double first_cell_max = 0;
  double growth_max = 1;  ///< largest ratio of neighbouring cell heights along a column
};

/// Quality of every cell: per block, i fastest, then j, then k.
struct QualityField {
  std::vector<std::vector<float>> scaled_jacobian;
  std::vector<std::vector<float>> volume;
  QualityReport report;
};

/// Judge all cells. Cost about 0.3 microseconds a cell. Threads: bitwise the same for any count.
QualityField judge(const MultiBlock& mesh, const Progress& progress = {});

/// Coverage (reached height / requested height) over the nodes of one block.
struct Coverage {
  double mean = 1;
  double min = 1;
};
std::vector<Coverage> coverage(const MultiBlock& mesh);

}  // namespace vdb_offset
