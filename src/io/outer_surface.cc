#include "vdb_offset/io/outer_surface.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <iterator>
#include <ostream>
#include <string>
#include <unordered_map>
#include <utility>
#include <vector>

#include "io/output_file.h"

namespace vdb_offset {
namespace {

/// The corners of a face of the level as columns, around, each once.
struct Ring {
  std::array<int, 4> columns{};
  std::size_t count = 0;

  explicit Ring(const std::array<int, 4>& corners) {
    for (const int column : corners) {
      if (count == 0 || columns[count - 1] != column) columns[count++] = column;
    }
    while (count > 1 && columns[count - 1] == columns[0]) --count;
  }
};

/// `visit(ring)` for all faces of a block's last level, outward; those without area are left out.
template <typename Visit>
void for_rings(const Block& block, const Visit& visit) {
  for (int j = 0; j < block.stacks_j(); ++j) {
    for (int i = 0; i < block.stacks_i(); ++i) {
      const Ring ring(block.stack(i, j));
      if (ring.count >= 3) visit(ring);
    }
  }
}

/// Numbers of the points, from 1, in the order of columns; 0 for columns of no block.
std::vector<std::uint32_t> number(const MultiBlock& mesh) {
  std::vector<std::uint32_t> numbers(static_cast<std::size_t>(mesh.nodes()), 0);
  for (const Block& block : mesh.blocks) {
    const auto used = mesh.flat ? static_cast<std::size_t>(block.ni) : block.columns.size();
    for (std::size_t c = 0; c < used; ++c) numbers[static_cast<std::size_t>(block.columns[c])] = 1;
  }
  std::uint32_t next = 0;
  for (std::uint32_t& n : numbers) n = n > 0 ? ++next : 0;
  return numbers;
}

/// The level as Wavefront text.
class ObjText {
 public:
  ObjText(std::ostream& stream, const MultiBlock& mesh)
      : stream_(stream), mesh_(mesh), numbers_(number(mesh)) {}

  void write() {
    const int last = mesh_.layers.levels() - 1;
    for (int n = 0; n < mesh_.nodes(); ++n) {
      if (numbers_[static_cast<std::size_t>(n)] == 0) continue;
      const Vec3& p = mesh_.layers.at(n, last);
      // The shortest text that brings back every double.
      fmt::format_to(std::back_inserter(text_), "v {} {} {}\n", p.x(), p.y(), p.z());
      if (n % kSent == 0) send();
    }
    for (std::size_t b = 0; b < mesh_.blocks.size(); ++b) {
      fmt::format_to(std::back_inserter(text_), "g block_{}\n", b);
      mesh_.flat ? put_lines(mesh_.blocks[b]) : put_faces(mesh_.blocks[b]);
      send();
    }
  }

 private:
  static constexpr int kSent = 1000;

  void put_faces(const Block& block) {
    for_rings(block, [&](const Ring& ring) { put_element('f', ring); });
  }

  void put_lines(const Block& block) {
    for (int i = 0; i + 1 < block.ni; ++i) {
      const int here = block.column(i, 0);
      const Ring line({here, block.column(i + 1, 0), here, here});
      if (line.count == 2) put_element('l', line);
    }
  }

  void put_element(char kind, const Ring& ring) {
    text_.push_back(kind);
    for (std::size_t c = 0; c < ring.count; ++c) {
      const auto column = static_cast<std::size_t>(ring.columns[c]);
      fmt::format_to(std::back_inserter(text_), " {}", numbers_[column]);
    }
    text_.push_back('\n');
  }

  void send() {
    stream_.write(text_.data(), static_cast<std::streamsize>(text_.size()));
    text_.clear();
  }

  std::ostream& stream_;
  const MultiBlock& mesh_;
  std::vector<std::uint32_t> numbers_;
  fmt::memory_buffer text_;
};

}  // namespace

Patches outer_level(const MultiBlock& mesh) {
  const int last = mesh.layers.levels() - 1;
  Patches out;
  for (const Block& block : mesh.blocks) {
    Patch patch{.name = block.name,
                .family = "outer",
                .ni = block.ni,
                .nj = mesh.flat ? 1 : block.nj,
                .points_world = {}};
    const auto points = mesh.flat ? static_cast<std::size_t>(patch.ni) : block.columns.size();
    for (std::size_t c = 0; c < points; ++c) {
      patch.points_world.push_back(mesh.layers.at(block.columns[c], last));
    }
    std::unordered_map<int, int> point_of;  // of polygons' columns
    if (!block.is_grid()) {
      for (const int column : block.columns) {
        point_of.emplace(column, static_cast<int>(point_of.size()));
      }
    }
    for (std::array<int, 4> face : block.faces) {
      for (int& corner : face) corner = point_of.at(corner);
      patch.faces.push_back(face);
    }
    out.push_back(std::move(patch));
  }
  return out;
}

void write_outer_obj(const std::filesystem::path& file, const MultiBlock& mesh) {
  OutputFile output(file);
  ObjText(output.stream(), mesh).write();
  output.commit();
}

}  // namespace vdb_offset
