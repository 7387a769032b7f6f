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
/// a point; cells and faces are made when they are asked for.
///
/// Points that a grid edge of no length joins are one: poles, first levels of fans. Points are in
/// the order of `Layers::points_world`, cells block by block, i fastest, then j, then k.
class CellMesh {
 public:
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
  std::int32_t cells() const { return first_cell_.back(); }
  const std::vector<CellPatch>& patches() const { return patches_; }

  /// `visit(point)` in their order.
  template <typename Visit>
  void for_points(const Visit& visit) const {
    std::int32_t next = 0;
    for (std::size_t p = 0; p < point_of_.size(); ++p) {
      if (point_of_[p] != next) continue;
      visit(mesh_.layers.points_world[p]);
      ++next;
    }
  }

  /// `visit(block, {i, j, k})` in their order.
  template <typename Visit>
  void for_cells(const Visit& visit) const {
    for (int b = 0; b < static_cast<int>(mesh_.blocks.size()); ++b) {
      const std::array<int, 3> n = cells_along(b);
      for (int k = 0; k < n[2]; ++k) {
        for (int j = 0; j < n[1]; ++j) {
          for (int i = 0; i < n[0]; ++i) visit(b, {i, j, k});
        }
      }
    }
  }

  /// `visit(block, {i, j, k})` for the cells behind each of a patch's faces, in order; those
  /// without area too.
  template <typename Visit>
  void for_cells_behind(const BlockRange& range, const Visit& visit) const {
    const std::array<int, 3> n = cells_along(range.block);
    std::array<int, 3> begin = range.begin;
    std::array<int, 3> end = range.end;
    const std::size_t axis = axis_of(range.face);
    begin[axis] = is_max(range.face) ? n[axis] - 1 : 0;
    end[axis] = begin[axis] + 1;
    for (int k = begin[2]; k < end[2]; ++k) {
      for (int j = begin[1]; j < end[1]; ++j) {
        for (int i = begin[0]; i < end[0]; ++i) visit(range.block, {i, j, k});
      }
    }
  }

  using Place = std::array<int, 3>;  ///< a cell of a block

  std::int32_t cell(int block, const Place& place) const;
  Corners corners(int block, const Place& place) const;
  /// The cell beyond a cell's face; -1: none.
  std::int32_t beyond(int block, const Place& place, BlockFace face) const;
  /// Of a flat mesh: the cell in its plane, counter-clockwise, and one side of it, which runs so
  /// that the cell is on its left.
  static Polygon plane_cell(const Corners& corners);
  static Polygon plane_side(const Corners& corners, BlockFace face);

 private:
  std::array<int, 3> cells_along(int block) const;
  std::int32_t& beyond_face(int block, const Place& place, BlockFace face);
  std::size_t face_index(int block, const Place& place, BlockFace face) const;
  void number_points(Extent extent);
  void number_cells();
  void connect(const Interface& interface);
  void collect_patches(Extent extent);
  void check_cells(Extent extent) const;

  const MultiBlock& mesh_;
  std::vector<std::int32_t> point_of_;  // of each place in points_world; -1: of no cell
  std::int32_t points_ = 0;
  std::vector<std::int32_t> first_cell_;                          // of each block, and the end
  std::vector<std::array<std::vector<std::int32_t>, 6>> beyond_;  // cells beyond blocks' faces
  std::vector<CellPatch> patches_;
};

}  // namespace vdb_offset
