#include <doctest/doctest.h>

#include <string>
#include <vector>

#include "io/plot3d_grid.h"
#include "io/plot3d_parse.h"
#include "vdb_offset/core/error.h"

using namespace vdb_offset;
using namespace plot3d_test;

namespace {

using Sizes = std::vector<Plot3dBlockSize>;

/// Block lists that the dialect can hold: one size is 1 in every direction in turn.
std::vector<Sizes> surfaces_for(const Plot3dDialect& dialect) {
  const Sizes flat = {{4, 3, 1}, {2, 5, 1}, {3, 3, 1}};
  const Sizes turned = {{4, 1, 3}, {1, 2, 5}, {3, 3, 1}};
  if (dialect.multi_block && dialect.two_dimensional) return {flat, {{5, 7, 1}}};
  if (dialect.multi_block) return {flat, turned, {{5, 7, 1}}, {{1, 5, 7}}};
  if (dialect.two_dimensional) return {{{5, 7, 1}}, {{2, 2, 1}}};
  return {{{5, 7, 1}}, {{5, 1, 7}}, {{1, 5, 7}}, {{2, 2, 1}}};
}

void check_same(const Patches& patches, const Grid& grid) {
  REQUIRE(patches.size() == grid.sizes.size());
  for (std::size_t b = 0; b < patches.size(); ++b) {
    std::vector<std::int64_t> sides;
    for (const std::int64_t n : {grid.sizes[b].ni, grid.sizes[b].nj, grid.sizes[b].nk}) {
      if (n > 1) sides.push_back(n);
    }
    CHECK(patches[b].name == "patch " + std::to_string(b + 1));
    CHECK(patches[b].family.empty());
    CHECK(patches[b].ni == sides[0]);
    CHECK(patches[b].nj == sides[1]);
    CHECK((patches[b].points_world == grid.points[b]));
  }
}

}  // namespace

TEST_CASE("plot3d: every dialect is found and read exactly, however its surface is turned") {
  const std::vector<Plot3dDialect> dialects = all_dialects();
  REQUIRE(dialects.size() == 72);
  unsigned seed = 0;
  for (const Plot3dDialect& dialect : dialects) {
    for (const Sizes& sizes : surfaces_for(dialect)) {
      const Grid grid = make_grid(sizes, dialect.two_dimensional, ++seed);
      const std::string bytes = encode(dialect, grid);
      CAPTURE(dialect.describe());
      CAPTURE(sizes[0].ni);
      const Plot3dInfo info = inspect_plot3d_bytes(bytes, "grid");
      CHECK(info.dialect.describe() == dialect.describe());
      check_same(read_plot3d_bytes(bytes, "grid"), grid);
      check_same(read_plot3d_bytes(bytes, "grid", hint_of(dialect)), grid);
    }
  }
}

TEST_CASE("plot3d: double precision comes through to the last bit") {
  for (Plot3dDialect dialect : all_dialects()) {
    if (!dialect.double_precision) continue;
    Grid grid = make_grid({{4, 3, 1}, {2, 5, 1}}, dialect.two_dimensional);
    if (!dialect.multi_block) grid = make_grid({{4, 3, 1}}, dialect.two_dimensional);
    for (Vec3& point : grid.points[0]) point /= 3.0;
    CAPTURE(dialect.describe());
    check_same(read_plot3d_bytes(encode(dialect, grid), "grid"), grid);
  }
}

TEST_CASE("plot3d: a flat surface in the plane z = 0 is not taken for another dialect") {
  for (const Plot3dDialect& dialect : all_dialects()) {
    for (const Sizes& sizes : surfaces_for(dialect)) {
      const Grid grid = make_grid(sizes, true);
      CAPTURE(dialect.describe());
      CAPTURE(sizes[0].ni);
      check_same(read_plot3d_bytes(encode(dialect, grid), "grid"), grid);
    }
  }
}

TEST_CASE("plot3d: the sizes of a volume are found, and reading it is refused by block") {
  for (const Plot3dDialect& dialect : all_dialects()) {
    if (dialect.two_dimensional) continue;
    Sizes sizes = {{4, 3, 1}, {4, 3, 2}};
    if (!dialect.multi_block) sizes = {{4, 3, 2}};
    const std::string bytes = encode(dialect, make_grid(sizes, false));
    const Plot3dInfo info = inspect_plot3d_bytes(bytes, "grid");
    CAPTURE(dialect.describe());
    CHECK(info.dialect.describe() == dialect.describe());
    REQUIRE(info.blocks.size() == sizes.size());
    CHECK(info.blocks.back().nk == 2);
    const std::string said = io_error([&] { read_plot3d_bytes(bytes, "grid"); });
    CHECK(contains(said, "block " + std::to_string(sizes.size()) + " is a volume: 4 x 3 x 2"));
    CHECK(contains(said, dialect.describe()));
  }
}

TEST_CASE("plot3d: blocks with two sizes of 1 are curves, in every dialect") {
  for (const Plot3dDialect& dialect : all_dialects()) {
    CAPTURE(dialect.describe());
    Sizes sizes{{9, 1, 1}, {1, 7, 1}, {1, 1, 5}};
    if (dialect.two_dimensional) sizes.pop_back();
    if (!dialect.multi_block) sizes.resize(1);
    const Grid grid = make_grid(sizes, dialect.two_dimensional);
    const Patches patches = read_plot3d_bytes(encode(dialect, grid), "grid", hint_of(dialect));
    REQUIRE(patches.size() == sizes.size());
    for (std::size_t b = 0; b < patches.size(); ++b) {
      CHECK(patches[b].ni == sizes[b].ni * sizes[b].nj * sizes[b].nk);
      CHECK(patches[b].nj == 1);
      CHECK(patches[b].points_world == grid.points[b]);
    }
  }
}

TEST_CASE("plot3d: a point, and curves beside surfaces, are refused as such") {
  const auto said = [](const Sizes& sizes) {
    const std::string bytes = encode(Plot3dDialect{}, make_grid(sizes, false));
    return io_error([&] { read_plot3d_bytes(bytes, "grid"); });
  };
  CHECK(contains(said({{1, 1, 1}}), "block 1 is a point: 1 x 1 x 1"));
  CHECK(contains(said({{9, 1, 1}, {4, 5, 1}}),
                 "block 1 is a curve of 9 x 1 points, and block 2 a surface of 4 x 5"));
  CHECK(contains(said({{4, 1, 5}, {3, 3, 1}, {1, 1, 6}}),
                 "block 1 is a surface of 4 x 5 points, and block 3 a curve of 6 x 1"));
}

TEST_CASE("plot3d: a hint that the file contradicts is refused with the nearest dialect") {
  Plot3dDialect dialect;
  dialect.formatted = false;
  const std::string bytes = encode(dialect, make_grid({{4, 3, 1}}, false));
  for (const char* words : {"formatted", "c-stream", "single", "big-endian", "iblank", "2d",
                            "single-block", "unformatted,double,iblank"}) {
    CAPTURE(words);
    const auto read = [&] { read_plot3d_bytes(bytes, "grid", Plot3dHint::parse(words)); };
    const std::string said = io_error(read);
    CHECK(contains(said, "grid: no PLOT3D dialect fits; the nearest is "));
    CHECK(contains(said, "--input-format"));
  }
  const char* all = "unformatted, double,little-endian,no-iblank,multi-block,3d";
  CHECK(read_plot3d_bytes(bytes, "grid", Plot3dHint::parse(all)).size() == 1);
}

TEST_CASE("plot3d: a hint decides where two dialects fit") {
  // One block 5 x 7 of whole numbers in 2-D with iblanks, or a surface 1 x 5 x 7 in 3-D.
  std::string text = "1 5 7\n";
  for (int n = 0; n < 3 * 35; ++n) text += std::to_string(2 + n % 4) + "\n";
  CHECK(inspect_plot3d_bytes(text, "grid").dialect.describe() == "formatted, single-block, 3-D");
  const Plot3dInfo told = inspect_plot3d_bytes(text, "grid", Plot3dHint::parse("2d"));
  CHECK(told.dialect.describe() == "formatted, multi-block, 2-D, iblank");
}

TEST_CASE("plot3d: words of a dialect are parsed, and unknown or contradicting ones refused") {
  CHECK_FALSE(Plot3dHint::parse("").formatted.has_value());
  const Plot3dHint stream = Plot3dHint::parse("c-stream,single");
  CHECK(stream.formatted == false);
  CHECK(stream.records == false);
  CHECK(stream.double_precision == false);
  CHECK_FALSE(stream.iblank.has_value());
  CHECK(Plot3dHint::parse("unformatted").records == true);
  CHECK(Plot3dHint::parse("no-iblank").iblank == false);
  for (const char* words : {"ascii", "2D", "single,double", "formatted,c-stream", "formatted;2d"}) {
    CAPTURE(words);
    CHECK_THROWS_AS(Plot3dHint::parse(words), InputError);
  }
  try {
    Plot3dHint::parse("ascii");
  } catch (const InputError& error) {
    CHECK(contains(error.what(), "\"ascii\""));
    CHECK(contains(error.what(), "no-iblank"));
  }
}
