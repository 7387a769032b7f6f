#pragma once

#include <array>
#include <cstddef>
#include <string>
#include <vector>

#include "vdb_offset/blocks/connectivity.h"
#include "vdb_offset/core/progress.h"
#include "vdb_offset/march/march.h"
#include "vdb_offset/surface/surface.h"

namespace vdb_offset {

/// What stands on one patch: a structured block, or with `faces` the columns of cells over its
/// polygons, prisms and hexahedra. Such a block counts its cells by i alone, as if there were one
/// row of them; its sides are ranges of points of its rim, along i of jmin.
struct Block {
  std::string name;
  std::string family;
  int patch = -1;
  int ni = 0;                ///< points along i; of polygons: columns
  int nj = 0;                ///< points along j; of polygons: 0
  int nk = 0;                ///< levels: layers + 1
  std::vector<int> columns;  ///< `ni x nj` column (node) indices, i fastest; of polygons: each once
  std::vector<std::array<int, 4>> faces = {};  ///< of polygons: the columns around each, the last
                                               ///< one twice where there are three
  Rim rim = {};                                ///< of polygons: columns and faces

  bool is_grid() const { return faces.empty(); }
  /// Stacks of cells along i and j.
  int stacks_i() const { return is_grid() ? ni - 1 : static_cast<int>(faces.size()); }
  int stacks_j() const { return is_grid() ? nj - 1 : 1; }
  /// The columns around a stack of cells, from (i, j) towards (i + 1, j).
  std::array<int, 4> stack(int i, int j) const {
    if (!is_grid()) return faces[static_cast<std::size_t>(i)];
    return {column(i, j), column(i + 1, j), column(i + 1, j + 1), column(i, j + 1)};
  }
  std::size_t point_count() const { return columns.size() * static_cast<std::size_t>(nk); }
  std::size_t cell_count() const {
    return static_cast<std::size_t>(stacks_i()) * static_cast<std::size_t>(stacks_j()) *
           static_cast<std::size_t>(nk - 1);
  }
  int column(int i, int j) const {
    return columns[static_cast<std::size_t>(j) * static_cast<std::size_t>(ni) +
                   static_cast<std::size_t>(i)];
  }
};

/// Face-matching hexahedral blocks. Points live once, in `layers`: interfaces are single by
/// construction. Every place on a block's surface is in exactly one interface or boundary face.
struct MultiBlock {
  Layers layers;
  std::vector<Block> blocks;
  std::vector<Interface> interfaces;
  std::vector<BoundaryFace> boundary_faces;
  /// Whether all blocks are structured.
  bool is_structured() const;
  bool flat = false;  ///< of a flat surface: one cell thick along j, the mesh itself is j = 0

  const Vec3& point(const Block& block, int i, int j, int k) const {
    return layers.at(block.column(i, j), k);
  }
  /// Reached height / requested height of a column, in [0, 1].
  double coverage(int node) const {
    const double height = layers.height_world[static_cast<std::size_t>(node)];
    const double asked = layers.asked_world[static_cast<std::size_t>(node)];
    return height < asked ? height / asked : 1.0;
  }
  std::size_t cells() const;
  int nodes() const { return static_cast<int>(layers.stop.size()); }
};

/// Each patch swept along its columns becomes a block `ni x nj x (N + 1)`, connected as the
/// topology says.
///
/// A patch of polygons becomes a block of its columns; its levels are ranges of its faces along i,
/// and its rim has no interfaces but is where columns and faces say.
///
/// Boundary faces: of each block in turn its first level, then its outermost, which falls into
/// rectangles where all columns of cells end on one internal surface, which have its name, and
/// those of the rest, "outer"; then sides.
///
/// In      layers: of this surface; moved, not copied.
/// Out     block p is patch p; right-handed, as patches' normals are the marching direction;
///         conditions as `set_conditions` gives them without options.
/// Throws  InputError when the layers are not of this surface; Cancelled.
MultiBlock build_blocks(const Surface& surface, Layers layers, const Progress& progress = {});

}  // namespace vdb_offset
