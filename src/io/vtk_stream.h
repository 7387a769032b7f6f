#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace vdb_offset {

/// Bytes of VTK's binary data one after another, as they are or in base64, of which each part may
/// be padded by itself.
class VtkStream {
 public:
  VtkStream(std::string_view text, bool is_raw) : text_(text), is_raw_(is_raw) {}

  /// The next `count` bytes; fewer where it ends before. Valid until the next call.
  std::string_view take(std::size_t count);

 private:
  bool decode_group();

  std::string_view text_;
  bool is_raw_;
  std::string ready_;      ///< decoded
  std::size_t given_ = 0;  ///< of those
};

}  // namespace vdb_offset
