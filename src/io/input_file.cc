#include "io/input_file.h"

#include <cerrno>
#include <cstring>
#include <fstream>
#include <system_error>

#include "vdb_offset/core/error.h"

namespace vdb_offset {

std::string contents_of(const std::filesystem::path& file, std::string_view kind) {
  namespace fs = std::filesystem;
  std::error_code error;
  const fs::file_status status = fs::status(file, error);
  if (status.type() == fs::file_type::not_found) {
    throw IoError(file.string() + ": does not exist; check the path");
  }
  if (fs::is_directory(status)) {
    throw IoError(file.string() + ": is a folder; give " + std::string(kind) + " in it");
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

}  // namespace vdb_offset
