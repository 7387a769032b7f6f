#include "io/cell_mesh.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>
#include <limits>
#include <set>
#include <tuple>

#include "core/parallel.h"
#include "vdb_offset/blocks/bare_stacks.h"
#include "vdb_offset/core/error.h"

namespace vdb_offset {
namespace {

constexpr std::size_t kMost = std::numeric_limits<std::int32_t>::max();

/// The two axes within a face, ascending.
std::array<std::size_t, 2> running_axes(BlockFace face) {
  const std::size_t normal = axis_of(face);
  return {normal == 0 ? std::size_t{1} : 0, normal == 2 ? std::size_t{1} : 2};
}

/// Sets of joined points: each point's parent has a smaller index, or is itself the first.
class Joined {
 public:
  explicit Joined(std::vector<std::int32_t>& parents) : parents_(parents) {
    for (std::size_t p = 0; p < parents.size(); ++p) parents[p] = static_cast<std::int32_t>(p);
  }

  void join(std::size_t a, std::size_t b) {
    const std::int32_t first = find(static_cast<std::int32_t>(a));
    const std::int32_t second = find(static_cast<std::int32_t>(b));
    parent(std::max(first, second)) = std::min(first, second);
  }

 private:
  std::int32_t& parent(std::int32_t p) { return parents_[static_cast<std::size_t>(p)]; }

  std::int32_t find(std::int32_t p) {
    while (parent(p) != p) p = parent(p) = parent(parent(p));
    return p;
  }

  std::vector<std::int32_t>& parents_;
};

void join_edges_without_length(const MultiBlock& mesh, const Block& block, Joined& joined) {
  const Vec3List& points = mesh.layers.points_world;
  const auto levels = static_cast<std::size_t>(mesh.layers.levels());
  const auto join = [&](std::size_t a, std::size_t b) {
    if (a != b && points[a] == points[b]) joined.join(a, b);
  };
  if (!block.is_grid()) {
    for (const int column : block.columns) {
      const std::size_t here = static_cast<std::size_t>(column) * levels;
      for (std::size_t k = 0; k + 1 < levels; ++k) join(here + k, here + k + 1);
    }
  }
  for (int j = 0; j < block.nj; ++j) {
    for (int i = 0; i < block.ni; ++i) {
      const auto column = [&](int at_i, int at_j) {
        return static_cast<std::size_t>(block.column(at_i, at_j)) * levels;
      };
      const std::size_t here = column(i, j);
      for (std::size_t k = 0; k < static_cast<std::size_t>(block.nk); ++k) {
        if (i + 1 < block.ni) join(here + k, column(i + 1, j) + k);
        if (j + 1 < block.nj) join(here + k, column(i, j + 1) + k);
        if (k + 1 < static_cast<std::size_t>(block.nk)) join(here + k, here + k + 1);
      }
    }
  }
}

/// A name that every format takes as one word; two are never equal.
std::string word_of(const std::string& name, std::set<std::string>& taken) {
  std::string word;
  for (const char c : name) {
    const bool is_plain = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') ||
                          (c >= '0' && c <= '9') || c == '_' || c == '-' || c == '.';
    word.push_back(is_plain ? c : '_');
  }
  const char first = word.empty() ? '.' : word.front();
  const bool is_letter = (first >= 'a' && first <= 'z') || (first >= 'A' && first <= 'Z');
  if (!is_letter) word.insert(0, "patch_");
  const std::string stem = word;
  for (int n = 2; !taken.insert(word).second; ++n) word = fmt::format("{}_{}", stem, n);
  return word;
}

/// A side of a strip that a flat mesh lies along.
bool is_across(const MultiBlock& mesh, const BlockRange& range) {
  return mesh.flat && axis_of(range.face) == 1;
}

}  // namespace

CellMesh::CellMesh(const MultiBlock& mesh, Extent extent) : mesh_(mesh) {
  const std::size_t most = std::max(mesh.layers.points_world.size(), mesh.cells());
  if (most > kMost) {
    throw LimitError(
        fmt::format("{} points or cells are more than unstructured files can number "
                    "(2^31 - 1); write CGNS",
                    most));
  }
  find_bare_stacks();
  number_points(extent);
  number_cells();
  check_cells(extent);
  for (const Interface& interface : mesh.interfaces) connect(interface);
  if (!mesh.is_structured()) connect_polygons();
  collect_patches(extent);
}

void CellMesh::number_points(Extent extent) {
  point_of_.resize(mesh_.layers.points_world.size());
  const auto levels = static_cast<std::size_t>(mesh_.layers.levels());
  std::vector<char> used(point_of_.size() / levels, 0);
  Joined joined(point_of_);
  for (const Block& block : mesh_.blocks) {
    join_edges_without_length(mesh_, block, joined);
    if (extent == Extent::Full) continue;
    for (std::size_t c = 0; c < static_cast<std::size_t>(block.ni); ++c) {
      used[static_cast<std::size_t>(block.columns[c])] = 1;
    }
  }
  if (extent == Extent::Full) {
    for_cells([&](int block, const Place& place) {
      if (place[2] > 0) return;
      const Block& b = mesh_.blocks[static_cast<std::size_t>(block)];
      for (const int column : b.stack(place[0], place[1])) {
        used[static_cast<std::size_t>(column)] = 1;
      }
    });
  }
  for (std::size_t p = 0; p < point_of_.size(); ++p) {  // every parent is the first of its set
    point_of_[p] = point_of_[static_cast<std::size_t>(point_of_[p])];
  }
  for (std::size_t p = 0; p < point_of_.size(); ++p) {
    const auto first = static_cast<std::size_t>(point_of_[p]);
    if (first != p) {
      point_of_[p] = point_of_[first];  // numbered before
    } else {
      point_of_[p] = used[p / levels] != 0 ? points_++ : -1;
    }
  }
}

void CellMesh::find_bare_stacks() {
  for (const Block& block : mesh_.blocks) {
    std::vector<char>& bare = bare_.emplace_back();
    for (int j = 0; j < block.stacks_j(); ++j) {
      for (int i = 0; i < block.stacks_i(); ++i) {
        bare.push_back(has_no_height(mesh_, block, i, j) ? 1 : 0);
      }
    }
    if (std::ranges::count(bare, 1) == 0) bare.clear();
    any_bare_ = any_bare_ || !bare.empty();
  }
}

void CellMesh::number_cells() {
  first_cell_.push_back(0);
  for (int b = 0; b < static_cast<int>(mesh_.blocks.size()); ++b) {
    const auto cells = mesh_.blocks[static_cast<std::size_t>(b)].cell_count();
    first_cell_.push_back(first_cell_.back() + static_cast<std::int32_t>(cells));
    const std::array<int, 3> n = cells_along(b);
    beyond_.emplace_back();
    for (std::size_t f = 0; f < 6; ++f) {
      const auto [u, v] = running_axes(static_cast<BlockFace>(f));
      const auto faces = static_cast<std::size_t>(n[u]) * static_cast<std::size_t>(n[v]);
      beyond_.back()[f].assign(faces, -1);
    }
    const Block& block = mesh_.blocks[static_cast<std::size_t>(b)];
    sides_.emplace_back(block.faces.size());
    for (auto& sides : sides_.back()) sides.fill({-1, -1, 0});
  }
  cells_ = first_cell_.back();
  if (!any_bare_) return;
  std::vector<std::int32_t> number(static_cast<std::size_t>(cells_), -1);
  cells_ = 0;
  for_cells([&](int block, const Place& place) {
    number[static_cast<std::size_t>(cell(block, place))] = cells_++;
  });
  number_ = std::move(number);
  if (cells_ == 0)
    throw InputError("no cell has a volume: layers have no height anywhere on this surface");
}

std::array<int, 3> CellMesh::cells_along(int block) const {
  const Block& b = mesh_.blocks[static_cast<std::size_t>(block)];
  return {b.stacks_i(), b.stacks_j(), b.nk - 1};
}

std::int32_t CellMesh::cell(int block, const Place& place) const {
  const std::array<int, 3> n = cells_along(block);
  const std::int32_t whole =
      first_cell_[static_cast<std::size_t>(block)] + (place[2] * n[1] + place[1]) * n[0] + place[0];
  return number_.empty() ? whole : number_[static_cast<std::size_t>(whole)];
}

Corners CellMesh::corners(int block, const Place& place) const {
  const Block& b = mesh_.blocks[static_cast<std::size_t>(block)];
  const auto levels = static_cast<std::size_t>(mesh_.layers.levels());
  Corners out{};
  const std::array<int, 4> ring = b.stack(place[0], place[1]);
  for (std::size_t c = 0; c < 4; ++c) {
    const std::size_t p =
        static_cast<std::size_t>(ring[c]) * levels + static_cast<std::size_t>(place[2]);
    out[c] = point_of_[p];
    out[c + 4] = point_of_[p + 1];
  }
  return out;
}

std::size_t CellMesh::face_index(int block, const Place& place, BlockFace face) const {
  const auto [u, v] = running_axes(face);
  return static_cast<std::size_t>(place[v]) * static_cast<std::size_t>(cells_along(block)[u]) +
         static_cast<std::size_t>(place[u]);
}

std::int32_t& CellMesh::beyond_face(int block, const Place& place, BlockFace face) {
  return beyond_[static_cast<std::size_t>(block)][static_cast<std::size_t>(face)]
                [face_index(block, place, face)];
}

std::int32_t CellMesh::beyond(int block, const Place& place, BlockFace face) const {
  const std::size_t axis = axis_of(face);
  if (axis != 2 && !mesh_.blocks[static_cast<std::size_t>(block)].is_grid()) {
    const auto side =
        static_cast<std::size_t>(std::ranges::find(kSideFaces, face) - kSideFaces.begin());
    const StackSide& to =
        sides_[static_cast<std::size_t>(block)][static_cast<std::size_t>(place[0])][side];
    if (to.block < 0) return -1;
    const int cells_i = cells_along(to.block)[0];
    return cell(to.block, {to.stack % cells_i, to.stack / cells_i, place[2]});
  }
  const int last = is_max(face) ? cells_along(block)[axis] - 1 : 0;
  if (place[axis] == last) {
    return beyond_[static_cast<std::size_t>(block)][static_cast<std::size_t>(face)]
                  [face_index(block, place, face)];
  }
  Place next = place;
  next[axis] += is_max(face) ? 1 : -1;
  return cell(block, next);
}

void CellMesh::connect(const Interface& interface) {
  const Interface one = ascending(interface);
  const BlockRange& second = one.second;
  const std::array<int, 3> n = cells_along(second.block);
  for_cells_behind(one.first, [&](int block, const Place& here, BlockFace) {
    Place there{};
    for (const std::size_t axis : running_axes(one.first.face)) {
      const int direction = one.transform[axis];
      const auto to = static_cast<std::size_t>(std::abs(direction)) - 1;
      const int offset = here[axis] - one.first.begin[axis];
      there[to] = second.begin[to] + (direction > 0 ? offset : -offset - 1);
    }
    const std::size_t normal = axis_of(second.face);
    there[normal] = is_max(second.face) ? n[normal] - 1 : 0;
    const std::int32_t a = cell(block, here);
    const std::int32_t b = cell(second.block, there);
    if (a == b) {
      throw InputError(fmt::format("block {}: cell ({}, {}, {}) is its own neighbour, which "
                                   "unstructured formats do not know; use more cells round",
                                   mesh_.blocks[static_cast<std::size_t>(block)].name, here[0] + 1,
                                   here[1] + 1, here[2] + 1),
                       {block, here[0], here[1], here[2]});
    }
    beyond_face(block, here, one.first.face) = b;
    beyond_face(second.block, there, second.face) = a;
  });
}

CellMesh::StackSide CellMesh::at_rim(int block, int point) const {
  const Block& b = mesh_.blocks[static_cast<std::size_t>(block)];
  const auto r = static_cast<std::size_t>(point);
  const std::array<int, 4>& face = b.faces[static_cast<std::size_t>(b.rim.faces[r])];
  std::size_t side = 0;
  while (side < 3 &&
         !(face[side] == b.rim.points[r] && face[(side + 1) % 4] == b.rim.points[r + 1])) {
    ++side;
  }
  return {block, b.rim.faces[r], side};
}

/// `visit(first column, second column, side)`: all sides of a block's stacks that may border on
/// polygons: of a grid those that no interface covers.
template <typename Visit>
void CellMesh::for_open_sides(int block, const Visit& visit) const {
  const Block& b = mesh_.blocks[static_cast<std::size_t>(block)];
  for (int stack = 0; stack < b.stacks_i() * b.stacks_j(); ++stack) {
    const Place place{stack % b.stacks_i(), stack / b.stacks_i(), 0};
    const std::array<int, 4> ring = b.stack(place[0], place[1]);
    for (std::size_t side = 0; side < 4; ++side) {
      if (ring[side] == ring[(side + 1) % 4]) continue;
      if (b.is_grid() && beyond(block, place, kSideFaces[side]) >= 0) continue;
      visit(ring[side], ring[(side + 1) % 4], StackSide{block, stack, side});
    }
  }
}

void CellMesh::set_beyond(const StackSide& from, const StackSide& to) {
  if (!mesh_.blocks[static_cast<std::size_t>(from.block)].is_grid()) {
    sides_[static_cast<std::size_t>(from.block)][static_cast<std::size_t>(from.stack)][from.side] =
        to;
    return;
  }
  const std::array<int, 3> n = cells_along(from.block);
  const int cells_i = cells_along(to.block)[0];
  for (int k = 0; k < n[2]; ++k) {
    beyond_face(from.block, {from.stack % n[0], from.stack / n[0], k}, kSideFaces[from.side]) =
        cell(to.block, {to.stack % cells_i, to.stack / cells_i, k});
  }
}

/// Stacks that share two columns are neighbours.
void CellMesh::connect_polygons() {
  struct ColumnPair {
    int low, high;
    StackSide side;
  };
  std::vector<ColumnPair> pairs;
  for (int b = 0; b < static_cast<int>(mesh_.blocks.size()); ++b) {
    for_open_sides(b, [&](int from, int to, const StackSide& side) {
      pairs.push_back({std::min(from, to), std::max(from, to), side});
    });
  }
  parallel::sort(pairs.begin(), pairs.end(), [](const ColumnPair& a, const ColumnPair& b) {
    return std::tie(a.low, a.high, a.side.block, a.side.stack, a.side.side) <
           std::tie(b.low, b.high, b.side.block, b.side.stack, b.side.side);
  });
  for (std::size_t p = 0; p + 1 < pairs.size(); ++p) {
    if (pairs[p].low != pairs[p + 1].low || pairs[p].high != pairs[p + 1].high) continue;
    set_beyond(pairs[p].side, pairs[p + 1].side);
    set_beyond(pairs[p + 1].side, pairs[p].side);
  }
}

void CellMesh::collect_patches(Extent extent) {
  std::vector<std::string> names;  // as given: `CellPatch::name` is a word
  std::set<std::string> taken;
  for (const BoundaryFace& face : mesh_.boundary_faces) {
    const bool is_side = is_across(mesh_, face.range);
    if (is_side && extent == Extent::Plane) continue;
    const BlockRange range = ascending(face.range);
    std::int64_t count = 0;
    for_cells_behind(range, [&](int block, const Place& place, BlockFace of_cell) {
      const Corners at = corners(block, place);
      const bool is_face = extent == Extent::Plane
                               ? plane_side(at, of_cell).count == 2
                               : polygons(at)[static_cast<std::size_t>(of_cell)].has_area();
      count += is_face ? 1 : 0;
    });
    if (count == 0) continue;
    std::size_t p = 0;
    while (p < names.size() &&
           !(names[p] == face.name && patches_[p].condition == face.condition)) {
      ++p;
    }
    if (p == names.size()) {
      names.push_back(face.name);
      patches_.push_back({word_of(face.name, taken), face.condition, is_side});
    }
    patches_[p].is_flat_side = patches_[p].is_flat_side && is_side;
    patches_[p].ranges.push_back(range);
    patches_[p].faces += count;
  }
}

void CellMesh::check_cells(Extent extent) const {
  for_cells([&](int block, const Place& place) {
    const Corners at = corners(block, place);
    const bool is_cell = extent == Extent::Plane
                             ? plane_cell(at).has_area()
                             : std::ranges::count_if(polygons(at), &Polygon::has_area) >= 4;
    if (is_cell) return;
    throw InputError(fmt::format("block {}: cell ({}, {}, {}) has collapsed to nothing, which "
                                 "unstructured formats do not know; write CGNS or PLOT3D",
                                 mesh_.blocks[static_cast<std::size_t>(block)].name, place[0] + 1,
                                 place[1] + 1, place[2] + 1),
                     {block, place[0], place[1], place[2]});
  });
}

}  // namespace vdb_offset
