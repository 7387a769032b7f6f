#pragma once

#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

namespace vdb_offset {

/// A file that appears whole or not at all: written beside its place under a temporary name,
/// renamed by `commit`, removed by the destructor otherwise.
class OutputFile {
 public:
  /// Opens `<file>.part-<pid>`. Throws IoError naming the file when it cannot be created.
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
  std::filesystem::path part_;
  std::ofstream stream_;
  bool committed_ = false;
};

/// A folder of pieces `<prefix><anything><suffix>` that is replaced as a whole: filled beside its
/// place under a temporary name, swapped in by `swap_in`, the old one deleted by `commit`.
/// Without `commit` the destructor puts everything back as it was.
class OutputFolder {
 public:
  /// Makes `<folder>.part-<pid>`. Throws IoError when it cannot be made, or when `folder` exists
  /// and holds anything but such pieces: it is somebody else's then.
  OutputFolder(std::filesystem::path folder, std::string prefix, std::string suffix);
  ~OutputFolder();
  OutputFolder(const OutputFolder&) = delete;
  OutputFolder& operator=(const OutputFolder&) = delete;

  /// Where a piece is to be written until `swap_in`.
  std::filesystem::path piece(const std::string& middle) const {
    return part_ / (prefix_ + middle + suffix_);
  }
  /// Put the new folder in place of the old one, which stays beside it until `commit`.
  void swap_in();
  /// Keep the new folder. Does not throw.
  void commit() noexcept;

 private:
  void check_ours() const;
  bool is_piece(const std::filesystem::path& file) const;
  void remove_pieces(const std::filesystem::path& folder) const noexcept;

  std::filesystem::path folder_;
  std::filesystem::path part_;
  std::filesystem::path old_;
  std::string prefix_;
  std::string suffix_;
  bool swapped_ = false;
  bool committed_ = false;
};

}  // namespace vdb_offset
