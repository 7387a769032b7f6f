#pragma once

#include <cstddef>
#include <vector>

#include "blocks/face_state.h"
#include "blocks/window_shape.h"
#include "vdb_offset/core/progress.h"
#include "vdb_offset/surface/surface.h"

namespace vdb_offset {

/// Of all faces of a window.
std::vector<FaceState> judge_all(const WindowShape& shape);
std::ptrdiff_t count_inverted(const WindowShape& shape);

/// What a face has of the quality that it is wanted to have: from 1 on it is as good as that.
double merit(const FaceState& state, const FaceGoal& goal);

/// Untangles what is valid already, faces that fall short counting more from one try to the next,
/// and keeps the best that comes by; whether that is any better. Adds to `steps`.
bool improve(const Surface& surface, WindowShape& shape, int& steps, const Progress& progress);

}  // namespace vdb_offset
