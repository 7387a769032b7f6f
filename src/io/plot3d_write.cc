#include <fmt/format.h>

#include <cstdint>
#include <cstring>
#include <iterator>
#include <limits>
#include <string>
#include <vector>

#include "io/output_file.h"
#include "vdb_offset/core/error.h"
#include "vdb_offset/io/plot3d.h"

namespace vdb_offset {
namespace {

/// Numbers to a stream, in pieces: a mesh is never held a second time.
class Sink {
 public:
  Sink(std::ostream& stream, bool formatted) : stream_(stream), formatted_(formatted) {}

  void mark(std::uint64_t bytes) {
    if (!formatted_) raw(static_cast<std::uint32_t>(bytes));
  }
  void whole(int value) {
    if (formatted_) {
      fmt::format_to(std::back_inserter(buffer_), " {}", value);
      flush_if_full();
    } else {
      raw(static_cast<std::int32_t>(value));
    }
  }
  void real(double value) {
    if (formatted_) {
      // 17 significant digits bring back every double.
      fmt::format_to(std::back_inserter(buffer_), "{:24.16e}", value);
      if (++column_ % kColumns == 0) buffer_.push_back('\n');
      flush_if_full();
    } else {
      raw(value);
    }
  }
  void end_line() {
    if (formatted_) buffer_.push_back('\n');
    column_ = 0;
  }
  void flush() {
    stream_.write(buffer_.data(), static_cast<std::streamsize>(buffer_.size()));
    buffer_.clear();
  }

 private:
  static constexpr std::size_t kPiece = std::size_t{1} << 16;
  static constexpr int kColumns = 4;

  template <typename T>
  void raw(T value) {
    const auto* bytes = reinterpret_cast<const char*>(&value);
    buffer_.append(bytes, bytes + sizeof value);
    flush_if_full();
  }
  void flush_if_full() {
    if (buffer_.size() >= kPiece) flush();
  }

  std::ostream& stream_;
  bool formatted_;
  int column_ = 0;
  fmt::memory_buffer buffer_;
};

struct Size {
  int ni, nj, nk;

  std::uint64_t record_bytes() const {
    return 3 * sizeof(double) * static_cast<std::uint64_t>(ni) * static_cast<std::uint64_t>(nj) *
           static_cast<std::uint64_t>(nk);
  }
};

/// Refuses what would be an unreadable file, before anything is written.
void check_sizes(const std::filesystem::path& file, const std::vector<Size>& sizes,
                 bool formatted) {
  constexpr std::uint64_t kLongestRecord = std::numeric_limits<std::int32_t>::max();
  if (sizes.empty()) throw InputError(file.string() + ": there are no blocks to write");
  if (formatted) return;
  for (std::size_t b = 0; b < sizes.size(); ++b) {
    const Size& size = sizes[b];
    if (size.record_bytes() <= kLongestRecord) continue;
    throw IoError(fmt::format("{}: block {} of {} x {} x {} points needs a Fortran record of {} "
                              "bytes, and record marks end at {}; write it formatted, or in "
                              "another format",
                              file.string(), b + 1, size.ni, size.nj, size.nk, size.record_bytes(),
                              kLongestRecord),
                  {static_cast<std::int64_t>(b)});
  }
}

void write_header(Sink& sink, const std::vector<Size>& sizes) {
  sink.mark(sizeof(std::int32_t));
  sink.whole(static_cast<int>(sizes.size()));
  sink.mark(sizeof(std::int32_t));
  sink.end_line();
  const std::uint64_t bytes = 3 * sizeof(std::int32_t) * sizes.size();
  sink.mark(bytes);
  for (const Size& size : sizes) {
    for (const int n : {size.ni, size.nj, size.nk}) sink.whole(n);
    sink.end_line();
  }
  sink.mark(bytes);
}

/// `write_component(block, c, sink)` gives the x, y or z of all of a block's points, i fastest.
template <class WriteComponent>
void write_grid(const std::filesystem::path& file, const std::vector<Size>& sizes, bool formatted,
                const WriteComponent& write_component) {
  check_sizes(file, sizes, formatted);
  OutputFile output(file);
  Sink sink(output.stream(), formatted);
  write_header(sink, sizes);
  for (std::size_t b = 0; b < sizes.size(); ++b) {
    sink.mark(sizes[b].record_bytes());
    for (int c = 0; c < 3; ++c) {
      write_component(b, c, sink);
      sink.end_line();
    }
    sink.mark(sizes[b].record_bytes());
  }
  sink.flush();
  output.commit();
}

}  // namespace

void write_plot3d(const std::filesystem::path& file, const Patches& patches,
                  const Plot3dWriteOptions& options) {
  std::vector<Size> sizes;
  for (const Patch& patch : patches) {
    const Size size{patch.ni, patch.nj, 1};
    if (patch.ni < 1 || patch.nj < 1 ||
        patch.points_world.size() * 3 * sizeof(double) != size.record_bytes()) {
      throw InputError(
          fmt::format("{}: {} holds {} points, and its sizes are {} x {}", file.string(),
                      patch.name, patch.points_world.size(), patch.ni, patch.nj),
          {static_cast<std::int64_t>(sizes.size())});
    }
    sizes.push_back(size);
  }
  write_grid(file, sizes, options.formatted, [&](std::size_t b, int c, Sink& sink) {
    for (const Vec3& point : patches[b].points_world) sink.real(point[c]);
  });
}

void write_plot3d(const std::filesystem::path& file, const MultiBlock& mesh,
                  const Plot3dWriteOptions& options) {
  std::vector<Size> sizes;
  for (const Block& block : mesh.blocks) sizes.push_back({block.ni, block.nj, block.nk});
  write_grid(file, sizes, options.formatted, [&](std::size_t b, int c, Sink& sink) {
    const Block& block = mesh.blocks[b];
    for (int k = 0; k < block.nk; ++k) {
      for (const int column : block.columns) sink.real(mesh.layers.at(column, k)[c]);
    }
  });
}

}  // namespace vdb_offset
