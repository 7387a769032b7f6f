#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace vdb_offset {

class CgnsTree;

/// A node of a CGNS file: name, label and data, which are read when they are asked for, and checked
/// first: nothing that the file says of itself is believed. Throws IoError with the node's path.
/// Not to outlive its tree.
class CgnsNode {
 public:
  const std::string& name() const { return name_; }
  const std::string& label() const { return label_; }

  std::vector<CgnsNode> children() const;
  std::vector<CgnsNode> children(std::string_view label) const;
  /// The first child of a label, and of a name if one is given.
  std::optional<CgnsNode> child(std::string_view label, std::string_view name = {}) const;

  /// Sizes of the data, the fastest index first; none: no data.
  std::vector<std::int64_t> sizes() const;
  std::string text() const;  ///< without blanks at its end; empty: no data
  std::vector<std::int64_t> integers() const;
  std::vector<double> reals() const;
  /// An error about this node: "FILE: BASE/ZONE/NODE: why".
  [[noreturn]] void refuse(const std::string& why) const;

 private:
  friend class CgnsTree;
  CgnsNode(CgnsTree& tree, double id);
  CgnsNode(CgnsTree& tree, double id, const std::string& parent);
  template <typename T>
  std::vector<T> read(std::size_t count) const;
  std::size_t count(std::size_t item_bytes) const;
  std::string type() const;

  CgnsTree* tree_;
  std::shared_ptr<const double> id_;
  std::string path_;
  std::string name_;
  std::string label_;
};

/// An open CGNS file, ADF or HDF5, by the library's lower level: it hands out one node after the
/// other, where the upper level would first read all that the file promises. Holds the library's
/// mutex.
class CgnsTree {
 public:
  /// Throws IoError: no CGNS file, cut short, or of a newer HDF5 than the library reads.
  explicit CgnsTree(const std::filesystem::path& file);
  ~CgnsTree();
  CgnsTree(const CgnsTree&) = delete;
  CgnsTree& operator=(const CgnsTree&) = delete;

  CgnsNode root();
  bool is_hdf5() const { return is_hdf5_; }
  std::string file() const { return file_.string(); }

 private:
  friend class CgnsNode;

  std::unique_lock<std::mutex> lock_;
  std::filesystem::path file_;
  int number_ = -1;
  bool is_hdf5_ = false;
  std::uintmax_t bytes_ = 0;  // of the file, and of those that it links to
};

/// Reads a file in a process of its own, for what that tells of it, or for nothing but to see that
/// it can be read: libcgns and HDF5 follow damaged files out of their memory, assert what files
/// say, or go round in circles. What it throws, and IoError where that process does not end well.
/// Not for the holder of a tree. In such a process itself, just `read`. Cost    that of `read`, and
/// of a process; its memory is free again.
std::string read_apart(const std::filesystem::path& file, const std::function<std::string()>& read);
/// The same; nothing in such a process.
void try_apart(const std::filesystem::path& file, const std::function<void()>& read);

}  // namespace vdb_offset
