#pragma once

#include <array>
#include <cstddef>

namespace vdb_offset {

/// A set of octants, one bit each: octant o travels towards -a along every axis a whose bit is set
/// in o (x is bit 0), towards +a along the others.
using OctantSet = unsigned;

/// The order of a round: from one octant to the next a single axis turns.
inline constexpr std::array<unsigned, 8> kRound{0, 1, 3, 2, 6, 4, 5, 7};

/// Step of octant `o` along an axis: +1 or -1.
constexpr int octant_step(unsigned o, unsigned axis) { return (o >> axis & 1U) != 0 ? -1 : 1; }

/// Faces of a tile: -x, +x, -y, +y, -z, +z.
inline constexpr std::size_t kFaces = 6;

/// The set of all o ^ flips for o in `set`: octants relative to `flips` made absolute, and back.
constexpr OctantSet turned(OctantSet set, unsigned flips) {
  if ((flips & 1U) != 0) set = (set & 0xaaU) >> 1U | (set & 0x55U) << 1U;
  if ((flips & 2U) != 0) set = (set & 0xccU) >> 2U | (set & 0x33U) << 2U;
  if ((flips & 4U) != 0) set = (set & 0xf0U) >> 4U | (set & 0x0fU) << 4U;
  return set;
}

}  // namespace vdb_offset
