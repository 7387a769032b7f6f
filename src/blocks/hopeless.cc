#include <algorithm>
#include <cstddef>

#include "blocks/face_state.h"
#include "blocks/untangle.h"

namespace vdb_offset {

bool is_hopeless(const WindowShape& shape, int steps) {
  // Of the faces, after as many steps: inner corners that can be mended have left less by then.
  constexpr int kSoon = 5;
  constexpr double kMostSoon = 0.12;
  constexpr double kMost = 0.05;
  constexpr double kMostLater = 0.01;
  constexpr double kMostOfSmall = 0.25;
  constexpr std::ptrdiff_t kFew = 8;
  const std::vector<ColumnFace>& faces = shape.window.faces;
  const bool is_soon = steps == kSoon && faces.size() >= kSmallWindow;
  if (steps % 10 != 0 && !is_soon) return false;
  const auto point = [&](int slot, std::size_t level) {
    return shape.points_world.get(static_cast<std::size_t>(slot), level);
  };
  const auto inverted = std::ranges::count_if(faces, [&](const ColumnFace& face) {
    return !judge_face(face, shape.points_world.levels() - 1, point).positive;
  });
  const double part = static_cast<double>(inverted) / static_cast<double>(faces.size());
  if (is_soon) return inverted > kFew && part > kMostSoon;
  if (faces.size() < kSmallWindow && steps < 30) return inverted > kFew && part > kMostOfSmall;
  return inverted > kFew && part > (steps < 20 ? kMost : kMostLater);
}

}  // namespace vdb_offset
