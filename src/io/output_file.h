#pragma once

#include <filesystem>
#include <fstream>
#include <optional>
#include <string>
#include <vector>

namespace vdb_offset {

/// A file that appears whole or not at all: written beside its place (`output_place`) under a
/// temporary name, renamed by `commit`, removed by the destructor otherwise. It takes over the
/// permissions of a file that it replaces.
class OutputFile {
 public:
  /// Opens `<place>.part-<pid>`. Throws IoError naming the file when it cannot be created.
  explicit OutputFile(std::filesystem::path file);
  ~OutputFile();
  OutputFile(const OutputFile&) = delete;
  OutputFile& operator=(const OutputFile&) = delete;

  std::ostream& stream() { return stream_; }
  const std::filesystem::path& part() const { return part_; }
  /// Flush, check that every write succeeded, rename into place. Throws IoError ("disk full?").
  void commit();

 private:
  std::filesystem::path file_;
  std::filesystem::path place_;
  std::filesystem::path part_;
  std::optional<std::filesystem::perms> replaced_;  // permissions of the file in the place
  std::ofstream stream_;
  bool committed_ = false;
};

/// Files `<prefix><anything><suffix>` of one folder, or those that are named.
struct Pieces {
  std::filesystem::path folder;
  std::string prefix = {};
  std::string suffix = {};
  std::vector<std::string> names = {};  ///< if there are any, they alone are pieces
  /// A folder in it that other programs leave, and the files that they leave there: it goes with
  /// the pieces, unless anything else is in it.
  std::string leftovers = {};
  std::vector<std::string> leftover_names = {};  ///< '#' at the end: any number

  /// Throws IoError if something is in the folder's place that is not a folder of such pieces.
  void check_ours() const;
  bool is_piece(const std::filesystem::path& file) const;
  bool is_leftover(const std::filesystem::path& entry) const;
  bool is_leftover_name(const std::string& name) const;
};

/// A folder of pieces that is replaced as a whole: filled beside its
/// place under a temporary name, swapped in by `swap_in`, the old one deleted by `commit`.
/// Without `commit` the destructor puts everything back as it was.
class OutputFolder {
 public:
  /// Makes `<folder>.part-<pid>`. Throws IoError when it cannot be made, or when `folder` exists
  /// and holds anything but such pieces: it is somebody else's then.
  explicit OutputFolder(Pieces pieces);
  ~OutputFolder();
  OutputFolder(const OutputFolder&) = delete;
  OutputFolder& operator=(const OutputFolder&) = delete;

  /// Where a piece is to be written until `swap_in`.
  std::filesystem::path piece(const std::string& middle) const {
    return part_ / (pieces_.prefix + middle + pieces_.suffix);
  }
  /// Put the new folder in place of the old one, which stays beside it until `commit`.
  void swap_in();
  /// Keep the new folder. Does not throw.
  void commit() noexcept;

 private:
  void remove_pieces(const std::filesystem::path& folder) const noexcept;

  Pieces pieces_;
  std::filesystem::path part_;
  std::filesystem::path old_;
  bool swapped_ = false;
  bool committed_ = false;
};

}  // namespace vdb_offset
