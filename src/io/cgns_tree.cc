#include "io/cgns_tree.h"

#include <cgns_io.h>
#include <cgnslib.h>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <fstream>
#include <system_error>

#include "io/apart.h"
#include "io/cgns_output.h"
#include "vdb_offset/core/error.h"

namespace vdb_offset {
namespace {

namespace fs = std::filesystem;

// Labels and names have 32 bytes; the library writes one more, and room is cheap.
constexpr std::size_t kNameBuffer = 256;
// Deflate makes a byte of a thousand at most.
constexpr std::uintmax_t kLargestRatio = 1024;

std::string trimmed(std::string text) {
  text.resize(std::min(text.size(), text.find('\0')));
  const std::size_t last = text.find_last_not_of(" \t\r\n");
  text.resize(last == std::string::npos ? 0 : last + 1);
  return text;
}

std::string library_words() {
  std::array<char, CGIO_MAX_ERROR_LENGTH + 1> words{};
  cgio_error_message(words.data());
  const std::string said = trimmed(words.data());
  return said == "no error" ? "the file is damaged" : said;
}

/// The library takes a file too short for any head for one of the kind that it saw before.
bool is_adf(const fs::path& file, std::uintmax_t bytes) {
  constexpr std::string_view kSignature = "ADF Database Version";
  constexpr std::size_t kMagic = 4;  // bytes before it
  constexpr std::uintmax_t kHead = 186;
  std::array<char, kMagic + kSignature.size()> head{};
  std::ifstream(file, std::ios::binary).read(head.data(), head.size());
  return bytes >= kHead && std::equal(kSignature.begin(), kSignature.end(), head.begin() + kMagic);
}

/// Of an HDF5 file: its format's version, and the length that it says it has.
struct Superblock {
  int version = -1;  // -1: no HDF5 file
  std::uint64_t bytes = 0;
};

Superblock superblock_of(const fs::path& file) {
  constexpr std::string_view kSignature = "\x89HDF\r\n\x1a\n";
  std::array<unsigned char, 48> head{};
  std::ifstream(file, std::ios::binary)
      .read(reinterpret_cast<char*>(head.data()), static_cast<std::streamsize>(head.size()));
  if (!std::equal(kSignature.begin(), kSignature.end(), head.begin(),
                  [](char a, unsigned char b) { return static_cast<unsigned char>(a) == b; })) {
    return {};
  }
  Superblock block{head[8]};
  const std::size_t end_at = block.version < 2 ? 40 : 28;  // of addresses of 8 bytes
  for (std::size_t b = 8; b-- > 0;) block.bytes = block.bytes << 8U | head[end_at + b];
  return block;
}

/// What the library does not say when it cannot open a file.
std::string why_not(const fs::path& file, std::uintmax_t bytes) {
  const Superblock block = superblock_of(file);
  if (block.version < 0 && is_adf(file, bytes)) return "is a damaged ADF file";
  if (block.version < 0) return "is neither HDF5 nor ADF, and so no CGNS file";
  if (block.version <= 3 && block.bytes > bytes) {
    return fmt::format("is cut short: {} of {} bytes", bytes, block.bytes);
  }
  return fmt::format(
      "is an HDF5 file that this libcgns ({:.1f}) cannot open, of format {}: a newer HDF5 wrote "
      "it, or it is damaged; convert it with 'h5repack --low=0 --high=1 FILE NEW' of that HDF5, or "
      "'hdf2adf FILE NEW' of that CGNS",
      CGNS_DOTVERS, block.version);
}

std::uintmax_t size_of(const fs::path& file) {
  std::error_code error;
  const fs::file_status status = fs::status(file, error);
  const std::string name = file.string();
  if (!fs::exists(status)) throw IoError(name + ": does not exist; check the path");
  if (!fs::is_regular_file(status)) throw IoError(name + ": is not a regular file");
  const std::uintmax_t size = fs::file_size(file, error);
  if (error || !std::ifstream(file)) {
    throw IoError(name + ": cannot be opened; check who may read it");
  }
  return size;
}

}  // namespace

/// A process apart has one thread, and that held the mutex when it was made.
CgnsTree::CgnsTree(const fs::path& file)
    : lock_(cgns_mutex(), std::defer_lock), file_(file), bytes_(size_of(file)) {
  if (!is_apart()) lock_.lock();
  const std::string name = file.string();
  const Superblock block = superblock_of(file);
  if (block.version >= 0 && block.version <= 3 && block.bytes > bytes_) {
    throw IoError(name + ": " + why_not(file, bytes_));
  }
  int type = CGIO_FILE_NONE;
  cgio_error_abort(0);
  if (cgio_check_file(name.c_str(), &type) != CGIO_ERR_NONE ||
      (type != CGIO_FILE_HDF5 && !is_adf(file, bytes_)) ||
      cgio_open_file(name.c_str(), CGIO_MODE_READ, CGIO_FILE_NONE, &number_) != CGIO_ERR_NONE) {
    number_ = -1;
    throw IoError(name + ": " + why_not(file, bytes_));
  }
  is_hdf5_ = type == CGIO_FILE_HDF5;
}

CgnsTree::~CgnsTree() {
  if (number_ >= 0) cgio_close_file(number_);
}

CgnsNode CgnsTree::root() {
  double id = 0;
  if (cgio_get_root_id(number_, &id) != CGIO_ERR_NONE) {
    throw IoError(file() + ": has no root: " + library_words());
  }
  return {*this, id};
}

/// The root's number closes the file, and is not to be released before.
CgnsNode::CgnsNode(CgnsTree& tree, double id) : tree_(&tree), id_(new double(id)) {}

CgnsNode::CgnsNode(CgnsTree& tree, double id, const std::string& parent)
    : tree_(&tree), id_(new double(id), [number = tree.number_](const double* held) {
        cgio_release_id(number, *held);
        delete held;
      }) {
  std::array<char, kNameBuffer> name{};
  std::array<char, kNameBuffer> label{};
  path_ = parent;
  int link = 0;
  const bool is_fine = cgio_get_name(tree.number_, id, name.data()) == CGIO_ERR_NONE &&
                       cgio_is_link(tree.number_, id, &link) == CGIO_ERR_NONE &&
                       cgio_get_label(tree.number_, id, label.data()) == CGIO_ERR_NONE;
  name_ = name.data();
  label_ = trimmed(label.data());
  path_ = parent.empty() ? name_ : parent + "/" + name_;
  if (!is_fine) {
    refuse((link > 0 ? "is a link that leads nowhere: " : "cannot be read: ") + library_words());
  }
}

/// Words of a damaged file may be anything; terminals are shown ASCII.
void CgnsNode::refuse(const std::string& why) const {
  std::string words = path_.empty() ? why : path_ + ": " + why;
  std::ranges::replace_if(
      words, [](char c) { return c < ' ' || c > '~'; }, '?');
  throw IoError(tree_->file() + ": " + words);
}

std::vector<CgnsNode> CgnsNode::children() const {
  int count = 0;
  if (cgio_number_children(tree_->number_, *id_, &count) != CGIO_ERR_NONE || count < 0) {
    refuse("its nodes cannot be counted: " + library_words());
  }
  if (static_cast<std::uintmax_t>(count) > tree_->bytes_) {
    refuse(fmt::format("says that it has {} nodes, in a file of {} bytes", count, tree_->bytes_));
  }
  std::vector<CgnsNode> nodes;
  for (int n = 1; n <= count; ++n) {
    double id = 0;
    int found = 0;
    if (cgio_children_ids(tree_->number_, *id_, n, 1, &found, &id) != CGIO_ERR_NONE || found != 1) {
      refuse(fmt::format("its node {} of {} cannot be read: {}", n, count, library_words()));
    }
    nodes.push_back(CgnsNode(*tree_, id, path_));
  }
  return nodes;
}

std::vector<CgnsNode> CgnsNode::children(std::string_view label) const {
  std::vector<CgnsNode> nodes = children();
  std::erase_if(nodes, [&](const CgnsNode& node) { return node.label() != label; });
  return nodes;
}

std::optional<CgnsNode> CgnsNode::child(std::string_view label, std::string_view name) const {
  for (CgnsNode& node : children(label)) {
    if (name.empty() || node.name() == name) return std::move(node);
  }
  return std::nullopt;
}

std::vector<std::int64_t> CgnsNode::sizes() const {
  std::array<cgsize_t, CGIO_MAX_DIMENSIONS> sizes{};
  int count = 0;
  if (cgio_get_dimensions(tree_->number_, *id_, &count, sizes.data()) != CGIO_ERR_NONE ||
      count < 0 || count > CGIO_MAX_DIMENSIONS) {
    refuse("its sizes cannot be read: " + library_words());
  }
  return {sizes.begin(), sizes.begin() + count};
}

std::string CgnsNode::type() const {
  std::array<char, kNameBuffer> type{};
  if (cgio_get_data_type(tree_->number_, *id_, type.data()) != CGIO_ERR_NONE) {
    refuse("its type cannot be read: " + library_words());
  }
  return type.data();
}

/// Items of data; checked against the file's length before anybody makes room for them.
std::size_t CgnsNode::count(std::size_t item_bytes) const {
  const std::uintmax_t most =
      tree_->bytes_ / item_bytes * (tree_->is_hdf5_ ? kLargestRatio : 1) + kNameBuffer;
  const std::vector<std::int64_t> all = sizes();
  std::uintmax_t count = all.empty() ? 0 : 1;
  for (const std::int64_t size : all) {
    if (size < 0) refuse(fmt::format("has a size of {}", size));
    const auto factor = static_cast<std::uintmax_t>(size);
    if (factor > 0 && count > most / factor) {
      refuse(fmt::format("says that it has more data than its file of {} bytes holds: {}",
                         tree_->bytes_, fmt::join(all, " x ")));
    }
    count *= factor;
  }
  return count;
}

template <typename T>
std::vector<T> CgnsNode::read(std::size_t count) const {
  std::vector<T> values(count);
  if (count == 0) return values;
  if (cgio_read_all_data(tree_->number_, *id_, values.data()) != CGIO_ERR_NONE) {
    refuse("its data cannot be read: " + library_words());
  }
  return values;
}

std::string CgnsNode::text() const {
  if (type() == "MT") return {};
  if (type() != "C1") refuse("is of type " + type() + ", not text");
  const std::vector<char> values = read<char>(count(1));
  return trimmed({values.begin(), values.end()});
}

std::vector<std::int64_t> CgnsNode::integers() const {
  if (type() == "I8") return read<std::int64_t>(count(8));
  if (type() != "I4") refuse("is of type " + type() + ", not whole numbers (I4, I8)");
  const std::vector<std::int32_t> values = read<std::int32_t>(count(4));
  return {values.begin(), values.end()};
}

std::vector<double> CgnsNode::reals() const {
  if (type() == "R8") return read<double>(count(8));
  if (type() != "R4") refuse("is of type " + type() + ", not real numbers (R4, R8)");
  const std::vector<float> values = read<float>(count(4));
  return {values.begin(), values.end()};
}

#ifdef VDB_OFFSET_FUZZ
// Coverage is that of one process.
std::string read_apart(const fs::path&, const std::function<std::string()>& read) { return read(); }
void try_apart(const fs::path&, const std::function<void()>&) {}
#else
std::string read_apart(const fs::path& file, const std::function<std::string()>& read) {
  if (is_apart()) return read();
  constexpr std::uintmax_t kBytesPerSecond = 1 << 20U;
  constexpr std::uintmax_t kMost = 100000;
  const auto seconds = static_cast<unsigned>(60 + std::min(size_of(file) / kBytesPerSecond, kMost));
  const std::lock_guard lock(cgns_mutex());
  return run_apart(read, {file.string(), "libcgns", "write it again", seconds});
}

void try_apart(const fs::path& file, const std::function<void()>& read) {
  if (is_apart()) return;
  read_apart(file, [&] {
    read();
    return std::string();
  });
}
#endif

}  // namespace vdb_offset
