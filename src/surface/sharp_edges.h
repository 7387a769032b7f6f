#pragma once

#include <vector>

#include "vdb_offset/surface/surface.h"

namespace vdb_offset {

/// Whether an edge of this turn (see `turn_across`) can be opened.
bool is_sharp(double turn);

/// Angle by which the normal turns over a run's grid edge `s`, in (-pi, pi]: positive where convex.
double turn_across(const Patches& patches, const Edge& edge, int s);

/// Whether the surface runs counter-clockwise about `range`'s patch from its begin to its end.
bool runs_along(const SideRange& range);

/// Splits patches along the grid lines that sharp convex edges run along, two cells or more or from
/// side to side. `component`: of each patch, kept in step.
void split_at_sharp_edges(Surface& surface, std::vector<int>& component);

/// Marks the nodes at which the surface turns by more than kSharpTurn the concave way.
std::vector<char> concave_nodes(const Surface& surface, const Topology& topology);

}  // namespace vdb_offset
