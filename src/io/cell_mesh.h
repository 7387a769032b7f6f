#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "vdb_offset/blocks/connectivity.h"
#include "vdb_offset/blocks/multi_block.h"

namespace vdb_offset {

/// Corners in order around, each once; fewer than three enclose no area.
struct Polygon {
  std::array<std::int32_t, 4> points{};
  int count = 0;

  void add(std::int32_t point);  ///< unless it is the last one
  void close();                  ///< drops a last corner that is the first
  bool has_area() const { return count >= 3; }
};

/// The eight corners of a block's cell: those at level k around, then those at k + 1, as VTK's
/// hexahedron has them. Where edges are collapsed points repeat.
using Corners = std::array<std::int32_t, 8>;

/// The six faces, by BlockFace, counter-clockwise seen from outside.
std::array<Polygon, 6> polygons(const Corners& corners);

/// The face that each side of a stack of cells is, from its first column to the next.
inline constexpr std::array<BlockFace, 4> kSideFaces{BlockFace::JMin, BlockFace::IMax,
                                                     BlockFace::JMax, BlockFace::IMin};

/// Boundary faces of one name and condition.
struct CellPatch {
  std::string name;  ///< unique, of letters, digits, '_', '-' and '.', beginning with none of the
                     ///< last three or a digit
  Condition condition;
  bool is_flat_side = false;            ///< a plane that a flat mesh lies between
  std::vector<BlockRange> ranges = {};  ///< ascending
  std::int64_t faces = 0;               ///< with area
};

/// What a MultiBlock is to formats without blocks: points once, cells by their corners, boundary
/// faces by name. Only the numbers of points and what lies beyond blocks' faces are stored: 4 bytes
/// a point; cells and faces are made when they are asked for. Of blocks of polygons what lies
/// beyond each stack is stored too, 48 bytes.
///
/// Points that a grid edge of no length joins are one: poles, first levels of fans. Points are in
/// the order of `Layers::points_world`, cells block by block, i fastest, then j, then k. Stacks
/// without any height (bare_stacks.h) are left out.
class CellMesh {
 public:
  using Place = std::array<int, 3>;  ///< a cell of a block

  enum class Extent {
    Full,
    Plane  ///< of a flat mesh: points of j = 0 alone, cells are quads, patches of lines
  };

  /// In      mesh: must outlive this.
  /// Throws  LimitError for more than 2^31 - 1 points or cells; InputError naming a cell that has
  ///         no volume, for it is a cell to none of these formats, or one that is its own
  ///         neighbour.
  explicit CellMesh(const MultiBlock& mesh, Extent extent = Extent::Full);

  std::int32_t points() const { return points_; }
  std::int32_t cells() const { return cells_; }
  const std::vector<CellPatch>& patches() const { return patches_; }

  /// `visit(place)`, their indices in `Layers::points_world`, in their order.
  template <typename Visit>
  void for_places(const Visit& visit) const {
    std::int32_t next = 0;
    for (std::size_t p = 0; p < point_of_.size(); ++p) {
      if (point_of_[p] != next) continue;
      visit(p);
      ++next;
    }
  }
  /// `visit(point)` in their order.
  template <typename Visit>
  void for_points(const Visit& visit) const {
    for_places([&](std::size_t p) { visit(mesh_.layers.points_world[p]); });
  }

  /// `visit(block, {i, j, k})` in their order.
  template <typename Visit>
  void for_cells(const Visit& visit) const {
    for (int b = 0; b < static_cast<int>(mesh_.blocks.size()); ++b) {
      for_cells_of(b, [&](const Place& place) { visit(b, place); });
    }
  }
  /// `visit({i, j, k})` for those of one block that are not left out.
  template <typename Visit>
  void for_cells_of(int block, const Visit& visit) const {
    const std::array<int, 3> n = cells_along(block);
    for (int k = 0; k < n[2]; ++k) {
      for (int j = 0; j < n[1]; ++j) {
        for (int i = 0; i < n[0]; ++i) {
          if (!is_left_out(block, {i, j, k})) visit(Place{i, j, k});
        }
      }
    }
  }

  /// `visit(block, {i, j, k}, face)` for the cells behind each of a patch's faces, in order, and
  /// which of their own faces that is; those without area too.
  template <typename Visit>
  void for_cells_behind(const BlockRange& range, const Visit& visit) const {
    if (is_rim(range)) return for_cells_at_rim(range, visit);
    const std::array<int, 3> n = cells_along(range.block);
    std::array<int, 3> begin = range.begin;
    std::array<int, 3> end = range.end;
    const std::size_t axis = axis_of(range.face);
    begin[axis] = is_max(range.face) ? n[axis] - 1 : 0;
    end[axis] = begin[axis] + 1;
    for (int k = begin[2]; k < end[2]; ++k) {
      for (int j = begin[1]; j < end[1]; ++j) {
        for (int i = begin[0]; i < end[0]; ++i) {
          if (!is_left_out(range.block, {i, j, k})) visit(range.block, Place{i, j, k}, range.face);
        }
      }
    }
  }

  /// -1 for one that is left out.
  std::int32_t cell(int block, const Place& place) const;
  Corners corners(int block, const Place& place) const;
  /// The cell beyond a cell's face; -1: none.
  std::int32_t beyond(int block, const Place& place, BlockFace face) const;
  /// Of a flat mesh: the cell in its plane, counter-clockwise, and one side of it, which runs so
  /// that the cell is on its left.
  static Polygon plane_cell(const Corners& corners);
  static Polygon plane_side(const Corners& corners, BlockFace face);

 private:
  /// A stack of cells, and one of its four sides, by the column that the side begins with.
  struct StackSide {
    int block;
    int stack;
    std::size_t side;
  };

  bool is_left_out(int block, const Place& place) const {
    const std::vector<char>& bare = bare_[static_cast<std::size_t>(block)];
    const int stack = place[1] * cells_along(block)[0] + place[0];
    return !bare.empty() && bare[static_cast<std::size_t>(stack)] != 0;
  }
  bool is_rim(const BlockRange& range) const {
    return axis_of(range.face) != 2 &&
           !mesh_.blocks[static_cast<std::size_t>(range.block)].is_grid();
  }
  StackSide at_rim(int block, int point) const;
  template <typename Visit>
  void for_cells_at_rim(const BlockRange& range, const Visit& visit) const {
    for (int k = range.begin[2]; k < range.end[2]; ++k) {
      for (int s = range.begin[0]; s < range.end[0]; ++s) {
        const StackSide at = at_rim(range.block, s);
        const Place place{at.stack, 0, k};
        if (!is_left_out(range.block, place)) visit(range.block, place, kSideFaces[at.side]);
      }
    }
  }
  template <typename Visit>
  void for_open_sides(int block, const Visit& visit) const;
  void connect_polygons();
  void set_beyond(const StackSide& from, const StackSide& to);
  std::array<int, 3> cells_along(int block) const;
  std::int32_t& beyond_face(int block, const Place& place, BlockFace face);
  std::size_t face_index(int block, const Place& place, BlockFace face) const;
  void find_bare_stacks();
  void number_points(Extent extent);
  void number_cells();
  void connect(const Interface& interface);
  void collect_patches(Extent extent);
  void check_cells(Extent extent) const;

  const MultiBlock& mesh_;
  std::vector<std::int32_t> point_of_;  // of each place in points_world; -1: of no cell
  std::int32_t points_ = 0;
  std::vector<std::vector<char>> bare_;  // stacks of each block; empty: none of them
  bool any_bare_ = false;
  std::vector<std::int32_t> number_;  // of all cells; empty: as they come
  std::int32_t cells_ = 0;
  std::vector<std::int32_t> first_cell_;                          // of each block, and the end
  std::vector<std::array<std::vector<std::int32_t>, 6>> beyond_;  // cells beyond blocks' faces
  std::vector<std::vector<std::array<StackSide, 4>>> sides_;  // of polygons, what is beyond stacks
  std::vector<CellPatch> patches_;
};

}  // namespace vdb_offset
