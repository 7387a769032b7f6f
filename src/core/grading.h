#pragma once

#include <cstddef>
#include <vector>

namespace vdb_offset {

/// By how much a quantity may differ between neighbouring nodes: by the ratio or by the gentle
/// slope, whichever allows more, and never by more than the steepest slope.
struct Grading {
  double ratio = 1.2;   ///< of the larger to the smaller, above 1
  double gentle = 0;    ///< of the difference to the edge between them: near zero a ratio alone
                        ///< hardly climbs
  double steepest = 0;  ///< of the same; 0: any

  /// What a node allows its neighbour across an edge; where nodes stand at one place, as those of a
  /// fan, the ratio alone decides. Beside a zero a ratio without a gentle slope says nothing.
  double most(double value, double length_world) const;
};
/// Of heights of layers over a wall.
inline constexpr Grading kOfHeights{.ratio = 1.2, .gentle = 0.25, .steepest = 1};

/// Neighbours of each node.
struct Links {
  std::vector<std::size_t> first;  ///< of each node, and the end
  std::vector<int> to;
  std::vector<double> length_world;  ///< of the edge
};

/// Lowers values until no two neighbours differ by more: the largest such values.
/// In  `values`: one for each node, >= 0; zeros stay.
/// Cost  n log n in the nodes.
void grade(const Links& links, const Grading& grading, std::vector<double>& values);

}  // namespace vdb_offset
