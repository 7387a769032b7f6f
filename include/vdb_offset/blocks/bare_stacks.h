#pragma once

#include "vdb_offset/blocks/multi_block.h"

namespace vdb_offset {

/// Whether no column of a stack of cells has a height.
bool has_no_height(const MultiBlock& mesh, const Block& block, int i, int j);

/// Whether a stack of cells over a polygon has no height at any of its columns: the wall lies bare
/// there, and these are no cells. Of structured blocks false: their cells are there whatever they
/// are.
bool is_bare(const MultiBlock& mesh, const Block& block, int i, int j);

/// Stacks of a block that are bare.
std::size_t bare_stacks(const MultiBlock& mesh, const Block& block);

}  // namespace vdb_offset
