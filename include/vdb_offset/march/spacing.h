#pragma once

#include <optional>
#include <vector>

namespace vdb_offset {

/// How N layers of cells share a height.
///
/// Two of layers, first cell and growth are given, the height fixes the third; what is missing
/// beyond that is layers = 32, then growth = 1.2.
struct SpacingOptions {
  std::optional<int> layers;               ///< cells, [1, 10000]
  std::optional<double> first_cell_world;  ///< height of the first cell, > 0
  std::optional<double> growth;            ///< ratio of neighbouring cells, [1, 10]
  std::optional<double> last_cell_world;   ///< height of the last cell; needs layers and first cell
  double max_growth = 2.0;                 ///< a larger growth is refused, (1, 10]

  void validate() const;
};

/// The law in force: cell k of N has height first * exp(b k + c k (N - 1 - k)), heights sum to the
/// height. c = 0 (a geometric series, growth = exp b) unless a last cell is asked for.
struct LayerSpacing {
  int layers = 0;
  double height_world = 0;
  double first_cell_world = 0;
  double last_cell_world = 0;
  double growth = 1;                  ///< largest ratio of neighbouring cells; below 1 where N was
                                      ///< rounded up and N first cells are more than the height
  double curvature = 0;               ///< c of the law, 0 without a last cell
  double growth_requested = 0;        ///< as asked, 0 if it was solved for
  std::vector<double> heights_world;  ///< layers + 1, from 0 to height_world exactly
};

/// Solve the spacing law for a height.
/// Accuracy: first cell and height are met to 1e-14 relative.
/// Throws InputError with the numbers, and what would fit, when the wishes contradict each other.
LayerSpacing solve_spacing(double height_world, const SpacingOptions& options);

/// The same number of layers in a smaller height: the first cell kept while N of them fit, else all
/// cells equal. `height_world` in (0, spacing.height_world].
std::vector<double> squeeze(const LayerSpacing& spacing, double height_world);

/// As many layers in another height, from another first cell: a geometric series, or equal cells
/// where N first cells do not fit.
std::vector<double> rescale(const LayerSpacing& spacing, double height_world,
                            double first_cell_world);

}  // namespace vdb_offset
