#pragma once

#include <fmt/format.h>

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <string>
#include <string_view>
#include <vector>

#include "vdb_offset/blocks/multi_block.h"
#include "vdb_offset/blocks/quality.h"
#include "vdb_offset/core/error.h"

namespace vdb_offset {

inline constexpr std::string_view kVtkByteOrder =
    std::endian::native == std::endian::little ? "LittleEndian" : "BigEndian";

/// One array of the appended part of a VTK XML file.
struct VtkArray {
  std::string_view name;
  std::string_view type;
  std::uint64_t item_bytes = 0;  ///< of one point or cell
  int components = 1;
};

inline constexpr VtkArray kVtkPoints{"points", "Float64", 24, 3};
/// What columns and levels say of each point.
inline constexpr std::array<VtkArray, 6> kVtkPointData{{{"height", "Float64", 8},
                                                        {"coverage", "Float32", 4},
                                                        {"room", "Float32", 4},
                                                        {"stop", "UInt8", 1},
                                                        {"level", "Int32", 4},
                                                        {"node", "Int32", 4}}};
inline constexpr std::array<VtkArray, 9> kVtkCellData{{{"block", "Int32", 4},
                                                       {"layer", "Int32", 4},
                                                       {"scaled_jacobian", "Float32", 4},
                                                       {"volume", "Float32", 4},
                                                       {"min_jacobian", "Float32", 4},
                                                       {"skewness", "Float32", 4},
                                                       {"aspect_ratio", "Float32", 4},
                                                       {"orthogonality", "Float32", 4},
                                                       {"growth", "Float32", 4}}};

/// What a block's cells carry, in the order of kVtkCellData behind "layer".
inline std::array<const std::vector<float>*, 7> vtk_cell_values(
    const std::vector<float>& scaled_jacobian, const CellFields& fields) {
  return {&scaled_jacobian,     &fields.volume,        &fields.min_jacobian, &fields.skewness,
          &fields.aspect_ratio, &fields.orthogonality, &fields.growth};
}

/// Throws InputError unless the quality has a value for each cell.
inline void check_of_mesh(const QualityField& quality, const MultiBlock& mesh) {
  const std::size_t blocks = mesh.blocks.size();
  bool fits = quality.scaled_jacobian.size() == blocks;
  for (std::size_t b = 0; fits && b < blocks; ++b) {
    fits = quality.scaled_jacobian[b].size() == mesh.blocks[b].cell_count();
  }
  if (!fits) throw InputError("the quality to write is not of this mesh; judge it first");
}

/// Of an array of `count` points or cells whose data begin at `offset`, which moves on behind them.
inline std::string vtk_declaration(const VtkArray& array, std::uint64_t count,
                                   std::uint64_t& offset) {
  const std::uint64_t begin = offset;
  offset += sizeof(std::uint64_t) + count * array.item_bytes;
  return fmt::format(
      "<DataArray type=\"{}\" Name=\"{}\" NumberOfComponents=\"{}\" format=\"appended\" "
      "offset=\"{}\"/>\n",
      array.type, array.name, array.components, begin);
}

template <typename T>
void put_bytes(std::vector<char>& bytes, const T& value) {
  const std::size_t size = bytes.size();
  bytes.resize(size + sizeof(T));
  std::memcpy(bytes.data() + size, &value, sizeof(T));
}

}  // namespace vdb_offset
