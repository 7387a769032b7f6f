#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "vdb_offset/blocks/multi_block.h"

namespace vdb_offset {

/// Scaled Jacobian below which a corner is flat: rounding alone decides on which side it is.
inline constexpr double kFlat = 1e-9;

/// Quality of one hexahedron; a cell with collapsed edges is judged as the prism or pyramid it is.
struct CellQuality {
  /// Verdict's: least normalised Jacobian of the eight corners and the centre, in [-1, 1]; of the
  /// corners alone for a cell with collapsed edges.
  double scaled_jacobian = 0;
  double min_jacobian = 0;  ///< least corner Jacobian, world units^3
  double volume = 0;        ///< of the trilinear map, exact; world units^3
  bool positive = false;    ///< all corner Jacobians and all six tetrahedra are above zero; of a
                            ///< prism or pyramid: the Jacobian of its map, everywhere in it;
                            ///< and the scaled Jacobian is kFlat at least
};

/// In   corners: VTK_HEXAHEDRON order, world; equal corners (bit for bit) are collapsed edges.
/// Out  a cell with no volume at all, or a coordinate that is not finite, is not positive; the
///      latter has a scaled Jacobian of -1.
CellQuality cell_quality(const std::array<Vec3, 8>& corners_world);

/// Shape of one hexahedron. Collapsed edges count for nothing: skewness is of the axes that the
/// others give, aspect ratio and orthogonality are of the edges and the face that are left.
struct CellShape {
  /// Verdict's: largest |cos| between principal axes (sums of the four edges along i, j, k), in
  /// [0, 1]; 1 if an axis has no length.
  double skewness = 0;
  double aspect_ratio = 1;  ///< Verdict's edge ratio: longest edge / shortest edge, >= 1
  /// Least cosine between the four edges along k and the normal (of the diagonals) of the face at
  /// k = 0, the wall's side: 1 is orthogonal, below 0 leans through the wall.
  double orthogonality = 1;
};

/// Corners as above. A cell with a coordinate that is not finite has skewness 1, aspect ratio
/// infinity and orthogonality -1.
CellShape cell_shape(const std::array<Vec3, 8>& corners_world);

/// The worst of some cells.
struct QualityMinima {
  std::uint64_t cells = 0;
  std::uint64_t nonpositive_cells = 0;
  double min_scaled_jacobian = 0;
  double min_jacobian = 0;  ///< world units^3
  double min_volume = 0;
  double max_skewness = 0;
  double max_aspect_ratio = 1;
  double min_orthogonality = 1;
  /// Largest ratio of a cell's height to that of the cell below, each measured along its four
  /// columns; 1 if none grows.
  double growth_max = 1;
  /// Largest ratio of the lengths of two edges that follow one another along i or j, the longer
  /// over the shorter, across interfaces too.
  double side_growth_max = 1;
};

/// Of all cells, of each layer of cells from the wall up, and of each patch (block).
struct QualityReport : QualityMinima {
  double mean_scaled_jacobian = 0;
  double first_cell_min = 0;  ///< true distance of level 1 over all nodes, world units
  double first_cell_median = 0;
  double first_cell_max = 0;
  std::vector<QualityMinima> levels;
  std::vector<QualityMinima> patches;
};

/// Per block, i fastest, then j, then k.
struct QualityField {
  std::vector<std::vector<float>> scaled_jacobian;
  QualityReport report;
};

/// Judge all cells. Cost about 0.04 microseconds a cell with AVX2, 0.09 on plain x86-64; 4 bytes a
/// cell are kept. Threads: bitwise the same for any count.
QualityField judge(const MultiBlock& mesh, const Progress& progress = {});

/// A cell by its block and 0-based indices.
struct CellPlace {
  int block = -1;
  int i = 0;
  int j = 0;
  int k = 0;
  double scaled_jacobian = 0;
};

/// The first `most` cells that are not positive, block by block, i fastest, then j, then k.
std::vector<CellPlace> nonpositive_cells(const MultiBlock& mesh, const QualityField& quality,
                                         std::size_t most);

/// What else is known of the cells of one block, i fastest, then j, then k: 24 bytes a cell.
struct CellFields {
  std::vector<float> min_jacobian;
  std::vector<float> volume;
  std::vector<float> skewness;
  std::vector<float> aspect_ratio;
  std::vector<float> orthogonality;
  std::vector<float> growth;  ///< 1 for the cells at the wall
};

/// Made anew at each call, for whom writes a block. Cost and threads as `judge`.
CellFields cell_fields(const MultiBlock& mesh, const Block& block);

/// Coverage (reached height / requested height) over the nodes of one block.
struct Coverage {
  double mean = 1;
  double min = 1;
};
std::vector<Coverage> coverage(const MultiBlock& mesh);

}  // namespace vdb_offset
