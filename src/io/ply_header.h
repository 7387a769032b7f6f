#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "io/polygon_parse.h"

namespace vdb_offset {

enum class PlyType { Int8, Uint8, Int16, Uint16, Int32, Uint32, Float32, Float64 };

/// In bytes.
inline std::size_t size_of(PlyType type) {
  constexpr std::array<std::size_t, 8> kSizes{1, 1, 2, 2, 4, 4, 4, 8};
  return kSizes[static_cast<std::size_t>(type)];
}

struct PlyProperty {
  std::string name;
  PlyType type = PlyType::Float32;    ///< of a list: of its values
  std::optional<PlyType> count_type;  ///< of a list
};

struct PlyElement {
  std::string name;
  std::uint64_t count = 0;  ///< of rows
  std::size_t line = 0;     ///< of the header
  std::vector<PlyProperty> properties;

  bool has_lists() const;
  /// Index of a property of this name; nothing if there is none.
  std::optional<std::size_t> find(const std::string& property) const;
};

enum class PlyEncoding { Ascii, LittleEndian, BigEndian };

struct PlyHeader {
  PlyEncoding encoding = PlyEncoding::Ascii;
  std::vector<PlyElement> elements;
  std::size_t lines = 0;  ///< of the header
  std::size_t end = 0;    ///< the byte that the rows begin at
};

/// The header alone, its grammar checked. Throws IoError.
PlyHeader parse_ply_header(const PolygonText& text);

}  // namespace vdb_offset
