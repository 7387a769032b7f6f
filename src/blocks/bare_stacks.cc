#include "vdb_offset/blocks/bare_stacks.h"

#include <algorithm>

namespace vdb_offset {

bool has_no_height(const MultiBlock& mesh, const Block& block, int i, int j) {
  return std::ranges::all_of(block.stack(i, j), [&](int column) {
    for (int k = 1; k < block.nk; ++k) {
      if (mesh.layers.at(column, k) != mesh.layers.at(column, 0)) return false;
    }
    return true;
  });
}

bool is_bare(const MultiBlock& mesh, const Block& block, int i, int j) {
  return !block.is_grid() && has_no_height(mesh, block, i, j);
}

std::size_t bare_stacks(const MultiBlock& mesh, const Block& block) {
  std::size_t count = 0;
  if (block.is_grid()) return count;
  for (int i = 0; i < block.stacks_i(); ++i) count += is_bare(mesh, block, i, 0) ? 1U : 0U;
  return count;
}

}  // namespace vdb_offset
