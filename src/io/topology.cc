// Topology of blocks swept from a surface: each edge of the surface gives one on the wall, one on
// the outermost level and a side face between; each vertex gives a column (Guibault, Un mailleur
// hybride structure/non structure en trois dimensions, 1998, for the relations).

#include "vdb_offset/io/topology.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstring>
#include <map>
#include <string_view>
#include <unordered_map>
#include <utility>

#include "vdb_offset/core/error.h"

namespace vdb_offset {
namespace {

using Document = TopologyDocument;
using Bits = std::array<std::uint64_t, 3>;

struct HashBits {
  std::size_t operator()(const Bits& bits) const {
    std::uint64_t h = 0;
    for (const std::uint64_t b : bits) h = (h ^ b) * 0x9E3779B97F4A7C15ULL + (h >> 29U);
    return static_cast<std::size_t>(h);
  }
};

/// Numbers places as they come, each once; equal is equal bit for bit.
class Places {
 public:
  explicit Places(Vec3List& points) : points_(points) {}

  int number(const Vec3& p) {
    Bits bits{};
    std::memcpy(bits.data(), p.data(), sizeof(bits));
    const auto [at, is_new] = numbers_.try_emplace(bits, static_cast<int>(points_.size()));
    if (is_new) points_.push_back(p);
    return at->second;
  }

 private:
  Vec3List& points_;
  std::unordered_map<Bits, int, HashBits> numbers_;
};

/// A side of a patch, and where along it an edge lies.
struct Run {
  int begin;
  Document::EdgeUse use;
};

bool is_level(const BlockRange& range) { return axis_of(range.face) == 2; }

/// Boundary faces on the wall and on the outermost level.
int level_faces(const MultiBlock& mesh) {
  return static_cast<int>(std::ranges::count_if(
      mesh.boundary_faces, [](const BoundaryFace& face) { return is_level(face.range); }));
}

class Builder {
 public:
  Builder(const Surface& surface, const MultiBlock& mesh)
      : surface_(surface), mesh_(mesh), places_(out_.points_world) {}

  Document build(const GivenSurface& given) {
    out_.flat = surface_.flat;
    add_geometry(given);
    add_vertices();
    add_edges();
    find_runs();
    find_levels();
    add_faces();
    add_blocks();
    out_.interfaces = mesh_.interfaces;
    out_.boundary_faces = mesh_.boundary_faces;
    return std::move(out_);
  }

 private:
  const std::vector<Edge>& edges() const { return surface_.topology.edges; }
  const std::vector<int>& vertices() const { return surface_.topology.vertices; }
  int patches() const { return static_cast<int>(surface_.patches.size()); }
  int last_level() const { return mesh_.layers.levels() - 1; }

  void add_grids(const Patches& patches, Document::Grid kind, double scale) {
    for (const Patch& patch : patches) {
      Document::Grid grid = kind;
      grid.name = patch.name;
      grid.family = patch.family;
      grid.body = patch.body;
      grid.ni = patch.ni;
      grid.nj = patch.nj;
      grid.faces = patch.faces;
      for (const Vec3& p : patch.points_world) {
        grid.points.push_back(places_.number(scale == 1 ? p : Vec3(scale * p)));
      }
      out_.surfaces.push_back(std::move(grid));
    }
  }

  void add_geometry(const GivenSurface& given) {
    const SurfaceOptions& options = given.options;
    add_grids(given.patches, {}, options.scale);
    for (const NamedShape& shape : options.shapes) {
      add_grids(shape.patches, {.role = Document::Role::Boundary, .boundary = shape.name},
                options.scale);
    }
    for (const NamedShape& shape : options.internals) {
      add_grids(shape.patches, {.role = Document::Role::Internal, .boundary = shape.name},
                options.scale);
    }
    for (const NamedPlane& named : options.planes) {
      out_.planes.push_back(
          {named.name, true, named.plane.point_world, named.plane.normal, named.rest});
    }
    if (!surface_.boundaries) return;
    for (const Boundary& boundary : surface_.boundaries->list()) {
      const bool is_known = std::ranges::any_of(
          out_.planes, [&](const auto& plane) { return plane.name == boundary.name(); });
      if (!boundary.is_plane() || is_known) continue;
      const Plane& plane = boundary.plane();
      out_.planes.push_back({boundary.name(), false, plane.point_world, plane.normal});
    }
  }

  /// Those of the wall, then those of the outermost level.
  void add_vertices() {
    for (const int level : {0, last_level()}) {
      for (const int node : vertices()) {
        out_.vertices.push_back(places_.number(mesh_.layers.at(node, level)));
      }
    }
  }

  int node_of(const SideRange& range, int s) const {
    const Block& block = mesh_.blocks[static_cast<std::size_t>(range.patch)];
    switch (range.side) {
      case Side::IMin:
        return block.column(0, s);
      case Side::IMax:
        return block.column(block.ni - 1, s);
      case Side::JMin:
        return block.column(s, 0);
      case Side::JMax:
        break;
    }
    return block.column(s, block.nj - 1);
  }

  void add_edge(Document::Edge edge, std::vector<int> curve) {
    edge.curve = static_cast<int>(out_.curves.size());
    out_.curves.push_back(std::move(curve));
    out_.edges.push_back(edge);
  }

  /// Those of the wall, those of the outermost level, columns.
  void add_edges() {
    const auto first_outer = static_cast<int>(vertices().size());
    for (const bool is_outer : {false, true}) {
      const int shift = is_outer ? first_outer : 0;
      const int level = is_outer ? last_level() : 0;
      for (const Edge& edge : edges()) {
        std::vector<int> curve;
        for (int s = edge.first.begin; s <= edge.first.end; ++s) {
          curve.push_back(places_.number(mesh_.layers.at(node_of(edge.first, s), level)));
        }
        add_edge({.kind = is_outer ? Document::EdgeKind::Outer : Document::EdgeKind::Wall,
                  .vertices = {edge.vertices[0] + shift, edge.vertices[1] + shift},
                  .degenerate = edge.kind == EdgeKind::Degenerate},
                 std::move(curve));
      }
    }
    for (int v = 0; v < first_outer; ++v) {
      std::vector<int> curve;
      for (int k = 0; k <= last_level(); ++k) {
        curve.push_back(
            places_.number(mesh_.layers.at(vertices()[static_cast<std::size_t>(v)], k)));
      }
      add_edge({.kind = Document::EdgeKind::Column, .vertices = {v, v + first_outer}},
               std::move(curve));
    }
  }

  /// The wall's edges along each side of each patch, in order.
  void find_runs() {
    runs_.resize(surface_.patches.size());
    const auto add = [&](const SideRange& range, int edge) {
      runs_[static_cast<std::size_t>(range.patch)][static_cast<std::size_t>(range.side)].push_back(
          {std::min(range.begin, range.end), {edge, range.begin > range.end}});
    };
    for (int e = 0; e < static_cast<int>(edges().size()); ++e) {
      const Edge& edge = edges()[static_cast<std::size_t>(e)];
      add(edge.first, e);
      if (edge.kind == EdgeKind::Interface) add(edge.second, e);
    }
    for (auto& sides : runs_) {
      for (std::vector<Run>& side : sides) std::ranges::sort(side, {}, &Run::begin);
    }
  }

  /// Around a patch; `shift` is added to its edges.
  std::vector<Document::EdgeUse> loop(std::size_t patch, int shift) const {
    std::vector<Document::EdgeUse> out;
    for (const Side side : {Side::JMin, Side::IMax, Side::JMax, Side::IMin}) {
      std::vector<Run> runs = runs_[patch][static_cast<std::size_t>(side)];
      const bool is_back = side == Side::JMax || side == Side::IMin;
      if (is_back) std::ranges::reverse(runs);
      for (const Run& run : runs) {
        out.push_back({run.use.edge + shift, run.use.reversed != is_back});
      }
    }
    return out;
  }

  /// The surface that a patch is, or is a piece of; -1 for fans.
  int surface_of(const Patch& patch) const {
    std::string_view name = patch.part_of.empty() ? patch.name : patch.part_of;
    constexpr std::string_view kOtherSide = " (against)";
    const auto find = [&](std::string_view wanted) {
      const auto found = std::ranges::find(out_.surfaces, wanted, &Document::Grid::name);
      return found == out_.surfaces.end() ? -1 : static_cast<int>(found - out_.surfaces.begin());
    };
    const int own = find(name);
    if (own >= 0 || !name.ends_with(kOtherSide)) return own;
    name.remove_suffix(kOtherSide.size());
    return find(name);
  }

  /// The boundary face of each level, the first of those that an outermost one is parted into.
  void find_levels() {
    levels_.resize(mesh_.blocks.size());
    for (auto n = static_cast<int>(mesh_.boundary_faces.size()); n-- > 0;) {
      const BlockRange& range = mesh_.boundary_faces[static_cast<std::size_t>(n)].range;
      if (!is_level(range)) continue;
      levels_[static_cast<std::size_t>(range.block)][is_max(range.face) ? 1 : 0] = n;
    }
  }

  void add_faces() {
    const auto edge_count = static_cast<int>(edges().size());
    for (const bool is_outer : {false, true}) {
      for (std::size_t p = 0; p < surface_.patches.size(); ++p) {
        Document::Face face{is_outer ? Document::FaceKind::Outer : Document::FaceKind::Wall};
        if (!is_outer && !surface_.is_fan(p)) face.surface = surface_of(surface_.patches[p]);
        face.boundary_face = levels_[p][is_outer ? 1 : 0];
        face.edges = loop(p, is_outer ? edge_count : 0);
        out_.faces.push_back(std::move(face));
      }
    }
    int interface = 0;
    int boundary_face = level_faces(mesh_);  // as build_blocks does
    for (int e = 0; e < edge_count; ++e) {
      const Edge& edge = edges()[static_cast<std::size_t>(e)];
      Document::Face face{Document::FaceKind::Side};
      (edge.kind == EdgeKind::Interface ? face.interface : face.boundary_face) =
          edge.kind == EdgeKind::Interface ? interface++ : boundary_face++;
      face.edges = {{e, false},
                    {2 * edge_count + edge.vertices[1], false},
                    {edge_count + e, true},
                    {2 * edge_count + edge.vertices[0], true}};
      out_.faces.push_back(std::move(face));
    }
  }

  void add_blocks() {
    for (std::size_t b = 0; b < mesh_.blocks.size(); ++b) {
      const Block& block = mesh_.blocks[b];
      Document::Block one{block.name, block.family, block.ni, block.nj, block.nk};
      for (std::size_t side = 0; side < 4; ++side) {  // sides of patches are in the order of faces
        for (const Run& run : runs_[b][side]) {
          one.faces[side].push_back(2 * patches() + run.use.edge);
        }
      }
      one.faces[static_cast<std::size_t>(BlockFace::KMin)] = {static_cast<int>(b)};
      one.faces[static_cast<std::size_t>(BlockFace::KMax)] = {patches() + static_cast<int>(b)};
      out_.blocks.push_back(std::move(one));
    }
  }

  const Surface& surface_;
  const MultiBlock& mesh_;
  Document out_;
  Places places_;
  std::vector<std::array<std::vector<Run>, 4>> runs_;  // of each patch, by Side
  std::vector<std::array<int, 2>> levels_;             // boundary faces of each block
};

void check_fit(const Surface& surface, const MultiBlock& mesh) {
  std::size_t joined = 0;
  for (const Edge& edge : surface.topology.edges) {
    joined += edge.kind == EdgeKind::Interface ? 1 : 0;
  }
  const std::size_t rest = surface.topology.edges.size() - joined;
  const bool fits =
      mesh.blocks.size() == surface.patches.size() && mesh.interfaces.size() == joined &&
      level_faces(mesh) >= 2 * std::ssize(mesh.blocks) &&
      mesh.boundary_faces.size() == static_cast<std::size_t>(level_faces(mesh)) + rest;
  if (!fits) {
    throw InputError(fmt::format(
        "topology_document: {} blocks and {} interfaces are not of a surface of {} patches; give "
        "the surface that the blocks were built from",
        mesh.blocks.size(), mesh.interfaces.size(), surface.patches.size()));
  }
}

bool is_named(const SurfaceOptions& options, const std::string& name) {
  const auto has = [&](const auto& list) {
    return std::ranges::any_of(list, [&](const auto& named) { return named.name == name; });
  };
  return has(options.planes) || has(options.shapes) || has(options.internals);
}

}  // namespace

TopologyDocument topology_document(const GivenSurface& given, const Surface& surface,
                                   const MultiBlock& mesh) {
  check_fit(surface, mesh);
  return Builder(surface, mesh).build(given);
}

Patches patches_of(const TopologyDocument& document, SurfaceOptions& options) {
  const SurfaceOptions before = options;
  for (const Document::BoundaryPlane& plane : document.planes) {
    if (!plane.given || is_named(before, plane.name)) continue;
    options.planes.push_back({plane.name, {plane.point_world, plane.normal}, plane.rest});
  }
  Patches walls;
  for (const Document::Grid& grid : document.surfaces) {
    Patch patch{grid.name, grid.family, grid.ni, grid.nj, {}};
    for (const int p : grid.points) {
      patch.points_world.push_back(document.points_world[static_cast<std::size_t>(p)]);
    }
    patch.faces = grid.faces;
    patch.body = grid.body;
    if (grid.role == Document::Role::Wall) {
      walls.push_back(std::move(patch));
      continue;
    }
    if (is_named(before, grid.boundary)) continue;
    auto& shapes = grid.role == Document::Role::Boundary ? options.shapes : options.internals;
    if (shapes.empty() || shapes.back().name != grid.boundary) {
      shapes.push_back({grid.boundary, {}});
    }
    shapes.back().patches.push_back(std::move(patch));
  }
  return walls;
}

}  // namespace vdb_offset
