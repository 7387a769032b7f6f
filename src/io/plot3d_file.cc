#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <string>
#include <system_error>

#include "io/plot3d_parse.h"
#include "vdb_offset/core/error.h"

namespace vdb_offset {
namespace {

/// The whole file: parsing goes back and forth, and the text of a surface fits in memory.
std::string contents_of(const std::filesystem::path& file) {
  namespace fs = std::filesystem;
  std::error_code error;
  const fs::file_status status = fs::status(file, error);
  if (status.type() == fs::file_type::not_found) {
    throw IoError(file.string() + ": does not exist; check the path");
  }
  if (fs::is_directory(status)) {
    throw IoError(file.string() + ": is a folder; give a PLOT3D file in it");
  }
  if (!fs::is_regular_file(status)) {
    throw IoError(file.string() + ": is not a regular file; copy its contents to one first");
  }
  const std::uintmax_t size = fs::file_size(file, error);
  errno = 0;
  std::ifstream stream(file, std::ios::binary);
  if (error || !stream) {
    const std::string why = errno != 0 ? std::strerror(errno) : error.message();
    throw IoError(file.string() + ": cannot be opened (" + why + "); check who may read it");
  }
  std::string bytes(size, '\0');
  stream.read(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  if (stream.gcount() != static_cast<std::streamsize>(bytes.size())) {
    throw IoError(file.string() + ": ended at byte " + std::to_string(stream.gcount()) + " of " +
                  std::to_string(size) + "; was it written to meanwhile?");
  }
  return bytes;
}

}  // namespace

Plot3dInfo inspect_plot3d(const std::filesystem::path& file, const Plot3dHint& hint) {
  return inspect_plot3d_bytes(contents_of(file), file.string(), hint);
}

Patches read_plot3d(const std::filesystem::path& file, const Plot3dHint& hint) {
  return read_plot3d_bytes(contents_of(file), file.string(), hint);
}

}  // namespace vdb_offset
