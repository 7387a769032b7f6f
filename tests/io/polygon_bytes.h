#pragma once

// Files of polygons put together by hand, and reading them.

#include <bit>
#include <cstdint>
#include <string>
#include <vector>

#include "io/polygon_parse.h"

namespace vdb_offset::test {

inline PolygonMesh read(const std::string& bytes, const std::string& name) {
  return read_polygons_bytes({bytes, name}, {});
}

/// "" if it is read, else the message.
inline std::string said_of(const std::string& bytes, const std::string& name) {
  try {
    read(bytes, name);
  } catch (const Error& error) {
    return error.what();
  }
  return {};
}

/// The bytes of a value, lowest or highest first.
template <typename Bits>
std::string bytes_of(Bits value, bool big) {
  std::string out;
  for (std::size_t n = 0; n < sizeof(Bits); ++n) {
    const std::size_t shift = 8 * (big ? sizeof(Bits) - 1 - n : n);
    out += static_cast<char>(value >> shift & 0xff);
  }
  return out;
}
inline std::string float_bytes(float value, bool big = false) {
  return bytes_of(std::bit_cast<std::uint32_t>(value), big);
}
inline std::string double_bytes(double value, bool big = false) {
  return bytes_of(std::bit_cast<std::uint64_t>(value), big);
}

inline std::string binary_stl(std::string header, const Vec3List& corners) {
  header.resize(80, ' ');
  const auto count = static_cast<std::uint32_t>(corners.size() / 3);
  std::string out = header + bytes_of(count, false);
  for (std::size_t n = 0; n < corners.size(); ++n) {
    if (n % 3 == 0) out += std::string(12, '\0');
    for (int c = 0; c < 3; ++c) out += float_bytes(static_cast<float>(corners[n][c]));
    if (n % 3 == 2) out += std::string(2, '\0');
  }
  return out;
}

inline const Vec3List kTwoTriangles{{0, 0, 0}, {1, 0, 0}, {1, 1, 0},
                                    {0, 0, 0}, {1, 1, 0}, {0, 1, 0}};

inline const std::string kTextStl =
    "solid left wing\n facet normal 0 0 1\n  outer loop\n   vertex 0 0 0\n   vertex 1 0 0\n"
    "   vertex 0 1 0\n  endloop\n endfacet\nendsolid left wing\n";

/// A square of two triangles and a scalar, a list and an element that nobody wants.
inline std::string ply_header(const std::string& format) {
  return "ply\nformat " + format +
         " 1.0\ncomment made by hand\nelement vertex 4\nproperty uchar red\nproperty float x\n"
         "property double y\nproperty short z\nproperty list uchar ushort near\n"
         "element edge 2\nproperty int a\nproperty list char float w\n"
         "element face 2\nproperty list uint int vertex_indices\nproperty char mark\nend_header\n";
}
inline std::string ascii_ply() {
  return ply_header("ascii") +
         "9 0 0 0 0\n9 1 0 0 2 7 8\n9 1 1 -3 0\n9 0 1 0 1 5\n4 0\n5 2 .5 1e3\n3 0 1 2 -1\n"
         "3 0 2 3 1\n";
}
inline std::string binary_ply(bool big) {
  std::string out = ply_header(big ? "binary_big_endian" : "binary_little_endian");
  const auto vertex = [&](float x, double y, int z, const std::vector<int>& near) {
    out += '\x09' + float_bytes(x, big) + double_bytes(y, big);
    out += bytes_of(static_cast<std::uint16_t>(z), big);
    out += static_cast<char>(near.size());
    for (const int n : near) out += bytes_of(static_cast<std::uint16_t>(n), big);
  };
  vertex(0, 0, 0, {});
  vertex(1, 0, 0, {7, 8});
  vertex(1, 1, -3, {});
  vertex(0, 1, 0, {5});
  out += bytes_of(std::uint32_t{4}, big) + '\0';
  out += bytes_of(std::uint32_t{5}, big) + '\x02' + float_bytes(0.5, big) + float_bytes(1e3F, big);
  for (const std::vector<int>& face : {std::vector{3, 0, 1, 2}, std::vector{3, 0, 2, 3}}) {
    for (const int n : face) out += bytes_of(static_cast<std::uint32_t>(n), big);
    out += '\x01';
  }
  return out;
}

}  // namespace vdb_offset::test
