#include "io/output_file.h"

#include <unistd.h>

#include <system_error>
#include <utility>

#include "vdb_offset/core/error.h"

namespace vdb_offset {

OutputFile::OutputFile(std::filesystem::path file)
    : file_(std::move(file)), part_(file_.string() + ".part-" + std::to_string(::getpid())) {
  if (std::filesystem::is_directory(file_)) {
    throw IoError(file_.string() + ": is a folder; give a file name");
  }
  stream_.open(part_, std::ios::binary | std::ios::trunc);
  if (!stream_) {
    throw IoError(file_.string() +
                  ": cannot be created; check that its folder exists and may be written");
  }
}

OutputFile::~OutputFile() {
  if (committed_) return;
  stream_.close();
  std::error_code ignored;
  std::filesystem::remove(part_, ignored);
}

void OutputFile::commit() {
  stream_.close();
  if (!stream_) throw IoError(file_.string() + ": writing failed (is the disk full?)");
  std::error_code error;
  std::filesystem::rename(part_, file_, error);
  if (error) {
    throw IoError(file_.string() + ": cannot be put in place: " + error.message());
  }
  committed_ = true;
}

}  // namespace vdb_offset
