#pragma once

#include <filesystem>
#include <fstream>

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

}  // namespace vdb_offset
