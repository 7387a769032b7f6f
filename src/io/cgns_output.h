#pragma once

#include <cgnslib.h>

#include <array>
#include <cstdint>
#include <filesystem>
#include <mutex>
#include <string>
#include <vector>

#include "io/cgns_names.h"
#include "io/output_file.h"
#include "vdb_offset/core/vec.h"
#include "vdb_offset/io/cgns.h"

namespace vdb_offset {

/// libcgns keeps its files in globals: one call at a time.
std::mutex& cgns_mutex();

/// Throws IoError for more points than the library counts to: a 32-bit one writes a wrong file
/// without a word.
void check_cgns_size(const std::filesystem::path& file, const std::string& name,
                     std::size_t points);

/// A CGNS file with one base, that appears whole or not at all. Holds the library's mutex.
class CgnsOutput {
 public:
  struct Content {
    int cell_dimension;  ///< 3: blocks, 2: surfaces
    std::size_t points = 0;
    std::size_t zones = 0;
    std::size_t places = 0;  ///< connections and boundary conditions
  };
  /// Throws IoError, where there is no room on the disk too; InputError for the unit.
  CgnsOutput(const std::filesystem::path& file, const Content& content,
             const CgnsWriteOptions& options);
  ~CgnsOutput();
  CgnsOutput(const CgnsOutput&) = delete;
  CgnsOutput& operator=(const CgnsOutput&) = delete;

  int file() const { return index_; }
  int base() const { return base_; }
  /// Throws IoError with the library's words if `code` is an error.
  void check(int code) const;
  /// Families and zones stand side by side: a name for one of them.
  std::string name(const std::string& wanted) { return names_.take(wanted); }
  /// Some of a zone's points, i fastest.
  struct Slab {
    std::array<cgsize_t, 3> first;  // from 1
    std::array<cgsize_t, 3> last;
    const std::array<std::vector<double>, 3>& coordinates;
  };
  void write_coordinates(int zone, const Slab& slab) const;
  /// Say of a zone's coordinates, once they are there, that they are lengths.
  void say_lengths(int zone) const;
  void commit();

 private:
  void reserve(std::uint64_t bytes, bool keep_size) const;
  void open(const Content& content, const CgnsWriteOptions& options);
  void write_units(const std::string& unit) const;
  void give_up() noexcept;

  std::lock_guard<std::mutex> lock_;
  std::string name_;
  OutputFile output_;
  CgnsNames names_;
  int index_ = -1;
  int base_ = 0;
};

}  // namespace vdb_offset
