// The unformatted kinds of PLOT3D: 32-bit integers and IEEE reals, either in Fortran records (the
// length in 4 bytes before and after each) or as a plain stream.

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cstring>
#include <limits>
#include <type_traits>

#include "io/plot3d_cursor.h"

namespace vdb_offset {
namespace {

constexpr std::size_t kMark = 4;
constexpr std::uint64_t kLongestRecord = std::numeric_limits<std::int32_t>::max();

template <typename T>
T load(const char* from, bool swap) {
  std::conditional_t<sizeof(T) == 8, std::uint64_t, std::uint32_t> word;
  std::memcpy(&word, from, sizeof word);
  if (swap) {
    if constexpr (sizeof(T) == 8) {
      word = __builtin_bswap64(word);
    } else {
      word = __builtin_bswap32(word);
    }
  }
  return std::bit_cast<T>(word);
}

}  // namespace

void Plot3dBinaryCursor::set_dialect(const Plot3dDialect& dialect) {
  dialect_ = dialect;
  swap_ = dialect.big_endian != (std::endian::native == std::endian::big);
}

template <typename T>
T Plot3dBinaryCursor::take() {
  if (bytes_.size() - next_ < sizeof(T)) {
    throw Plot3dMismatch{fmt::format("the file ends at byte {}, inside its header", bytes_.size()),
                         bytes_.size(), Plot3dMismatch::kBadCount};
  }
  last_ = next_;
  next_ += sizeof(T);
  return load<T>(bytes_.data() + last_, swap_);
}

std::int64_t Plot3dBinaryCursor::whole() { return take<std::int32_t>(); }

double Plot3dBinaryCursor::coordinate() {
  return dialect_.double_precision ? take<double>() : static_cast<double>(take<float>());
}

std::string Plot3dBinaryCursor::position() const { return fmt::format("byte {}", last_); }

void Plot3dBinaryCursor::check_mark(std::size_t at, std::uint64_t bytes) const {
  const auto mark = load<std::uint32_t>(bytes_.data() + at, swap_);
  if (mark == bytes) return;
  throw Plot3dMismatch{
      fmt::format("the record mark at byte {} is {}, and its sizes need {}", at, mark, bytes), at,
      at == 0 ? Plot3dMismatch::kBadMark : Plot3dMismatch::kBadData};
}

void Plot3dBinaryCursor::open_record(std::uint64_t bytes) {
  if (!dialect_.records) return;
  const std::size_t at = next_;
  take<std::uint32_t>();
  check_mark(at, bytes);
  if (bytes_.size() - next_ < bytes + kMark) return;  // reading will find the end
  check_mark(next_ + bytes, bytes);
  ++records_found_;
}

void Plot3dBinaryCursor::close_record(std::uint64_t) {
  if (dialect_.records) take<std::uint32_t>();
}

void Plot3dBinaryCursor::check_length(const std::vector<Plot3dBlockSize>& blocks) const {
  const std::uint64_t have = bytes_.size();
  std::uint64_t need = next_;
  std::uint64_t points = 0;
  for (const Plot3dBlockSize& size : blocks) {
    const std::uint64_t record = plot3d_record_bytes(dialect_, size);
    points += plot3d_points(size);
    if (!dialect_.records) {
      need += record;
      continue;
    }
    if (record > kLongestRecord) {
      throw Plot3dMismatch{
          fmt::format("a block's record of {} bytes is longer than a record mark can say", record),
          static_cast<std::size_t>(need), Plot3dMismatch::kTooBig};
    }
    // Marks that the file is too short to hold are left to the comparison of lengths.
    if (need + kMark <= have) check_mark(need, record);
    need += kMark + record;
    if (need + kMark <= have) check_mark(need, record);
    need += kMark;
  }
  if (need == have) return;
  throw Plot3dMismatch{
      fmt::format("its sizes (blocks: {}, points: {}) need {} bytes, and the file has {}",
                  blocks.size(), points, need, have),
      static_cast<std::size_t>(std::min(need, have)), plot3d_length_distance(have, need)};
}

}  // namespace vdb_offset
