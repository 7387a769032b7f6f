#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "vdb_offset/io/plot3d.h"

/// The two ways to walk over the numbers of a PLOT3D file in memory. Both classes have the same
/// members, so that detection and reading are written once (plot3d_detect.cc, plot3d_read.cc).

namespace vdb_offset {

/// Why the bytes do not fit a dialect. Thrown inside the reader only; it becomes an IoError there.
struct Plot3dMismatch {
  /// How far from fitting: below 1 all is sound but the length, which differs by that part.
  static constexpr double kTooBig = 1, kBadData = 2, kBadSize = 3, kBadCount = 4, kBadMark = 5;

  std::string what;      ///< "the file has 10 bytes, but ..."
  std::size_t byte = 0;  ///< where
  double distance = kBadMark;
};

/// Numbers as text: blanks, line ends and single commas separate; `3*0.5` repeats; 1.0D-3 is 1e-3.
class Plot3dTextCursor {
 public:
  static constexpr bool kFormatted = true;

  /// Counts the numbers, once. `bytes` must outlive the cursor.
  explicit Plot3dTextCursor(std::string_view bytes);

  void set_dialect(const Plot3dDialect& dialect);
  void open_record(std::uint64_t) {}
  void close_record(std::uint64_t) {}
  /// The next number, which must be whole. Throws Plot3dMismatch, as the next.
  std::int64_t whole();
  double coordinate();
  /// Whether the number just read was written without point and exponent.
  bool whole_literal() const;
  /// "token 17 (byte 230)": the number just read.
  std::string position() const;
  std::size_t byte() const { return static_cast<std::size_t>(token_.data() - bytes_.data()); }
  /// Bytes in all; a block and a point take one at least.
  std::uint64_t size() const { return bytes_.size(); }
  /// Records of the header whose marks fit: evidence for the dialect.
  int records_found() const { return 0; }
  /// Throws unless `blocks` take up all numbers; to be called right after the header.
  void check_length(const std::vector<Plot3dBlockSize>& blocks) const;
  /// Points at the first token that is no number, which may be why nothing fits; else empty.
  std::string remark() const;

 private:
  bool next_token();
  void advance();
  [[noreturn]] void refuse(std::string_view rule) const;

  std::string_view bytes_;
  Plot3dDialect dialect_;
  std::uint64_t count_ = 0;   ///< numbers in the file, repeats expanded
  std::uint64_t taken_ = 0;   ///< numbers read, repeats expanded
  std::size_t end_ = 0;       ///< where the next token may begin
  bool after_value_ = false;  ///< a comma here ends the last token; else it encloses nothing
  std::string_view token_;    ///< without its repeat count
  std::uint64_t tokens_ = 0;  ///< tokens read
  std::uint64_t repeat_ = 0;  ///< how often `token_` is still to be given
};

/// Numbers as bytes, in Fortran records or without.
class Plot3dBinaryCursor {
 public:
  static constexpr bool kFormatted = false;

  explicit Plot3dBinaryCursor(std::string_view bytes) : bytes_(bytes) {}

  void set_dialect(const Plot3dDialect& dialect);
  /// Steps over the mark in front, which must say `bytes`, as the one behind; nothing in a C
  /// stream. Throws Plot3dMismatch.
  void open_record(std::uint64_t bytes);
  void close_record(std::uint64_t bytes);
  std::int64_t whole();
  double coordinate();
  bool whole_literal() const { return false; }
  std::string position() const;
  std::size_t byte() const { return last_; }
  std::uint64_t size() const { return bytes_.size(); }
  int records_found() const { return records_found_; }
  void check_length(const std::vector<Plot3dBlockSize>& blocks) const;
  std::string remark() const { return {}; }

 private:
  template <typename T>
  T take();
  void check_mark(std::size_t at, std::uint64_t bytes) const;

  std::string_view bytes_;
  Plot3dDialect dialect_;
  bool swap_ = false;
  std::size_t next_ = 0;  ///< the next byte
  std::size_t last_ = 0;  ///< first byte of the number just read
  int records_found_ = 0;
};

/// Coordinates that a point has.
inline int plot3d_dimensions(const Plot3dDialect& dialect) {
  return dialect.two_dimensional ? 2 : 3;
}

inline std::uint64_t plot3d_points(const Plot3dBlockSize& size) {
  return static_cast<std::uint64_t>(size.ni) * static_cast<std::uint64_t>(size.nj) *
         static_cast<std::uint64_t>(size.nk);
}

/// Bytes of one block's data without record marks; 0 for text.
inline std::uint64_t plot3d_record_bytes(const Plot3dDialect& dialect,
                                         const Plot3dBlockSize& size) {
  if (dialect.formatted) return 0;
  const int real = dialect.double_precision ? 8 : 4;
  const int bytes = plot3d_dimensions(dialect) * real + (dialect.iblank ? 4 : 0);
  return plot3d_points(size) * static_cast<std::uint64_t>(bytes);
}

/// |have - need| as a part of the larger, in [0, 1].
double plot3d_length_distance(std::uint64_t have, std::uint64_t need);

}  // namespace vdb_offset
