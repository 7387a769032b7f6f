#include "io/output_file.h"

#include <unistd.h>

#include <algorithm>
#include <exception>
#include <system_error>
#include <utility>
#include <vector>

#include "vdb_offset/core/error.h"
#include "vdb_offset/io/output.h"

namespace vdb_offset {

namespace fs = std::filesystem;

namespace {

/// Follows links whose end does not exist; loops never come here, the system refuses them before.
fs::path end_of_links(fs::path file) {
  std::error_code error;
  while (fs::is_symlink(fs::symlink_status(file, error))) {
    const fs::path target = fs::read_symlink(file, error);
    if (error) break;
    file = file.parent_path() / target;
  }
  return file;
}

std::string kind_in_words(fs::file_type type) {
  switch (type) {
    case fs::file_type::directory:
      return "a folder";
    case fs::file_type::fifo:
      return "a FIFO";
    case fs::file_type::socket:
      return "a socket";
    case fs::file_type::character:
    case fs::file_type::block:
      return "a device";
    default:
      return "not a regular file";
  }
}

void check_folder(const std::string& name, const fs::path& place) {
  std::error_code ignored;
  const fs::path folder = place.has_parent_path() ? place.parent_path() : fs::path(".");
  if (!fs::is_directory(folder, ignored)) {
    throw IoError(name + ": there is no folder '" + folder.string() + "'; make it first");
  }
  if (::access(folder.c_str(), W_OK | X_OK) != 0) {
    throw IoError(name + ": the folder '" + folder.string() + "' may not be written");
  }
}

}  // namespace

fs::path output_place(const fs::path& file) {
  std::error_code error;
  const fs::file_type type = fs::status(file, error).type();
  if (type == fs::file_type::none) {
    throw IoError(file.string() + ": cannot be looked at: " + error.message());
  }
  const bool missing = type == fs::file_type::not_found;
  if (!missing && type != fs::file_type::regular) {
    throw IoError(file.string() + ": is " + kind_in_words(type) +
                  ", and would be replaced; give the name of a regular file or of a new one");
  }
  fs::path place = file;
  std::error_code unknown;
  if (fs::is_symlink(fs::symlink_status(file, unknown))) {
    place = missing ? end_of_links(file) : fs::canonical(file, error);
  }
  const std::string name =
      place == file ? file.string() : file.string() + " (a link to " + place.string() + ")";
  check_folder(name, place);
  return place;
}

OutputFile::OutputFile(fs::path file)
    : file_(std::move(file)),
      place_(output_place(file_)),
      part_(place_.string() + ".part-" + std::to_string(::getpid())) {
  std::error_code error;
  const fs::file_status status = fs::status(place_, error);
  stream_.open(part_, std::ios::binary | std::ios::trunc);
  if (!stream_) {
    throw IoError(file_.string() +
                  ": cannot be created; check that its folder exists and may be written");
  }
  if (!fs::is_regular_file(status)) return;
  replaced_ = status.permissions() & fs::perms::all;
  // From the start: what nobody else may read is not laid open while it is written.
  fs::permissions(part_, *replaced_ | fs::perms::owner_write, error);
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
  if (replaced_) fs::permissions(part_, *replaced_, error);
  fs::rename(part_, place_, error);
  if (error) {
    throw IoError(file_.string() + ": cannot be put in place: " + error.message());
  }
  committed_ = true;
}

void Pieces::check_ours() const {
  std::error_code error;
  const fs::file_status status = fs::symlink_status(folder, error);
  if (!fs::exists(status)) return;
  if (!fs::is_directory(status)) {
    throw IoError(folder.string() + ": is in the way of a folder; move it or choose another name");
  }
  fs::directory_iterator entry(folder, error);
  for (; !error && entry != fs::directory_iterator(); entry.increment(error)) {
    if (is_piece(entry->path()) || is_leftover(entry->path())) continue;
    throw IoError(folder.string() + ": would be replaced, but holds " +
                  entry->path().filename().string() + ", which is not a piece (" +
                  (names.empty() ? prefix + "*" + suffix : names.front() + " ...") +
                  "); move it or choose another name");
  }
  if (error) throw IoError(folder.string() + ": cannot be read: " + error.message());
}

bool Pieces::is_piece(const fs::path& file) const {
  const std::string name = file.filename().string();
  std::error_code error;
  if (!fs::is_regular_file(fs::symlink_status(file, error))) return false;
  if (!names.empty()) return std::ranges::count(names, name) > 0;
  return name.size() > prefix.size() + suffix.size() && name.starts_with(prefix) &&
         name.ends_with(suffix);
}

bool Pieces::is_leftover_name(const std::string& name) const {
  const std::string stem = name.substr(0, name.find_last_not_of("0123456789") + 1);
  return std::ranges::any_of(leftover_names, [&](const std::string& known) {
    return known == name || (stem.size() < name.size() && known == stem + "#");
  });
}

bool Pieces::is_leftover(const fs::path& entry) const {
  std::error_code error;
  const bool is_named = !leftovers.empty() && entry.filename() == leftovers;
  if (!is_named || !fs::is_directory(fs::symlink_status(entry, error))) return false;
  fs::directory_iterator inner(entry, error);
  for (; !error && inner != fs::directory_iterator(); inner.increment(error)) {
    const bool is_file = fs::is_regular_file(fs::symlink_status(inner->path(), error));
    const std::string name = inner->path().filename().string();
    if (error || !is_file || !is_leftover_name(name)) return false;
  }
  return !error;
}

OutputFolder::OutputFolder(Pieces pieces)
    : pieces_(std::move(pieces)),
      part_(pieces_.folder.string() + ".part-" + std::to_string(::getpid())),
      old_(pieces_.folder.string() + ".old-" + std::to_string(::getpid())) {
  pieces_.check_ours();
  std::error_code error;
  // A folder that is there already belongs to another run of ours or to somebody else.
  if (!fs::create_directory(part_, error)) {
    throw IoError(pieces_.folder.string() + ": cannot be created" +
                  (error ? ": " + error.message() : "; remove " + part_.string()));
  }
}

OutputFolder::~OutputFolder() {
  if (committed_) return;
  std::error_code ignored;
  if (swapped_) {
    fs::rename(pieces_.folder, part_, ignored);
    if (fs::exists(old_, ignored)) fs::rename(old_, pieces_.folder, ignored);
  }
  remove_pieces(part_);
}

void OutputFolder::swap_in() {
  pieces_.check_ours();
  std::error_code error;
  const bool replaces = fs::exists(pieces_.folder, error);
  if (replaces && !error) fs::rename(pieces_.folder, old_, error);
  if (!error) {
    fs::rename(part_, pieces_.folder, error);
    std::error_code ignored;
    if (error && replaces) fs::rename(old_, pieces_.folder, ignored);
  }
  if (error)
    throw IoError(pieces_.folder.string() + ": cannot be put in place: " + error.message());
  swapped_ = true;
}

void OutputFolder::commit() noexcept {
  committed_ = true;
  remove_pieces(old_);
}

/// File by file, not the whole tree, so that whatever else came into the folder meanwhile survives.
void OutputFolder::remove_pieces(const fs::path& folder) const noexcept {
  try {
    std::vector<fs::path> pieces;
    for (const fs::directory_entry& entry : fs::directory_iterator(folder)) {
      if (pieces_.is_piece(entry.path())) pieces.push_back(entry.path());
      if (!pieces_.is_leftover(entry.path())) continue;
      for (const fs::directory_entry& inner : fs::directory_iterator(entry.path())) {
        pieces.push_back(inner.path());
      }
      pieces.push_back(entry.path());
    }
    for (const fs::path& piece : pieces) fs::remove(piece);
    fs::remove(folder);
  } catch (const std::exception&) {
    return;  // what cannot be deleted stays beside the result, under its temporary name
  }
}

}  // namespace vdb_offset
