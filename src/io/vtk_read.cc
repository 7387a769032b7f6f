// What write_vtm writes, and files of that form: VTK XML with appended raw data.

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <cstring>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include "io/input_file.h"
#include "io/number_text.h"
#include "io/text_lines.h"
#include "vdb_offset/core/error.h"
#include "vdb_offset/io/vtk.h"

namespace vdb_offset {
namespace {

namespace fs = std::filesystem;

/// A file and what messages call it.
struct Subject {
  std::string_view bytes;
  std::string name;

  [[noreturn]] void refuse(const std::string& why) const {
    throw IoError(fmt::format("{}: {}", name, why));
  }
};

/// XML's five entities as what they stand for.
std::string plain(std::string_view text) {
  constexpr std::array<std::pair<std::string_view, char>, 5> kEntities{
      {{"&amp;", '&'}, {"&lt;", '<'}, {"&gt;", '>'}, {"&quot;", '"'}, {"&apos;", '\''}}};
  std::string out;
  while (!text.empty()) {
    std::size_t taken = 1;
    char c = text[0];
    for (const auto& [entity, meaning] : kEntities) {
      if (!text.starts_with(entity)) continue;
      taken = entity.size();
      c = meaning;
    }
    out.push_back(c);
    text.remove_prefix(taken);
  }
  return out;
}

/// The value of an attribute within a tag; empty where there is none.
std::string_view attribute(std::string_view tag, std::string_view name) {
  const std::string key = fmt::format(" {}=\"", name);
  const std::size_t at = tag.find(key);
  if (at == std::string_view::npos) return {};
  const std::string_view value = tag.substr(at + key.size());
  return value.substr(0, value.find('"'));
}

/// The next tag that begins so, from `at` on, which moves behind it; empty after the last.
std::string_view next_tag(std::string_view bytes, std::string_view start, std::size_t& at) {
  const std::size_t begin = bytes.find(start, at);
  if (begin == std::string_view::npos) return {};
  const std::size_t end = bytes.find('>', begin);
  if (end == std::string_view::npos) return {};
  at = end + 1;
  return bytes.substr(begin, end - begin);
}

void check_kind(const Subject& subject, std::string_view type) {
  std::size_t at = 0;
  const std::string_view tag = next_tag(subject.bytes, "<VTKFile", at);
  if (attribute(tag, "type") != type) {
    subject.refuse(fmt::format("is no VTK file of the type {}", type));
  }
  const std::string_view order =
      std::endian::native == std::endian::little ? "LittleEndian" : "BigEndian";
  if (attribute(tag, "byte_order") != order) {
    subject.refuse(fmt::format("byte_order is {}, but only {} is read",
                               quoted(attribute(tag, "byte_order")), order));
  }
  if (!attribute(tag, "compressor").empty()) {
    subject.refuse("is compressed, but only raw appended data is read");
  }
}

/// First and last points along the three axes.
struct Extent {
  std::array<int, 3> first{};
  std::array<int, 3> last{};

  int points(std::size_t axis) const { return last[axis] - first[axis] + 1; }
};

/// Of the only piece; of a volume, or of one with a thickness along two axes.
Extent extent_of(const Subject& subject, std::size_t axes) {
  std::size_t at = 0;
  const auto extent = tokens_of(attribute(next_tag(subject.bytes, "<Piece", at), "Extent"));
  if (extent.size() != 6) subject.refuse("Extent has to be six numbers");
  Extent out;
  std::uint64_t points = 1;
  std::size_t thick = 0;
  for (std::size_t a = 0; a < 3; ++a) {
    const auto first = parse_whole(extent[2 * a]);
    const auto last = parse_whole(extent[2 * a + 1]);
    constexpr std::int64_t kLargest = std::numeric_limits<int>::max() - 1;
    if (!first || !last || *first < 0 || *last < *first + (axes == 3 ? 1 : 0) || *last > kLargest) {
      subject.refuse(fmt::format("Extent {} to {} is none of a {}", quoted(extent[2 * a]),
                                 quoted(extent[2 * a + 1]),
                                 axes == 3 ? "volume mesh" : "boundary"));
    }
    out.first[a] = static_cast<int>(*first);
    out.last[a] = static_cast<int>(*last);
    thick += *last > *first ? 1U : 0U;
    points *= static_cast<std::uint64_t>(out.points(a));
    if (points > subject.bytes.size()) subject.refuse("is too short for its Extent");
  }
  if (thick != axes) subject.refuse(fmt::format("Extent is thick along {} axes", thick));
  return out;
}

/// Where the bytes of `points` points begin.
std::size_t points_place(const Subject& subject, std::uint64_t points) {
  const std::string_view bytes = subject.bytes;
  std::size_t at = bytes.find("<Points>");
  if (at == std::string_view::npos) subject.refuse("has no <Points>");
  const std::string_view array = next_tag(bytes, "<DataArray", at);
  const auto offset = parse_whole(attribute(array, "offset"));
  const bool is_ours = attribute(array, "type") == "Float64" &&
                       attribute(array, "format") == "appended" && offset && *offset >= 0;
  if (!is_ours) subject.refuse("points have to be Float64 and appended");
  const std::size_t data = bytes.find("<AppendedData encoding=\"raw\">", at);
  const std::size_t start = data == std::string_view::npos ? data : bytes.find('_', data);
  if (start == std::string_view::npos) subject.refuse("has no raw appended data");
  const std::uint64_t begin = start + 1 + static_cast<std::uint64_t>(*offset);
  const std::uint64_t size = points * sizeof(Vec3);
  std::uint64_t said = 0;
  if (begin > bytes.size() || bytes.size() - begin < sizeof(said) + size) {
    subject.refuse("ends before its points do");
  }
  std::memcpy(&said, bytes.data() + begin, sizeof(said));
  if (said != size) subject.refuse(fmt::format("points take {} bytes, not {}", said, size));
  return begin + sizeof(said);
}

struct GridPiece {
  Extent extent;
  Vec3List points_world;
};

GridPiece read_grid(const fs::path& file, std::size_t axes) {
  const std::string bytes = contents_of(file, "a VTK grid");
  const Subject subject{bytes, file.string()};
  check_kind(subject, "StructuredGrid");
  std::size_t at = 0;
  if (attribute(next_tag(bytes, "<VTKFile", at), "header_type") != "UInt64") {
    subject.refuse("header_type is not UInt64");
  }
  GridPiece grid{extent_of(subject, axes), {}};
  std::size_t count = 1;
  for (std::size_t a = 0; a < 3; ++a) count *= static_cast<std::size_t>(grid.extent.points(a));
  const std::size_t begin = points_place(subject, count);
  grid.points_world.resize(count);
  std::memcpy(grid.points_world.data()->data(), bytes.data() + begin, count * sizeof(Vec3));
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

/// Where the group of boundaries begins; the end if there is none. Blocks may have its name.
std::size_t find_group(std::string_view bytes) {
  std::size_t at = 0;
  for (std::string_view tag = next_tag(bytes, "<Block", at); !tag.empty();
       tag = next_tag(bytes, "<Block", at)) {
    if (attribute(tag, "name") == "boundaries") return at;
  }
  return bytes.size();
}

/// Of the group "boundaries": a block for each name, in it a piece for each part of it.
void read_boundaries(std::string_view group, const fs::path& folder, ZoneMesh& mesh) {
  std::string name;
  for (std::size_t at = 0; at < group.size();) {
    std::size_t behind = at;
    const std::string_view tag = next_tag(group, "<", behind);
    if (tag.empty()) return;
    at = behind;
    if (tag.starts_with("<Block")) name = plain(attribute(tag, "name"));
    if (!tag.starts_with("<DataSet")) continue;
    const fs::path piece = plain(attribute(tag, "file"));
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
          fmt::format("boundary '{}': piece {} is no part of the surface of "
                      "block '{}'",
                      name, vdb_offset::quoted(piece.string()), mesh.zones[*block].name));
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
  const std::string bytes = contents_of(file, "a VTK index");
  const Subject subject{bytes, file.string()};
  check_kind(subject, "vtkMultiBlockDataSet");
  if (bytes.find("</VTKFile>") == std::string::npos) subject.refuse("ends before </VTKFile>");
  const std::size_t group = find_group(bytes);
  const std::string_view blocks = std::string_view(bytes).substr(0, group);
  std::size_t at = 0;
  for (std::string_view tag = next_tag(blocks, "<DataSet", at); !tag.empty();
       tag = next_tag(blocks, "<DataSet", at)) {
    const fs::path piece = plain(attribute(tag, "file"));
    if (piece.extension() != ".vts") {
      subject.refuse(
          fmt::format("piece {}: only .vts is read", vdb_offset::quoted(piece.string())));
    }
    mesh.zones.push_back(read_piece(file.parent_path() / piece, plain(attribute(tag, "name"))));
  }
  if (mesh.zones.empty()) subject.refuse("names no blocks");
  read_boundaries(std::string_view(bytes).substr(group), file.parent_path(), mesh);
  return mesh;
}

}  // namespace vdb_offset
