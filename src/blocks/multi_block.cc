#include "vdb_offset/blocks/multi_block.h"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <utility>

#include "blocks/outer_faces.h"
#include "vdb_offset/blocks/bare_stacks.h"
#include "vdb_offset/blocks/conditions.h"

namespace vdb_offset {
namespace {

/// Where a patch side lies on its block: the axis it is constant along, which end, and the axis
/// that its index runs along (0 = i, 1 = j).
struct SideFrame {
  BlockFace face;
  std::size_t normal;
  std::size_t running;
  bool at_max;
};

SideFrame frame(Side side) {
  switch (side) {
    case Side::IMin:
      return {BlockFace::IMin, 0, 1, false};
    case Side::IMax:
      return {BlockFace::IMax, 0, 1, true};
    case Side::JMin:
      return {BlockFace::JMin, 1, 0, false};
    case Side::JMax:
      break;
  }
  return {BlockFace::JMax, 1, 0, true};
}

BlockRange swept(const SideRange& side, const std::vector<Block>& blocks) {
  const Block& block = blocks[static_cast<std::size_t>(side.patch)];
  if (!block.is_grid()) {
    return {side.patch, BlockFace::JMin, {side.begin, 0, 0}, {side.end, 0, block.nk - 1}};
  }
  const SideFrame f = frame(side.side);
  const int last = (f.normal == 0 ? block.ni : block.nj) - 1;
  BlockRange range;
  range.block = side.patch;
  range.face = f.face;
  range.begin[f.normal] = range.end[f.normal] = f.at_max ? last : 0;
  range.begin[f.running] = side.begin;
  range.end[f.running] = side.end;
  range.end[2] = block.nk - 1;
  return range;
}

/// Walking off the first block through its face walks into the second: the same sense along the
/// normal axes when a maximum meets a minimum, the opposite one when two of a kind meet.
std::array<int, 3> cgns_transform(const Edge& edge) {
  const SideFrame a = frame(edge.first.side);
  const SideFrame b = frame(edge.second.side);
  const bool along = (edge.first.end > edge.first.begin) == (edge.second.end > edge.second.begin);
  std::array<int, 3> transform{0, 0, 3};
  transform[a.normal] = static_cast<int>(b.normal + 1) * (a.at_max != b.at_max ? 1 : -1);
  transform[a.running] = static_cast<int>(b.running + 1) * (along ? 1 : -1);
  return transform;
}

/// A fan's first level is an edge of the wall, or a corner.
const char* collapsed_name(const Surface& surface, const Block& block) {
  const auto place = [&](int node) { return surface.stands_at(static_cast<std::size_t>(node)); };
  const bool is_corner = std::ranges::all_of(
      block.columns, [&](int node) { return place(node) == place(block.columns.front()); });
  return is_corner ? "corner" : "edge";
}

BoundaryFace first_level(const Block& block, int index) {
  return {BoundaryKind::Wall,
          {},
          {index, BlockFace::KMin, {0, 0, 0}, {block.stacks_i(), block.stacks_j(), 0}}};
}

const Boundary& boundary_of(const Surface& surface, const Edge& edge) {
  return surface.boundaries->list()[static_cast<std::size_t>(edge.boundary)];
}

/// The internal surface that an interface lies on.
std::string internal_name(const Surface& surface, const Edge& edge) {
  const bool is_on = edge.boundary >= 0 && boundary_of(surface, edge).is_internal();
  return is_on ? boundary_of(surface, edge).name() : "";
}

void connect(const Surface& surface, MultiBlock& mesh) {
  const auto is_grid = [&](const SideRange& side) {
    return mesh.blocks[static_cast<std::size_t>(side.patch)].is_grid();
  };
  for (const Edge& edge : surface.topology.edges) {
    const BlockRange first = swept(edge.first, mesh.blocks);
    switch (edge.kind) {
      case EdgeKind::Interface:
        if (!is_grid(edge.first) || !is_grid(edge.second)) break;
        mesh.interfaces.push_back({first, swept(edge.second, mesh.blocks), cgns_transform(edge),
                                   internal_name(surface, edge)});
        break;
      case EdgeKind::Free:
        if (edge.boundary < 0) {
          mesh.boundary_faces.push_back({BoundaryKind::Free, "free", first});
        } else {
          mesh.boundary_faces.push_back(
              {BoundaryKind::Boundary, boundary_of(surface, edge).name(), first});
        }
        break;
      case EdgeKind::Degenerate:
        mesh.boundary_faces.push_back({BoundaryKind::Degenerate, "pole", first});
        break;
    }
  }
}

Block sweep_patch(const Surface& surface, std::size_t patch, int levels) {
  const Patch& p = surface.patches[patch];
  Block block;
  block.name = p.name;
  block.family = p.family;
  block.patch = static_cast<int>(patch);
  block.ni = p.ni;
  block.nj = p.nj;
  block.nk = levels;
  block.columns = surface.patch_nodes[patch];
  const auto column = [&](int point) { return block.columns[static_cast<std::size_t>(point)]; };
  for (const std::array<int, 4>& face : p.faces) {
    block.faces.push_back({column(face[0]), column(face[1]), column(face[2]), column(face[3])});
  }
  block.rim = p.rim;
  for (int& point : block.rim.points) point = point < 0 ? -1 : column(point);
  return block;
}

}  // namespace

std::size_t MultiBlock::cells() const {
  std::size_t sum = 0;
  for (const Block& block : blocks) {
    const std::size_t bare = bare_stacks(*this, block);
    sum += block.cell_count() - bare * static_cast<std::size_t>(block.nk - 1);
  }
  return sum;
}

bool MultiBlock::is_structured() const { return std::ranges::all_of(blocks, &Block::is_grid); }

MultiBlock build_blocks(const Surface& surface, Layers layers, const Progress& progress) {
  const std::size_t nodes = surface.nodes_world.size();
  const auto levels = static_cast<std::size_t>(layers.levels());
  if (layers.stop.size() != nodes || layers.points_world.size() != nodes * levels) {
    throw InputError(fmt::format(
        "build_blocks: layers of {} columns and {} points do not fit a surface of {} nodes and {} "
        "levels; march this same surface",
        layers.stop.size(), layers.points_world.size(), nodes, levels));
  }
  MultiBlock mesh;
  mesh.layers = std::move(layers);
  mesh.flat = surface.flat;
  for (std::size_t p = 0; p < surface.patches.size(); ++p) {
    progress.update("blocks", 0);
    const int index = static_cast<int>(p);
    mesh.blocks.push_back(sweep_patch(surface, p, mesh.layers.levels()));
    mesh.boundary_faces.push_back(first_level(mesh.blocks.back(), index));
    if (surface.is_fan(p)) {
      mesh.boundary_faces.back().kind = BoundaryKind::Degenerate;
      mesh.boundary_faces.back().name = collapsed_name(surface, mesh.blocks.back());
    }
    std::ranges::move(outer_faces(surface, mesh, index), std::back_inserter(mesh.boundary_faces));
  }
  connect(surface, mesh);
  set_conditions(surface, {}, mesh);
  return mesh;
}

}  // namespace vdb_offset
