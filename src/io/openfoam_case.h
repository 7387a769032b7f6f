#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "io/output_file.h"

namespace vdb_offset {

/// The files of a case that a mesh needs, around its polyMesh.
struct OpenfoamCase {
  std::filesystem::path folder;
  std::filesystem::path marker;  ///< `NAME.foam`; empty: none

  explicit OpenfoamCase(const std::filesystem::path& file);

  /// The files of constant/polyMesh.
  Pieces poly_mesh() const;
  /// Throws IoError if the polyMesh cannot be put into its place.
  void check() const;
  /// Those of system/ that are missing, and the marker.
  void write_rest() const;
};

/// What every file of a case begins with.
std::string openfoam_header(const std::string& kind, const std::string& location,
                            const std::string& object);

/// Folders made on the way, removed again, if they are empty, unless they are kept.
class NewFolders {
 public:
  NewFolders() = default;
  ~NewFolders();
  NewFolders(const NewFolders&) = delete;
  NewFolders& operator=(const NewFolders&) = delete;

  /// Throws IoError naming it. Nothing to do where it is already.
  void make(const std::filesystem::path& folder);
  void keep() noexcept { made_.clear(); }

 private:
  std::vector<std::filesystem::path> made_;
};

}  // namespace vdb_offset
