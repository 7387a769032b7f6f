#include "vdb_offset/surface/turn_round.h"

#include <algorithm>
#include <utility>

namespace vdb_offset {

void turn_round(Patch& patch) {
  for (std::array<int, 4>& face : patch.faces) {
    // In a triangle the last corner stays there twice.
    std::swap(face[0], face[face[2] == face[3] ? 1 : 2]);
  }
  std::ranges::reverse(patch.rim.points);
  // Edge r is now the one before the last but r.
  if (!patch.rim.faces.empty()) {
    std::reverse(patch.rim.faces.begin(), patch.rim.faces.end() - 1);
  }
  if (!patch.is_grid()) return;
  for (auto row = patch.points_world.begin(); row != patch.points_world.end(); row += patch.ni) {
    std::reverse(row, row + patch.ni);
  }
}

}  // namespace vdb_offset
