#pragma once

#include <vector>

#include "vdb_offset/surface/surface.h"

namespace vdb_offset {

/// By how much a quantity may differ between neighbouring nodes of the wall.
struct Grading {
  double ratio = 1.2;  ///< of the larger to the smaller, above 1
  double slope = 0;    ///< of the difference to the length of the edge between them; 0: any
};

/// Lowers values until no two neighbours differ by more: the largest such values.
/// In  `values`: one for each node, >= 0; zeros stay, and their neighbours obey the slope alone.
/// Cost  n log n in the nodes.
void grade(const Surface& surface, const Grading& grading, std::vector<double>& values);

}  // namespace vdb_offset
