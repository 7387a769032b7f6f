#include "io/output_file.h"

#include <unistd.h>

#include <exception>
#include <system_error>
#include <utility>
#include <vector>

#include "vdb_offset/core/error.h"

namespace vdb_offset {

namespace fs = std::filesystem;

OutputFile::OutputFile(fs::path file)
    : file_(std::move(file)), part_(file_.string() + ".part-" + std::to_string(::getpid())) {
  std::error_code error;
  if (fs::is_directory(file_, error)) {
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
  fs::remove(part_, ignored);
}

void OutputFile::commit() {
  stream_.close();
  if (!stream_) throw IoError(file_.string() + ": writing failed (is the disk full?)");
  std::error_code error;
  fs::rename(part_, file_, error);
  if (error) {
    throw IoError(file_.string() + ": cannot be put in place: " + error.message());
  }
  committed_ = true;
}

OutputFolder::OutputFolder(fs::path folder, std::string prefix, std::string suffix)
    : folder_(std::move(folder)),
      part_(folder_.string() + ".part-" + std::to_string(::getpid())),
      old_(folder_.string() + ".old-" + std::to_string(::getpid())),
      prefix_(std::move(prefix)),
      suffix_(std::move(suffix)) {
  check_ours();
  std::error_code error;
  // A folder that is there already belongs to another run of ours or to somebody else.
  if (!fs::create_directory(part_, error)) {
    throw IoError(folder_.string() + ": cannot be created" +
                  (error ? ": " + error.message() : "; remove " + part_.string()));
  }
}

OutputFolder::~OutputFolder() {
  if (committed_) return;
  std::error_code ignored;
  if (swapped_) {
    fs::rename(folder_, part_, ignored);
    if (fs::exists(old_, ignored)) fs::rename(old_, folder_, ignored);
  }
  remove_pieces(part_);
}

void OutputFolder::swap_in() {
  check_ours();
  std::error_code error;
  const bool replaces = fs::exists(folder_, error);
  if (replaces && !error) fs::rename(folder_, old_, error);
  if (!error) {
    fs::rename(part_, folder_, error);
    std::error_code ignored;
    if (error && replaces) fs::rename(old_, folder_, ignored);
  }
  if (error) throw IoError(folder_.string() + ": cannot be put in place: " + error.message());
  swapped_ = true;
}

void OutputFolder::commit() noexcept {
  committed_ = true;
  remove_pieces(old_);
}

void OutputFolder::check_ours() const {
  std::error_code error;
  const fs::file_status status = fs::symlink_status(folder_, error);
  if (!fs::exists(status)) return;
  if (!fs::is_directory(status)) {
    throw IoError(folder_.string() + ": is in the way of a folder; move it or choose another name");
  }
  fs::directory_iterator entry(folder_, error);
  for (; !error && entry != fs::directory_iterator(); entry.increment(error)) {
    if (is_piece(entry->path())) continue;
    throw IoError(folder_.string() + ": would be replaced, but holds " +
                  entry->path().filename().string() + ", which is not a piece (" + prefix_ + "*" +
                  suffix_ + "); move it or choose another name");
  }
  if (error) throw IoError(folder_.string() + ": cannot be read: " + error.message());
}

bool OutputFolder::is_piece(const fs::path& file) const {
  const std::string name = file.filename().string();
  std::error_code error;
  return fs::is_regular_file(fs::symlink_status(file, error)) &&
         name.size() > prefix_.size() + suffix_.size() && name.starts_with(prefix_) &&
         name.ends_with(suffix_);
}

/// File by file, not the whole tree, so that whatever else came into the folder meanwhile survives.
void OutputFolder::remove_pieces(const fs::path& folder) const noexcept {
  try {
    std::vector<fs::path> pieces;
    for (const fs::directory_entry& entry : fs::directory_iterator(folder)) {
      if (is_piece(entry.path())) pieces.push_back(entry.path());
    }
    for (const fs::path& piece : pieces) fs::remove(piece);
    fs::remove(folder);
  } catch (const std::exception&) {
    return;  // what cannot be deleted stays beside the result, under its temporary name
  }
}

}  // namespace vdb_offset
