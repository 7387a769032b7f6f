#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>
#include <limits>
#include <string>
#include <vector>

#include "io/output_file.h"
#include "vdb_offset/core/error.h"
#include "vdb_offset/io/stl.h"

namespace vdb_offset {
namespace {

using Float3 = std::array<float, 3>;

/// A triangle as 50 bytes.
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

/// A cell's triangles, as corners.
std::array<std::array<std::size_t, 3>, 2> cut(const std::array<Vec3, 4>& p) {
  if ((p[2] - p[0]).squaredNorm() <= (p[3] - p[1]).squaredNorm()) return {{{0, 1, 2}, {0, 2, 3}}};
  return {{{0, 1, 3}, {1, 2, 3}}};
}

void put_patch(std::string& bytes, const Patch& patch) {
  for_cells(patch, [&](const std::array<int, 4>& corners) {
    std::array<Vec3, 4> p;
    std::array<Float3, 4> rounded{};
    for (std::size_t c = 0; c < 4; ++c) {
      p[c] = patch.points_world[static_cast<std::size_t>(corners[c])];
      for (std::size_t a = 0; a < 3; ++a) {
        rounded[c][a] = static_cast<float>(p[c][static_cast<Eigen::Index>(a)]);
      }
    }
    for (const auto& [a, b, c] : cut(p)) {
      const bool has_area =
          rounded[a] != rounded[b] && rounded[b] != rounded[c] && rounded[c] != rounded[a];
      if (has_area) put_triangle(bytes, {rounded[a], rounded[b], rounded[c]});
    }
  });
}

}  // namespace

void write_stl(const std::filesystem::path& file, const Patches& patches) {
  std::string bytes;
  for (const Patch& patch : patches) {
    if (patch.nj == 1) {
      throw InputError(file.string() + ": STL holds no curves; write .obj or PLOT3D");
    }
    put_patch(bytes, patch);
  }
  constexpr std::size_t kTriangle = 50;
  const std::size_t count = bytes.size() / kTriangle;
  if (count > std::numeric_limits<std::uint32_t>::max()) {
    throw LimitError(
        fmt::format("{}: {} triangles are more than STL can count", file.string(), count));
  }
  OutputFile output(file);
  std::string head = "vdb-offset";  // not "solid", which begins the text form
  head.resize(80, ' ');
  const auto number_of = static_cast<std::uint32_t>(count);
  head.append(reinterpret_cast<const char*>(&number_of), sizeof number_of);
  output.stream() << head;
  output.stream().write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  output.commit();
}

}  // namespace vdb_offset
