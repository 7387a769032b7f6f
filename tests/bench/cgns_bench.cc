// Writing blocks to CGNS against writing their bytes, in one folder.
//
//   cgns_bench [FOLDER]
//
// Ten million cells, as one block and as 64. Each file is flushed to the disk. Memory is that of
// the process: what writing adds, over what the mesh takes.

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <cstdio>
#include <filesystem>
#include <fstream>
#include <stdexcept>

#include "bench/measure.h"
#include "vdb_offset/io/cgns.h"

using namespace vdb_offset;
using namespace vdb_offset::bench;

namespace {

constexpr int kRepeats = 5;

void flush_to_disk(const std::filesystem::path& file) {
  const int descriptor = ::open(file.c_str(), O_RDONLY);
  if (descriptor < 0 || ::fsync(descriptor) != 0) throw std::runtime_error("cannot flush");
  ::close(descriptor);
}

/// `count` blocks of one size, whose points do not matter.
MultiBlock blocks(int count, int points, int levels) {
  MultiBlock mesh;
  mesh.layers.spacing.layers = levels - 1;
  const auto columns = static_cast<std::size_t>(points) * static_cast<std::size_t>(points);
  for (int b = 0; b < count; ++b) {
    Block block;
    block.name = fmt::format("block {}", b + 1);
    block.ni = block.nj = points;
    block.nk = levels;
    for (std::size_t c = 0; c < columns; ++c) {
      block.columns.push_back(static_cast<int>(static_cast<std::size_t>(b) * columns + c));
    }
    mesh.blocks.push_back(std::move(block));
  }
  mesh.layers.points_world.assign(
      columns * static_cast<std::size_t>(count) * static_cast<std::size_t>(levels),
      Vec3(0.1, 0.2, 0.3));
  return mesh;
}

void compare(const char* name, const MultiBlock& mesh, const std::filesystem::path& folder) {
  const std::uint64_t before = peak_memory_bytes();
  const std::filesystem::path raw = folder / "raw.bin";
  const std::filesystem::path cgns = folder / "mesh.cgns";
  const Vec3List& points = mesh.layers.points_world;
  std::vector<double> raw_seconds;
  std::vector<double> cgns_seconds;
  double raw_work = 0;
  double cgns_work = 0;
  for (int n = 0; n < kRepeats; ++n) {
    raw_work -= processor_seconds();
    raw_seconds.push_back(seconds([&] {
      std::ofstream(raw, std::ios::binary)
          .write(reinterpret_cast<const char*>(points.data()),
                 static_cast<std::streamsize>(points.size() * sizeof(Vec3)));
      flush_to_disk(raw);
    }));
    raw_work += processor_seconds();
    cgns_work -= processor_seconds();
    cgns_seconds.push_back(seconds([&] {
      write_cgns(cgns, mesh);
      flush_to_disk(cgns);
    }));
    cgns_work += processor_seconds();
  }
  fmt::print(
      "{:<10} {} cells, {} points: bytes {:.2f} s, CGNS {:.2f} s, {:.2f} times ({:.2f} in "
      "processor seconds); memory {:.3f} times the mesh\n",
      name, mesh.cells(), points.size(), median(raw_seconds), median(cgns_seconds),
      median(cgns_seconds) / median(raw_seconds), cgns_work / raw_work,
      static_cast<double>(peak_memory_bytes()) / static_cast<double>(before));
  std::filesystem::remove(raw);
  std::filesystem::remove(cgns);
}

}  // namespace

int main(int count, char** arguments) {
  const std::filesystem::path folder =
      count > 1 ? std::filesystem::path(arguments[1]) : std::filesystem::temp_directory_path();
  const Ticks before = ticks();
  // The one that takes less memory first: what is measured is the process's peak.
  compare("64 blocks", blocks(64, 51, 64), folder);
  compare("one block", blocks(1, 401, 64), folder);
  print_stolen(before);
  return 0;
}
