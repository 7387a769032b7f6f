#pragma once

#include "surface/quad_edges.h"

namespace vdb_offset {

/// Edges of the mesh, by what they are to the layout.
struct FeatureCount {
  int kept = 0;
  int loose = 0;
};

/// Keeps the sharp edges (see QuadLayoutOptions::feature_turn) that run along grid lines from one
/// border, corner or irregular point to another, or round.
FeatureCount keep_features(const QuadEdges& edges, double feature_turn, QuadCuts& cuts);

}  // namespace vdb_offset
