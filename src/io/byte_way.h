#pragma once

#include <cstddef>
#include <cstring>
#include <string>
#include <type_traits>
#include <vector>

namespace vdb_offset {

/// Puts values behind one another, for another process of this machine; ByteReader takes them from
/// there in the same order, so that one list of values serves both ways.
class ByteWriter {
 public:
  std::string bytes;

  template <typename T>
  void operator()(const T& value) {
    static_assert(std::is_trivially_copyable_v<T>);
    bytes.append(reinterpret_cast<const char*>(&value), sizeof value);
  }
  void operator()(const std::string& text) {
    (*this)(text.size());
    bytes += text;
  }
  template <typename T>
  void list(const std::vector<T>& values) {
    (*this)(values.size());
    bytes.append(reinterpret_cast<const char*>(values.data()), values.size() * sizeof(T));
  }
  /// `pass(way, item)` for each.
  template <typename T, typename Pass>
  void each(const std::vector<T>& items, const Pass& pass) {
    (*this)(items.size());
    for (const T& item : items) pass(*this, item);
  }
};

class ByteReader {
 public:
  explicit ByteReader(const std::string& bytes) : at_(bytes.data()) {}

  template <typename T>
  void operator()(T& value) {
    take(&value, sizeof value);
  }
  void operator()(std::string& text) {
    text.resize(size());
    take(text.data(), text.size());
  }
  template <typename T>
  void list(std::vector<T>& values) {
    values.resize(size());
    take(values.data(), values.size() * sizeof(T));
  }
  template <typename T, typename Pass>
  void each(std::vector<T>& items, const Pass& pass) {
    items.resize(size());
    for (T& item : items) pass(*this, item);
  }

 private:
  std::size_t size() {
    std::size_t size = 0;
    (*this)(size);
    return size;
  }
  void take(void* to, std::size_t size) {
    if (size > 0) std::memcpy(to, at_, size);
    at_ += size;
  }
  const char* at_;
};

}  // namespace vdb_offset
