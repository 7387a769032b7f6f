#pragma once

#include <array>
#include <optional>
#include <string>
#include <string_view>

#include "vdb_offset/blocks/connectivity.h"

namespace vdb_offset {

/// A part of a face as a neutral map has it: the face by number, and 1-based indices along its
/// first and second direction.
struct NeutralRange {
  int block = 0;  ///< from 1
  int face = 0;   ///< 1 k min, 2 k max, 3 i min, 4 i max, 5 j min, 6 j max
  std::array<int, 2> begin{0, 0};
  std::array<int, 2> end{0, 0};
};

/// The first and second direction of a face: k faces (i, j), i faces (j, k), j faces (k, i).
std::array<std::size_t, 2> neutral_axes(BlockFace face);
/// The face of a number in [1, 6].
BlockFace neutral_face(int number);

NeutralRange neutral_range(const BlockRange& range);
/// `sizes`: of its block.
BlockRange block_range(const NeutralRange& range, const std::array<int, 3>& sizes);

/// Whether the first direction of the first side runs along the second of the other.
bool is_swapped(const Interface& interface);
Interface neutral_interface(const BlockRange& first, const BlockRange& second, bool swapped);

/// A type in capitals, '-' as '_': two spellings of one type give the same.
std::string neutral_key(std::string_view type);
/// What a type says; nothing for ONE_TO_ONE.
BoundaryFace neutral_boundary(const std::string& type, const BlockRange& range);

}  // namespace vdb_offset
