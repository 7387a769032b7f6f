#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <limits>
#include <pugixml.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "vdb_offset/core/vec.h"

namespace vdb_offset {

inline constexpr std::size_t kMostVtkPoints = std::numeric_limits<std::int32_t>::max();

/// A VTK XML file in memory: its tree, and the data of its arrays whichever way they are kept: as
/// text, in base64 or appended (raw or in base64), as they are or packed by zlib.
class VtkFile {
 public:
  /// Throws IoError unless the file is XML of VTK, of that `type` ("StructuredGrid").
  VtkFile(const std::filesystem::path& file, std::string_view type);

  /// The element <type> in <VTKFile>.
  pugi::xml_node root() const;
  /// How many bytes the file has.
  std::size_t size() const { return bytes_.size(); }

  /// The `count` numbers of a <DataArray>, text or in this machine's byte order. Throws IoError
  /// where it has others, or as many that are not finite (`reals`) or not whole by their type
  /// (`wholes`).
  std::vector<double> reals(const pugi::xml_node& array, std::size_t count) const;
  std::vector<std::int64_t> wholes(const pugi::xml_node& array, std::size_t count) const;

  /// The points of a <Piece>.
  Vec3List points(const pugi::xml_node& piece, std::size_t count) const;

  [[noreturn]] void refuse(const std::string& why) const;

 private:
  template <typename T>
  std::vector<T> numbers(const pugi::xml_node& array, std::size_t count) const;
  template <typename T>
  std::vector<T> text_numbers(const pugi::xml_node& array, std::size_t count) const;
  std::string data_of(const pugi::xml_node& array, std::size_t bytes) const;

  std::string name_;  ///< for messages
  std::string bytes_;
  std::string_view appended_;  ///< behind its '_'
  bool appended_is_raw_ = false;
  bool is_packed_ = false;
  std::size_t word_ = 4;  ///< bytes of a number of the headers
  pugi::xml_document tree_;
};

}  // namespace vdb_offset
