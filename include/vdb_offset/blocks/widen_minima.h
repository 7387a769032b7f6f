#pragma once

#include <algorithm>

#include "vdb_offset/blocks/quality.h"

namespace vdb_offset {

/// What holds for both together.
inline void widen(const QualityMinima& other, QualityMinima& all) {
  if (other.cells == 0) return;
  if (all.cells == 0) {
    all = other;
    return;
  }
  all.cells += other.cells;
  all.nonpositive_cells += other.nonpositive_cells;
  all.min_scaled_jacobian = std::min(all.min_scaled_jacobian, other.min_scaled_jacobian);
  all.min_jacobian = std::min(all.min_jacobian, other.min_jacobian);
  all.min_volume = std::min(all.min_volume, other.min_volume);
  all.max_skewness = std::max(all.max_skewness, other.max_skewness);
  all.max_aspect_ratio = std::max(all.max_aspect_ratio, other.max_aspect_ratio);
  all.min_orthogonality = std::min(all.min_orthogonality, other.min_orthogonality);
  all.growth_max = std::max(all.growth_max, other.growth_max);
  all.side_growth_max = std::max(all.side_growth_max, other.side_growth_max);
}

}  // namespace vdb_offset
