#pragma once

#include "blocks/window_shape.h"
#include "vdb_offset/core/progress.h"
#include "vdb_offset/surface/surface.h"

namespace vdb_offset {

/// How far to go.
enum class Until {
  Settled,  ///< all that moves has moved most of its way, once; few steps
  Valid,    ///< no corner is inverted, and the worst no longer gets better
  Better    ///< the same, but a few steps alone: to look, and go on
};

/// Moves the free points of a window until its corners are as near to the ideal, and its levels to
/// their heights, as they can be.
///
/// Minimises sum f(corners) + sum weight ((phi - height) / layer)^2 by Newton steps, each solved by
/// conjugate gradients preconditioned with the columns alone. Points on boundaries stay on them.
/// Out       how many Newton steps it took; `shape.work` grows by 1 for each step of the linear
///           solver, 2 for each value of the sum, 8 for each Newton step.
/// Accuracy  until a step lowers the sum by less than 1e-3 of it.
/// Cost      about 5 microseconds a point and step; 0.8 kilobytes a point.
/// Threads   side by side, bitwise the same result for any count.
int untangle(const Surface& surface, Until until, WindowShape& shape, const Progress& progress);

/// Faces of a window below which it costs little, and is given longer before it is given up.
inline constexpr std::size_t kSmallWindow = 4000;

/// Whether so much is inverted after `steps` steps that untangling is not going to mend it.
bool is_hopeless(const WindowShape& shape, int steps);

}  // namespace vdb_offset
