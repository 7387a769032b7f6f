#include <doctest/doctest.h>

#include <limits>
#include <string>

#include "io/plot3d_grid.h"
#include "io/plot3d_parse.h"
#include "vdb_offset/core/error.h"

using namespace vdb_offset;
using namespace plot3d_test;

namespace {

/// A surface of one block 2 x 2 x 1 whose twelve numbers are these.
Patch read(const std::string& numbers) {
  return read_plot3d_bytes("1\n2 2 1\n" + numbers, "grid").at(0);
}

std::string numbers(int count) {
  std::string text;
  for (int n = 0; n < count; ++n) text += " 0.5";
  return text;
}

}  // namespace

TEST_CASE("plot3d text: Fortran's exponents, repeats, commas and signs are read") {
  const Patch patch = read("1.0D-3 +2.5d+2,-.5 4.\n2*1.5E0 , 2*-7\t\r\n1e0,\n2 2*0.25");
  const Vec3List expected = {
      {1e-3, 1.5, 1.0}, {250.0, 1.5, 2.0}, {-0.5, -7.0, 0.25}, {4.0, -7.0, 0.25}};
  CHECK((patch.points_world == expected));
}

TEST_CASE("plot3d text: sizes may be repeated, and stand on any line") {
  const std::string numbers = "0.5 1.5 0.5 1.5 0 0 1.25 1.25 4*1.0 ";
  const Patches patches = read_plot3d_bytes("2 2*2\n1 2*2 1\n" + numbers + numbers, "two blocks");
  REQUIRE(patches.size() == 2);
  CHECK((patches[1].at(1, 1) == Vec3(1.5, 1.25, 1.0)));
}

TEST_CASE("plot3d text: a double's extremes come through, and what underflows is zero") {
  const Patch patch =
      read("1.7976931348623157e308 4.9406564584124654e-324 1e-400 -1D-500 0.1 0.2 0.3 0.4 4*0.5");
  CHECK(patch.points_world[0].x() == std::numeric_limits<double>::max());
  CHECK(patch.points_world[1].x() == std::numeric_limits<double>::denorm_min());
  CHECK(patch.points_world[2].x() == 0.0);
  CHECK(patch.points_world[3].x() == 0.0);
}

TEST_CASE("plot3d text: what is no number is refused with its token, byte and text") {
  // The fifth token of the file is the second x, and begins at byte 12.
  for (const std::string bad : {"0.5-0.3", "*****", "1.0x", "0x10", "3*", "0*1", "1e", "+-1",
                                "1.0D", "1.0D+", "1;2", "--1", "1.5.2", "/", "'1'"}) {
    const std::string said = io_error([&] { read("0.5 " + bad + " 1 1 0 0 1 1 0 0 0 0"); });
    CAPTURE(said);
    CHECK(contains(said, "token 6 (byte 12) is \"" + bad + "\", which is not a number"));
    CHECK(contains(said, "grid (formatted, multi-block, 3-D)"));
    CHECK(contains(said, "--input-format"));
  }
  // The rest of a repeat is a number, not another repeat.
  const std::string twice = io_error([&] { read("0.5 2*3*1 1 0 0 1 1 0 0 0 0"); });
  CHECK(contains(twice, "token 6 (byte 14) is \"3*1\", which is not a number"));
  const std::string empty = io_error([&] { read("0.5 ,, 1 1 0 0 1 1 0 0 0 0"); });
  CHECK(contains(empty, "is \"\", which is not a number"));
}

TEST_CASE("plot3d text: a coordinate that is not finite is refused with its point") {
  for (const std::string bad : {"nan", "NaN", "inf", "-Infinity", "1e999", "1D+999"}) {
    const auto call = [&] { read("0 1 0 1 0 0 " + bad + " 1 0 0 0 0"); };
    const std::string said = io_error(call);
    CAPTURE(said);
    CHECK(contains(said, "patch 1, point i = 1, j = 2 (from 1), token 11 (byte 20): y = "));
    CHECK(contains(said, "is not finite"));
    try {
      call();
    } catch (const IoError& error) {
      CHECK((error.indices() == std::vector<std::int64_t>{0, 0, 1}));
    }
  }
}

TEST_CASE("plot3d text: a number too few or too many is refused with both counts") {
  for (const int count : {1, 35, 37, 100}) {
    const std::string text = "1 3 4 1" + numbers(count);
    const std::string said = io_error([&] { read_plot3d_bytes(text, "grid"); });
    CAPTURE(said);
    CHECK(contains(said, "grid: no PLOT3D dialect fits; the nearest is formatted, "));
    CHECK(contains(said, "the file holds " + std::to_string(count + 4)));
    if (std::abs(count - 36) == 1)
      CHECK(contains(said,
                     "multi-block, 3-D, but its sizes "
                     "(blocks: 1, points: 12) need 40 numbers"));
  }
  const std::string said = io_error([&] { read("0.5-0.3 0.5 1 1 0 0 1 1 0 0 0"); });
  CHECK(contains(said, "(token 5 (byte 8) is \"0.5-0.3\", which is not a number)"));
}

TEST_CASE("plot3d: a point with iblank 0 is refused with its place") {
  for (Plot3dDialect dialect : all_dialects()) {
    if (!dialect.iblank || !dialect.multi_block) continue;
    Grid grid = make_grid({{4, 3, 1}, {2, 5, 1}}, dialect.two_dimensional);
    grid.blanks[1][7] = 0;
    const std::string said = io_error([&] { read_plot3d_bytes(encode(dialect, grid), "grid"); });
    CAPTURE(said);
    CHECK(contains(said, "patch 2, point i = 2, j = 4 (from 1)"));
    CHECK(contains(said, "iblank = 0"));
  }
}

TEST_CASE("plot3d text: iblanks must be whole numbers") {
  const std::string said =
      io_error([] { read_plot3d_bytes("1 2 2 1 0 1 0 1 0 0 1 1 0 0 0 0 1 1 1.5 1", "grid"); });
  CAPTURE(said);
  CHECK(contains(said, "formatted, multi-block, 3-D, iblank"));
  CHECK(contains(said, "token 19 (byte 36) is \"1.5\", which is not a whole number"));
}
