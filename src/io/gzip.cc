#include "io/gzip.h"

#include <fmt/format.h>
#include <zlib.h>

#include <algorithm>
#include <cstdint>
#include <limits>
#include <vector>

#include "vdb_offset/core/error.h"

namespace vdb_offset {
namespace {

/// zlib's state, let go of in the end.
class Inflater {
 public:
  explicit Inflater(std::string_view bytes) : bytes_(bytes) {
    constexpr int kGzipAlone = 16 + MAX_WBITS;
    if (inflateInit2(&stream_, kGzipAlone) != Z_OK) throw LimitError("no memory for unpacking");
  }
  ~Inflater() { inflateEnd(&stream_); }
  Inflater(const Inflater&) = delete;
  Inflater& operator=(const Inflater&) = delete;

  /// Fills `piece`, and says how much of it; the return value is zlib's.
  int next(std::vector<char>& piece, std::size_t& length) {
    feed();
    stream_.next_out = reinterpret_cast<Bytef*>(piece.data());
    stream_.avail_out = static_cast<uInt>(piece.size());
    const int result = inflate(&stream_, Z_NO_FLUSH);
    length = piece.size() - stream_.avail_out;
    return result;
  }
  /// On to another member; false where nothing but zeros follow.
  bool next_member() {
    const std::size_t more = bytes_.find_first_not_of('\0', at());
    if (more == std::string_view::npos) return false;
    inflateReset(&stream_);
    return true;
  }
  std::size_t at() const { return fed_ - stream_.avail_in; }
  bool exhausted() const { return at() == bytes_.size(); }

 private:
  void feed() {
    if (stream_.avail_in > 0) return;
    constexpr std::size_t kMost = std::numeric_limits<uInt>::max() / 2;
    const std::size_t length = std::min(kMost, bytes_.size() - fed_);
    // zlib only reads there, but its interface is older than const.
    stream_.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(bytes_.data() + fed_));
    stream_.avail_in = static_cast<uInt>(length);
    fed_ += length;
  }

  std::string_view bytes_;
  std::size_t fed_ = 0;
  z_stream stream_{};
};

IoError damaged(const std::string& name, std::size_t byte, std::string_view what) {
  return IoError(fmt::format("{}, byte {}: {}; pack the file again", name, byte, what),
                 {static_cast<std::int64_t>(byte)});
}

}  // namespace

bool is_gzip(std::string_view bytes) { return bytes.substr(0, 2) == "\x1f\x8b"; }

std::string unpacked(std::string_view bytes, const std::string& name, std::size_t limit) {
  Inflater inflater(bytes);
  std::string out;
  std::vector<char> piece(std::size_t{1} << 18);
  while (true) {
    std::size_t length = 0;
    const int result = inflater.next(piece, length);
    if (length > limit - out.size()) {
      throw LimitError(
          fmt::format("{}: unpacks to more than {} bytes, {} times its length; unpack "
                      "it with gunzip, if it is a surface",
                      name, limit, limit / std::max<std::size_t>(bytes.size(), 1)));
    }
    out.append(piece.data(), length);
    if (result == Z_STREAM_END) {
      if (!inflater.next_member()) return out;
    } else if (result != Z_OK && result != Z_BUF_ERROR) {
      throw damaged(name, inflater.at(), "what gzip packed is damaged");
    } else if (length == 0 && inflater.exhausted()) {
      throw damaged(name, inflater.at(), "what gzip packed ends too early");
    }
  }
}

}  // namespace vdb_offset
