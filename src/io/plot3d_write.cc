#include <fmt/format.h>

#include <algorithm>
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
  void reals(const std::vector<double>& values) {
    if (formatted_) {
      for (const double value : values) real(value);
      return;
    }
    flush();
    stream_.write(reinterpret_cast<const char*>(values.data()),
                  static_cast<std::streamsize>(values.size() * sizeof(double)));
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

  std::uint64_t points() const {
    return static_cast<std::uint64_t>(ni) * static_cast<std::uint64_t>(nj) *
           static_cast<std::uint64_t>(nk);
  }
};

/// What is common to all blocks.
struct Shape {
  bool formatted;
  int dimensions;  ///< 2: `ni nj`, and no z

  std::uint64_t record_bytes(const Size& size) const {
    return static_cast<std::uint64_t>(dimensions) * sizeof(double) * size.points();
  }
};

/// Refuses what would be an unreadable file, before anything is written.
void check_sizes(const std::filesystem::path& file, const std::vector<Size>& sizes,
                 const Shape& shape) {
  constexpr std::uint64_t kLongestRecord = std::numeric_limits<std::int32_t>::max();
  if (sizes.empty()) throw InputError(file.string() + ": there are no blocks to write");
  if (shape.formatted) return;
  for (std::size_t b = 0; b < sizes.size(); ++b) {
    const Size& size = sizes[b];
    if (shape.record_bytes(size) <= kLongestRecord) continue;
    throw IoError(fmt::format("{}: block {} of {} x {} x {} points needs a Fortran record of {} "
                              "bytes, and record marks end at {}; write it formatted, or in "
                              "another format",
                              file.string(), b + 1, size.ni, size.nj, size.nk,
                              shape.record_bytes(size), kLongestRecord),
                  {static_cast<std::int64_t>(b)});
  }
}

void write_header(Sink& sink, const std::vector<Size>& sizes, int dimensions) {
  sink.mark(sizeof(std::int32_t));
  sink.whole(static_cast<int>(sizes.size()));
  sink.mark(sizeof(std::int32_t));
  sink.end_line();
  const std::uint64_t bytes =
      static_cast<std::uint64_t>(dimensions) * sizeof(std::int32_t) * sizes.size();
  sink.mark(bytes);
  for (const Size& size : sizes) {
    sink.whole(size.ni);
    sink.whole(size.nj);
    if (dimensions == 3) sink.whole(size.nk);
    sink.end_line();
  }
  sink.mark(bytes);
}

/// `write_component(block, c, sink)` gives the x, y or z of all of a block's points, i fastest.
template <class WriteComponent>
void write_grid(const std::filesystem::path& file, const std::vector<Size>& sizes,
                const Shape& shape, const WriteComponent& write_component) {
  check_sizes(file, sizes, shape);
  OutputFile output(file);
  Sink sink(output.stream(), shape.formatted);
  write_header(sink, sizes, shape.dimensions);
  for (std::size_t b = 0; b < sizes.size(); ++b) {
    sink.mark(shape.record_bytes(sizes[b]));
    for (int c = 0; c < shape.dimensions; ++c) {
      write_component(b, c, sink);
      sink.end_line();
    }
    sink.mark(shape.record_bytes(sizes[b]));
  }
  sink.flush();
  output.commit();
}

/// Whether the patches are curves; both kinds together are refused.
bool are_curves(const std::filesystem::path& file, const Patches& patches) {
  const auto is_curve = [](const Patch& patch) { return patch.nj == 1; };
  const auto curves = std::ranges::count_if(patches, is_curve);
  if (curves == 0 || curves == std::ssize(patches)) return curves > 0;
  const auto curve = std::ranges::find_if(patches, is_curve);
  const auto surface = std::ranges::find_if_not(patches, is_curve);
  throw InputError(
      fmt::format("{}: {} is a curve and {} a surface; write them to files of their own",
                  file.string(), curve->name, surface->name),
      {curve - patches.begin(), surface - patches.begin()});
}

bool is_flat(const Patch& patch) {
  return std::ranges::all_of(patch.points_world, [](const Vec3& p) { return p.z() == 0; });
}

}  // namespace

void write_plot3d(const std::filesystem::path& file, const Patches& patches,
                  const Plot3dWriteOptions& options) {
  const bool plane = are_curves(file, patches) && std::ranges::all_of(patches, is_flat);
  std::vector<Size> sizes;
  for (const Patch& patch : patches) {
    const Size size{patch.ni, patch.nj, 1};
    if (patch.ni < 1 || patch.nj < 1 || patch.points_world.size() != size.points()) {
      throw InputError(
          fmt::format("{}: {} holds {} points, and its sizes are {} x {}", file.string(),
                      patch.name, patch.points_world.size(), patch.ni, patch.nj),
          {static_cast<std::int64_t>(sizes.size())});
    }
    sizes.push_back(size);
  }
  const Shape shape{options.formatted, plane ? 2 : 3};
  write_grid(file, sizes, shape, [&](std::size_t b, int c, Sink& sink) {
    for (const Vec3& point : patches[b].points_world) sink.real(point[c]);
  });
}

namespace {

constexpr int kLevels = 16;  // gathered at a time: points stand in memory column by column

struct Component {
  const MultiBlock& mesh;
  const Block& block;
  int axis;
};

/// Levels [first, last) of a block, one after the other. Of curves i runs backwards: the way along
/// a curve and that off it are left-handed in their plane, what no solver takes.
void gather(const Component& of, int first, int last, std::vector<double>& values) {
  const auto columns = static_cast<std::size_t>(of.block.ni * (of.mesh.flat ? 1 : of.block.nj));
  const auto levels = static_cast<std::size_t>(last - first);
  values.resize(columns * levels);
  for (std::size_t n = 0; n < columns; ++n) {
    const std::size_t column = of.mesh.flat ? columns - 1 - n : n;
    const Vec3* const points = &of.mesh.layers.at(of.block.columns[column], first);
    for (std::size_t k = 0; k < levels; ++k) values[k * columns + n] = points[k][of.axis];
  }
}

}  // namespace

void write_plot3d(const std::filesystem::path& file, const MultiBlock& mesh,
                  const Plot3dWriteOptions& options) {
  std::vector<Size> sizes;
  for (const Block& block : mesh.blocks) {
    sizes.push_back(mesh.flat ? Size{block.ni, block.nk, 1} : Size{block.ni, block.nj, block.nk});
  }
  std::vector<double> values;
  write_grid(file, sizes, {options.formatted, mesh.flat ? 2 : 3},
             [&](std::size_t b, int c, Sink& sink) {
               const Block& block = mesh.blocks[b];
               for (int k = 0; k < block.nk; k += kLevels) {
                 gather({mesh, block, c}, k, std::min(k + kLevels, block.nk), values);
                 sink.reals(values);
               }
             });
}

}  // namespace vdb_offset
