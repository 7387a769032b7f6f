#include "vdb_offset/io/outer_surface.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>
#include <iterator>
#include <limits>
#include <ostream>
#include <string>
#include <vector>

#include "io/output_file.h"
#include "vdb_offset/core/error.h"

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
  for (int j = 0; j + 1 < block.nj; ++j) {
    for (int i = 0; i + 1 < block.ni; ++i) {
      const Ring ring({block.column(i, j), block.column(i + 1, j), block.column(i + 1, j + 1),
                       block.column(i, j + 1)});
      if (ring.count >= 3) visit(ring);
    }
  }
}

/// Numbers of the points, from 1, in the order of columns; 0 for columns of no block.
std::vector<std::uint32_t> number(const MultiBlock& mesh) {
  std::vector<std::uint32_t> numbers(static_cast<std::size_t>(mesh.nodes()), 0);
  for (const Block& block : mesh.blocks) {
    const auto used =
        static_cast<std::size_t>(block.ni) * static_cast<std::size_t>(mesh.flat ? 1 : block.nj);
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

using Float3 = std::array<float, 3>;

/// A triangle of a binary STL.
void put_triangle(std::string& bytes, const std::array<Float3, 3>& corners) {
  const auto vector = [](const Float3& p) { return Vec3(p[0], p[1], p[2]); };
  const Vec3 normal = (vector(corners[1]) - vector(corners[0]))
                          .cross(vector(corners[2]) - vector(corners[0]))
                          .normalized();
  std::array<Float3, 4> values{};
  for (std::size_t a = 0; a < 3; ++a) {
    values[0][a] = static_cast<float>(normal[static_cast<Eigen::Index>(a)]);
  }
  std::copy(corners.begin(), corners.end(), values.begin() + 1);
  const std::size_t size = bytes.size();
  bytes.resize(size + sizeof values + 2, '\0');
  std::memcpy(bytes.data() + size, values.data(), sizeof values);
}

/// A face's triangles, as columns.
std::vector<std::array<int, 3>> cut(const MultiBlock& mesh, const Ring& ring) {
  const std::array<int, 4>& c = ring.columns;
  if (ring.count == 3) return {{c[0], c[1], c[2]}};
  const int last = mesh.layers.levels() - 1;
  const auto diagonal = [&](std::size_t a, std::size_t b) {
    return (mesh.layers.at(c[a], last) - mesh.layers.at(c[b], last)).squaredNorm();
  };
  if (diagonal(0, 2) <= diagonal(1, 3)) return {{c[0], c[1], c[2]}, {c[0], c[2], c[3]}};
  return {{c[0], c[1], c[3]}, {c[1], c[2], c[3]}};
}

/// All triangles, as a binary STL has them.
std::string triangles(const MultiBlock& mesh) {
  const int last = mesh.layers.levels() - 1;
  const auto place = [&](int column) {
    const Eigen::Vector3f p = mesh.layers.at(column, last).cast<float>();
    return Float3{p.x(), p.y(), p.z()};
  };
  std::string bytes;
  for (const Block& block : mesh.blocks) {
    for_rings(block, [&](const Ring& ring) {
      for (const std::array<int, 3>& t : cut(mesh, ring)) {
        const std::array<Float3, 3> corners{place(t[0]), place(t[1]), place(t[2])};
        const bool has_area =
            corners[0] != corners[1] && corners[1] != corners[2] && corners[2] != corners[0];
        if (has_area) put_triangle(bytes, corners);
      }
    });
  }
  return bytes;
}

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
    const auto points = static_cast<std::size_t>(patch.ni) * static_cast<std::size_t>(patch.nj);
    for (std::size_t c = 0; c < points; ++c) {
      patch.points_world.push_back(mesh.layers.at(block.columns[c], last));
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

void write_outer_stl(const std::filesystem::path& file, const MultiBlock& mesh) {
  if (mesh.flat) {
    throw InputError(file.string() +
                     ": the outermost level of curves is curves, and STL has none; write .obj or "
                     "PLOT3D");
  }
  const std::string bytes = triangles(mesh);
  constexpr std::size_t kTriangle = 50;
  const std::size_t count = bytes.size() / kTriangle;
  if (count > std::numeric_limits<std::uint32_t>::max()) {
    throw LimitError(
        fmt::format("{}: {} triangles are more than STL can count", file.string(), count));
  }
  OutputFile output(file);
  std::string head = "vdb-offset: outermost level";
  head.resize(80, ' ');
  const auto number_of = static_cast<std::uint32_t>(count);
  head.append(reinterpret_cast<const char*>(&number_of), sizeof number_of);
  output.stream() << head;
  output.stream().write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  output.commit();
}

}  // namespace vdb_offset
