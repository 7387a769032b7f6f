#pragma once

#include <array>
#include <cstddef>
#include <string>

namespace vdb_offset {

/// The six faces of a block; k runs from the wall outward.
enum class BlockFace { IMin = 0, IMax = 1, JMin = 2, JMax = 3, KMin = 4, KMax = 5 };

/// A rectangle of points on a block: 0-based node indices, inclusive, constant in one direction.
struct BlockRange {
  int block = -1;
  BlockFace face = BlockFace::KMin;
  std::array<int, 3> begin{0, 0, 0};
  std::array<int, 3> end{0, 0, 0};  ///< may be smaller than begin: the direction is reversed

  bool operator==(const BlockRange&) const = default;
};

/// What a part of a block's surface is, when it is not an interface.
enum class BoundaryKind { Wall, Outer, Boundary, Free, Degenerate };

/// What a solver is to do there. `Other`: what its CGNS type says; `Degenerate`: nothing.
enum class ConditionKind {
  Unspecified,
  Wall,  ///< viscous
  InviscidWall,
  Symmetry,
  Inflow,
  Outflow,
  Farfield,
  Overset,
  Degenerate,
  Other
};

struct Condition {
  ConditionKind kind = ConditionKind::Unspecified;
  /// BCType of CGNS where it says more than the kind: "BCWallViscousIsothermal"; else empty.
  std::string cgns_type = {};

  bool operator==(const Condition&) const = default;
};

struct BoundaryFace {
  BoundaryKind kind = BoundaryKind::Wall;
  std::string name;  ///< family for walls (a patch that has a condition of its own: its name),
                     ///< "outer", the name of the boundary or the internal surface, "free"; "pole",
                     ///< and for first levels of fans "edge", "corner" (see Fans)
  BlockRange range;
  Condition condition = {};

  bool operator==(const BoundaryFace&) const = default;
};

/// Two parts of block faces that hold the same points, begin to begin, end to end.
struct Interface {
  BlockRange first;
  BlockRange second;
  /// CGNS transform: the signed direction (1 = i, 2 = j, 3 = k) of `second` that +i, +j, +k of
  /// `first` map to.
  std::array<int, 3> transform{1, 2, 3};
  std::string name = {};  ///< of the internal surface that it lies on; empty: none

  bool operator==(const Interface&) const = default;
};

/// The axis that a face is constant along (0 = i, 1 = j, 2 = k), and whether it is its last level.
inline std::size_t axis_of(BlockFace face) { return static_cast<std::size_t>(face) / 2; }
inline bool is_max(BlockFace face) { return static_cast<int>(face) % 2 != 0; }

/// The same range with no direction reversed.
BlockRange ascending(BlockRange range);

/// The same interface, seen from the second block.
Interface reversed(const Interface& interface);

/// The same interface with no direction of `first` reversed.
Interface ascending(Interface interface);

}  // namespace vdb_offset
