#include <doctest/doctest.h>
#include <unistd.h>

#include <algorithm>
#include <map>
#include <string>
#include <vector>

#include "io/plot3d_grid.h"
#include "vdb_offset/io/plot3d.h"

using namespace vdb_offset;
using namespace plot3d_test;

namespace {

struct Expected {
  std::string dialect;
  std::string sizes;
};

/// What the list of sources says of each file, and what its own program wrote.
const std::map<std::string, Expected> kFiles = {
    {"bwb.fmt",
     {"formatted, multi-block, 3-D",
      "33x9x1 73x33x1 9x33x1 33x73x1 73x9x1 49x9x1 73x49x1 9x49x1 49x73x1"}},
    {"even_sphere.fmt", {"formatted, multi-block, 3-D", "5x5x1 5x5x1 5x5x1 5x5x1 5x5x1 5x5x1"}},
    {"m6_small.fmt",
     {"formatted, multi-block, 3-D",
      "65x17x1 73x65x1 17x65x1 65x73x1 73x17x1 17x73x1 17x17x1 17x17x1 73x17x1"}},
    {"rae2822_p3d.xyz", {"formatted, multi-block, 3-D", "121x2x1"}},
    {"uneven_sphere.fmt",
     {"formatted, multi-block, 3-D", "17x17x1 17x17x1 17x17x1 17x17x1 17x17x1 17x17x1"}},
    {"vtk_bluntfinxyz.bin", {"C stream, single, big-endian, single-block, 3-D", "40x32x32"}},
    {"vtk_multi-ascii.xyz", {"formatted, multi-block, 3-D", "8x12x12 8x12x12"}},
    {"vtk_multi-bin-2D.xyz",
     {"C stream, double, little-endian, multi-block, 2-D", "11x17x1 11x17x1"}},
    {"vtk_multi-bin-C.xyz",
     {"C stream, double, little-endian, multi-block, 3-D", "8x12x12 8x12x12"}},
    {"vtk_multi-bin.xyz",
     {"Fortran records, double, little-endian, multi-block, 3-D", "8x12x12 8x12x12"}},
};

std::string text_of(const std::vector<Plot3dBlockSize>& blocks) {
  std::string text;
  for (const Plot3dBlockSize& size : blocks) {
    text += fmt::format("{}{}x{}x{}", text.empty() ? "" : " ", size.ni, size.nj, size.nk);
  }
  return text;
}

double largest_radius_error(const Patches& patches) {
  double worst = 0.0;
  for (const Patch& patch : patches) {
    for (const Vec3& point : patch.points_world)
      worst = std::max(worst, std::abs(point.norm() - 1));
  }
  return worst;
}

}  // namespace

TEST_CASE("plot3d: every real file gives its sizes; surfaces are read and volumes refused") {
  const std::filesystem::path folder = shared_folder();
  if (folder.empty()) {
    MESSAGE("skipped: ../shared/data/plot3d is absent");
    return;
  }
  std::size_t files = 0;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    const std::string name = entry.path().filename().string();
    CAPTURE(name);
    REQUIRE(kFiles.count(name) == 1);
    ++files;
    const Expected& expected = kFiles.at(name);
    const Plot3dInfo info = inspect_plot3d(entry.path());
    CHECK(info.dialect.describe() == expected.dialect);
    CHECK(text_of(info.blocks) == expected.sizes);
    const Plot3dBlockSize& first = info.blocks[0];
    if (first.nk > 1) {
      const std::string said = io_error([&] { read_plot3d(entry.path()); });
      CHECK(contains(said, entry.path().string()));
      CHECK(contains(
          said, fmt::format("block 1 is a volume: {} x {} x {}", first.ni, first.nj, first.nk)));
      continue;
    }
    const Patches patches = read_plot3d(entry.path());
    REQUIRE(patches.size() == info.blocks.size());
    for (std::size_t b = 0; b < patches.size(); ++b) {
      CHECK(patches[b].ni == info.blocks[b].ni);
      CHECK(patches[b].nj == info.blocks[b].nj);
    }
  }
  CHECK(files == kFiles.size());
}

TEST_CASE("plot3d: the coordinates of real files are those of the bodies they are named after") {
  const std::filesystem::path folder = shared_folder();
  if (folder.empty()) {
    MESSAGE("skipped: ../shared/data/plot3d is absent");
    return;
  }
  // Both spheres have radius 1 to the single precision in which they were made.
  constexpr double kSingle = 1e-5;
  CHECK(largest_radius_error(read_plot3d(folder / "even_sphere.fmt")) < kSingle);
  CHECK(largest_radius_error(read_plot3d(folder / "uneven_sphere.fmt")) < kSingle);
  const Patches airfoil = read_plot3d(folder / "rae2822_p3d.xyz");
  Box box;
  for (const Vec3& point : airfoil[0].points_world) box.add(point);
  CHECK(box.hi.x() - box.lo.x() == doctest::Approx(1.0).epsilon(0.02));
  const Patches plane = read_plot3d(folder / "vtk_multi-bin-2D.xyz");
  for (const Vec3& point : plane[1].points_world) {
    CHECK(point.z() == 0.0);
    CHECK(point.norm() < 100.0);
  }
}

TEST_CASE("plot3d: missing, empty, unreadable files and folders are refused by name") {
  const TempFolder scratch;
  const auto said = [](const std::filesystem::path& file) {
    return io_error([&] { read_plot3d(file); });
  };
  CHECK(contains(said(scratch / "none.xyz"), "none.xyz: does not exist"));
  CHECK(contains(said(scratch / ""), "is a folder"));
  CHECK(contains(said("/dev/null"), "/dev/null: is not a regular file"));
  std::ofstream(scratch / "empty.xyz").flush();
  CHECK(contains(said(scratch / "empty.xyz"), "empty.xyz: is empty"));
  std::ofstream(scratch / "blank.xyz") << " \n\n";
  CHECK(contains(said(scratch / "blank.xyz"), "blank.xyz: no PLOT3D dialect fits"));
  std::ofstream(scratch / "secret.xyz") << "1 2 2 1";
  std::filesystem::permissions(scratch / "secret.xyz", std::filesystem::perms::none);
  if (::geteuid() == 0) {
    MESSAGE("part skipped: root may read every file");
  } else {
    CHECK(contains(said(scratch / "secret.xyz"), "secret.xyz: cannot be opened"));
  }
}
