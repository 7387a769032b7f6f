#pragma once

#include <string>
#include <vector>

#include "vdb_offset/surface/patch.h"

namespace vdb_offset {

/// Patches with the node of each of their points: what orientation and topology work on.
struct NodeGrids {
  Patches& patches;
  std::vector<std::vector<int>>& nodes;
  bool is_flat = false;  ///< curves, as strips along z
};

/// Reverse i of one patch and of its node grid, which turns its normal round.
void flip(NodeGrids grids, std::size_t patch);

struct Orientation {
  std::vector<int> component;  ///< of each patch
  int components = 0;
  std::vector<int> flipped;  ///< patches turned round to agree with their component's first patch
};

/// Check that the surface is a manifold and turn patches so that neighbours agree.
/// Throws InputError naming patch and place: three cells on one edge, a node whose cells are not
/// one fan, an edge whose cells cannot agree.
Orientation orient(NodeGrids grids);

/// "patch 2 'tip' of wing.xyz", without the file if it came from none.
std::string name_of(const Patch& patch, int number);

/// "patch 2 'tip' of wing.obj, point 5 at (0.1, 2)": of a curve.
std::string curve_place(const Patch& patch, int number, int i);

/// "patch 2 'tip' of wing.xyz, point (5, 1) at (0.1, 2, 3)": i and j counted from 1, as users do.
std::string place(const Patch& patch, int number, int i, int j);

}  // namespace vdb_offset
