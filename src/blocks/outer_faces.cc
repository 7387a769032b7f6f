#include "blocks/outer_faces.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <map>
#include <string>
#include <utility>

namespace vdb_offset {
namespace {

constexpr int kNone = -1;
constexpr int kTaken = -2;

/// What each face of cells on a block's outermost level lies on: an internal surface, or none.
class OuterMap {
 public:
  OuterMap(const MultiBlock& mesh, int block)
      : block_(mesh.blocks[static_cast<std::size_t>(block)]), index_(block) {
    for (int j = 0; j < block_.stacks_j(); ++j) {
      for (int i = 0; i < block_.stacks_i(); ++i) on_.push_back(under(mesh.layers, i, j));
    }
  }

  /// `visit(surface, range)` for rectangles that hold all faces, each once: as long as they can be
  /// along i, then as wide.
  template <typename Visit>
  void take_rectangles(const Visit& visit) {
    for (int j = 0; j < block_.stacks_j(); ++j) {
      for (int i = 0; i < block_.stacks_i(); ++i) {
        const int on = at(i, j);
        if (on != kTaken) visit(on, take_rectangle(i, j));
      }
    }
  }

 private:
  int under(const Layers& layers, int i, int j) const {
    const std::array<int, 4> columns = block_.stack(i, j);
    const int on = layers.ended_on(columns[0]);
    const bool is_whole =
        std::ranges::all_of(columns, [&](int column) { return layers.ended_on(column) == on; });
    return is_whole ? on : kNone;
  }

  int& at(int i, int j) {
    return on_[static_cast<std::size_t>(j) * static_cast<std::size_t>(block_.stacks_i()) +
               static_cast<std::size_t>(i)];
  }

  BlockRange take_rectangle(int i, int j) {
    const int on = at(i, j);
    int i_end = i;
    while (i_end < block_.stacks_i() && at(i_end, j) == on) ++i_end;
    const auto is_whole = [&](int row) {
      for (int n = i; n < i_end; ++n) {
        if (at(n, row) != on) return false;
      }
      return true;
    };
    int j_end = j;
    for (; j_end < block_.stacks_j() && is_whole(j_end); ++j_end) {
      for (int n = i; n < i_end; ++n) at(n, j_end) = kTaken;
    }
    const int k = block_.nk - 1;
    return {index_, BlockFace::KMax, {i, j, k}, {i_end, j_end, k}};
  }

  const Block& block_;
  int index_;
  std::vector<int> on_;
};

}  // namespace

std::vector<BoundaryFace> outer_faces(const Surface& surface, const MultiBlock& mesh, int block) {
  std::vector<BoundaryFace> faces;
  OuterMap(mesh, block).take_rectangles([&](int on, const BlockRange& range) {
    if (on == kNone) {
      faces.push_back({BoundaryKind::Outer, "outer", range});
      return;
    }
    const Boundary& internal = surface.boundaries->list()[static_cast<std::size_t>(on)];
    faces.push_back({BoundaryKind::Boundary, internal.name(), range});
  });
  return faces;
}

void part_outer_levels(const Surface& surface, MultiBlock& mesh) {
  std::map<std::string, Condition> conditions{{"outer", {ConditionKind::Farfield}}};
  for (const BoundaryFace& face : mesh.boundary_faces) {
    if (face.range.face == BlockFace::KMax) conditions[face.name] = face.condition;
  }
  std::vector<BoundaryFace> parted;
  int done = 0;  // blocks
  for (BoundaryFace& face : mesh.boundary_faces) {
    if (face.range.face != BlockFace::KMax) {
      parted.push_back(std::move(face));
    } else if (face.range.block == done) {
      for (BoundaryFace& part : outer_faces(surface, mesh, done++)) {
        part.condition = conditions[part.name];
        parted.push_back(std::move(part));
      }
    }
  }
  mesh.boundary_faces = std::move(parted);
}

}  // namespace vdb_offset
