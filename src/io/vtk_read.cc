// What write_vtm writes, and grids of that form.

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include "io/number_text.h"
#include "io/text_lines.h"
#include "io/vtk_file.h"
#include "vdb_offset/core/error.h"
#include "vdb_offset/io/vtk.h"

namespace vdb_offset {
namespace {

namespace fs = std::filesystem;

/// First and last points along the three axes.
struct Extent {
  std::array<int, 3> first{};
  std::array<int, 3> last{};

  int points(std::size_t axis) const { return last[axis] - first[axis] + 1; }
};

/// Of the only piece; of a volume, or of one with a thickness along two axes.
Extent extent_of(const VtkFile& file, const pugi::xml_node& piece, std::size_t axes) {
  const auto extent = tokens_of(piece.attribute("Extent").value());
  if (extent.size() != 6) file.refuse("Extent has to be six numbers");
  Extent out;
  std::size_t thick = 0;
  for (std::size_t a = 0; a < 3; ++a) {
    const auto first = parse_whole(extent[2 * a]);
    const auto last = parse_whole(extent[2 * a + 1]);
    constexpr std::int64_t kLargest = std::numeric_limits<int>::max() - 1;
    if (!first || !last || *first < 0 || *last < *first + (axes == 3 ? 1 : 0) || *last > kLargest) {
      file.refuse(fmt::format("Extent {} to {} is none of a {}", quoted(extent[2 * a]),
                              quoted(extent[2 * a + 1]), axes == 3 ? "volume mesh" : "boundary"));
    }
    out.first[a] = static_cast<int>(*first);
    out.last[a] = static_cast<int>(*last);
    thick += *last > *first ? 1U : 0U;
  }
  if (thick != axes) file.refuse(fmt::format("Extent is thick along {} axes", thick));
  return out;
}

struct GridPiece {
  Extent extent;
  Vec3List points_world;
};

GridPiece read_grid(const fs::path& path, std::size_t axes) {
  const VtkFile file(path, "StructuredGrid");
  const pugi::xml_node piece = file.root().child("Piece");
  GridPiece grid{extent_of(file, piece, axes), {}};
  // A factor at a time, so that no product is too large.
  std::size_t count = 1;
  for (std::size_t a = 0; a < 3; ++a) {
    count *= static_cast<std::size_t>(grid.extent.points(a));
    if (count > kMostVtkPoints) file.refuse("Extent has too many points");
  }
  grid.points_world = file.points(piece, count);
  return grid;
}

Zone read_piece(const fs::path& file, const std::string& name) {
  GridPiece grid = read_grid(file, 3);
  Zone zone{name, "", grid.extent.points(0), grid.extent.points(1), grid.extent.points(2)};
  zone.points_world = std::move(grid.points_world);
  return zone;
}

/// The block that a boundary's piece is of, by the name that write_vtm gives it: block_B_face_N.
std::optional<std::size_t> block_of(const fs::path& piece) {
  const std::string stem = piece.stem().string();
  const std::string_view begin = "block_";
  const std::size_t end = stem.find("_face_");
  if (!stem.starts_with(begin) || end == std::string::npos) return {};
  const auto number = parse_whole(std::string_view(stem).substr(begin.size(), end - begin.size()));
  if (!number || *number < 0) return {};
  return static_cast<std::size_t>(*number);
}

/// Where the piece lies on its block; nothing if it does not hold the points there.
std::optional<BlockRange> range_of(const GridPiece& grid, const ZoneMesh& mesh, std::size_t block) {
  const Zone& zone = mesh.zones[block];
  const std::array<int, 3> sizes{zone.ni, zone.nj, zone.nk};
  const auto& [first, last] = grid.extent;
  BlockRange range{static_cast<int>(block), BlockFace::KMin, first, last};
  for (std::size_t a = 0; a < 3; ++a) {
    if (last[a] >= sizes[a]) return {};
    if (first[a] != last[a]) continue;
    if (first[a] != 0 && first[a] != sizes[a] - 1) return {};
    range.face = static_cast<BlockFace>(2 * a + (first[a] == 0 ? 0U : 1U));
  }
  std::size_t n = 0;
  for (int k = first[2]; k <= last[2]; ++k) {
    for (int j = first[1]; j <= last[1]; ++j) {
      for (int i = first[0]; i <= last[0]; ++i) {
        if (std::memcmp(&zone.at(i, j, k), &grid.points_world[n++], sizeof(Vec3)) != 0) return {};
      }
    }
  }
  return range;
}

/// Of the group "boundaries": a block for each name, in it a piece for each part of it.
void read_boundaries(const pugi::xml_node& group, const fs::path& folder, ZoneMesh& mesh) {
  for (const pugi::xml_node& of_name : group.children("Block")) {
    const std::string name = of_name.attribute("name").value();
    for (const pugi::xml_node& data : of_name.children("DataSet")) {
      const fs::path piece = data.attribute("file").value();
      const auto block = block_of(piece);
      if (!block || *block >= mesh.zones.size()) {
        mesh.faults.push_back(fmt::format("boundary '{}': piece {} says by its name of no block",
                                          name, vdb_offset::quoted(piece.string())));
        continue;
      }
      const auto range = range_of(read_grid(folder / piece, 2), mesh, *block);
      if (range) {
        mesh.boundary_faces.push_back({BoundaryKind::Boundary, name, *range});
      } else {
        mesh.faults.push_back(
            fmt::format("boundary '{}': piece {} is no part of the surface of block '{}'", name,
                        vdb_offset::quoted(piece.string()), mesh.zones[*block].name));
      }
    }
  }
}

}  // namespace

ZoneMesh read_vtm(const std::filesystem::path& file) {
  ZoneMesh mesh;
  if (file.extension() == ".vts") {
    mesh.zones.push_back(read_piece(file, file.stem().string()));
    return mesh;
  }
  const VtkFile index(file, "vtkMultiBlockDataSet");
  const auto read_block = [&](const pugi::xml_node& data) {
    const fs::path piece = data.attribute("file").value();
    if (piece.extension() != ".vts") {
      index.refuse(fmt::format("piece {}: only .vts is read", vdb_offset::quoted(piece.string())));
    }
    mesh.zones.push_back(read_piece(file.parent_path() / piece, data.attribute("name").value()));
  };
  pugi::xml_node boundaries;
  for (const pugi::xml_node& node : index.root().children()) {
    const std::string_view kind = node.name();
    if (kind == "DataSet") read_block(node);
    if (kind != "Block") continue;
    if (std::string_view(node.attribute("name").value()) == "boundaries") {
      boundaries = node;
      continue;
    }
    for (const pugi::xml_node& data : node.children("DataSet")) read_block(data);
  }
  if (mesh.zones.empty()) index.refuse("names no blocks");
  read_boundaries(boundaries, file.parent_path(), mesh);
  return mesh;
}

}  // namespace vdb_offset
