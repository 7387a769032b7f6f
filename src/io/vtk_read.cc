// What write_vtm writes, and files of that form: VTK XML with appended raw data.

#include <fmt/format.h>

#include <array>
#include <bit>
#include <cstdint>
#include <cstring>
#include <limits>
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

/// Points along the three axes, by the extent of the only piece.
std::array<std::int64_t, 3> sizes_of(const Subject& subject) {
  std::size_t at = 0;
  const auto extent = tokens_of(attribute(next_tag(subject.bytes, "<Piece", at), "Extent"));
  if (extent.size() != 6) subject.refuse("Extent has to be six numbers");
  std::array<std::int64_t, 3> sizes{};
  std::uint64_t points = 1;
  for (std::size_t a = 0; a < 3; ++a) {
    const auto first = parse_whole(extent[2 * a]);
    const auto last = parse_whole(extent[2 * a + 1]);
    constexpr std::int64_t kLargest = std::numeric_limits<int>::max() - 1;
    if (!first || !last || *first < 0 || *last <= *first || *last > kLargest) {
      subject.refuse(fmt::format("Extent {} to {} is none of a volume mesh", quoted(extent[2 * a]),
                                 quoted(extent[2 * a + 1])));
    }
    sizes[a] = *last - *first + 1;
    points *= static_cast<std::uint64_t>(sizes[a]);
    if (points > subject.bytes.size()) subject.refuse("is too short for its Extent");
  }
  return sizes;
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

Zone read_piece(const fs::path& file, const std::string& name) {
  const std::string bytes = contents_of(file, "a VTK grid");
  const Subject subject{bytes, file.string()};
  check_kind(subject, "StructuredGrid");
  std::size_t at = 0;
  if (attribute(next_tag(bytes, "<VTKFile", at), "header_type") != "UInt64") {
    subject.refuse("header_type is not UInt64");
  }
  const std::array<std::int64_t, 3> sizes = sizes_of(subject);
  Zone zone{name, "", static_cast<int>(sizes[0]), static_cast<int>(sizes[1]),
            static_cast<int>(sizes[2])};
  const std::size_t begin = points_place(subject, zone.point_count());
  zone.points_world.resize(zone.point_count());
  std::memcpy(zone.points_world.data()->data(), bytes.data() + begin,
              zone.point_count() * sizeof(Vec3));
  return zone;
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
  const std::string_view blocks =
      std::string_view(bytes).substr(0, bytes.find(" name=\"boundaries\""));
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
  return mesh;
}

}  // namespace vdb_offset
