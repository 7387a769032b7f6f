#include "vdb_offset/io/obj_curves.h"

#include <doctest/doctest.h>

#include <fstream>
#include <string>

#include "io/curve_points.h"
#include "io/obj_parse.h"
#include "io/plot3d_grid.h"
#include "support/shapes.h"

using namespace vdb_offset;
using plot3d_test::contains;
using plot3d_test::io_error;

namespace {

Patches parsed(const std::string& text) { return read_obj_curves_bytes(text, "shape.obj"); }

std::string refusal(const std::string& text) {
  return io_error([&] { parsed(text); });
}

/// Vertices 1 to 6 at (n, n * n), on a parabola.
std::string parabola() {
  std::string text;
  for (int n = 1; n <= 6; ++n) text += fmt::format("v {} {} 0.5\n", n, n * n);
  return text;
}

/// The x of a patch's points, which is the vertex's number.
std::string numbers(const Patch& patch) {
  std::string text;
  for (const Vec3& p : patch.points_world) text += fmt::format("{} ", p.x());
  return text;
}

}  // namespace

TEST_CASE(
    "obj: a polyline is one curve in its own sense, with names, slashes and negative indices") {
  const Patches patches =
      parsed(parabola() +
             "o body\nl 1/1 2/7 3\ng tail\nl -1 -2 -3\ng tail\nl 1 3 \\\n 5 1 # x\n"
             "g\nl 2 3 4\nvn 0 0 1\nusemtl red\ns off\n");
  REQUIRE(patches.size() == 4);
  CHECK(numbers(patches[0]) == "1 2 3 ");
  CHECK(numbers(patches[1]) == "6 5 4 ");
  CHECK(numbers(patches[2]) == "1 3 5 1 ");
  CHECK(patches[0].name == "body");
  CHECK(patches[0].family == "body");
  CHECK(patches[1].name == "tail");
  CHECK(patches[2].name == "tail 2");
  CHECK(patches[2].family == "tail");
  CHECK(patches[3].name == "curve 4");
  CHECK(patches[3].family.empty());
  for (const Patch& patch : patches) {
    CHECK(patch.nj == 1);
    CHECK(patch.at(0, 0).z() == 0.5);
    CHECK(patch.file == "shape.obj");
  }
}

TEST_CASE("obj: lines of two vertices are chained as the first of them runs") {
  const auto chain = [](const std::string& lines) {
    std::string text;
    for (const Patch& patch : parsed(parabola() + lines)) text += numbers(patch) + "| ";
    return text;
  };
  CHECK(chain("l 1 2\nl 2 3\nl 3 4\n") == "1 2 3 4 | ");
  CHECK(chain("l 3 2\nl 1 2\nl 3 4\n") == "4 3 2 1 | ");
  CHECK(chain("l 2 3\nl 4 3\nl 1 4\nl 1 2\n") == "2 3 4 1 2 | ");
  // three meet in 2: each arm ends there, and a loop that begins there comes back to it
  CHECK(chain("l 1 2\nl 2 3\nl 3 4\nl 2 5\n") == "1 2 | 2 3 4 | 2 5 | ");
  CHECK(chain("l 1 2\nl 2 3\nl 3 4\nl 4 2\n") == "1 2 | 2 3 4 2 | ");
  CHECK(chain("l 1 2\nl 1 2\n") == "1 2 1 | ");
  // not across groups, nor with longer polylines
  CHECK(chain("g a\nl 1 2\ng b\nl 2 3\n") == "1 2 | 2 3 | ");
  CHECK(chain("l 1 2\nl 2 3 4\nl 4 5\nl 5 6\n") == "1 2 | 2 3 4 | 4 5 6 | ");
}

TEST_CASE("obj: a face gives its outline, closed and counter-clockwise") {
  const std::string square = "v 0 0 2\nv 1 0 2\nv 1 1 2\nv 0 1 2\n";
  for (const char* face : {"f 1 2 3 4\n", "f 4 3 2 1\n", "f 1//1 2//1 3//1 3//1 4//1 1//1\n"}) {
    const Patches patches = parsed(square + face);
    CAPTURE(face);
    REQUIRE(patches.size() == 1);
    CHECK(patches[0].ni == 5);
    CHECK(patches[0].points_world.front() == patches[0].points_world.back());
    CHECK(enclosed_area(patches[0].points_world) == 1.0);
    CHECK(patches[0].at(0, 0).z() == 2.0);
  }
}

TEST_CASE("obj: what is no plane curve is refused with its line, its value and the remedy") {
  const std::string p = parabola();
  CHECK(contains(refusal(""), "shape.obj: holds no line"));
  CHECK(contains(refusal(p + "l 1 7\n"), "shape.obj, line 7: 7 is no vertex, of the 6"));
  CHECK(contains(refusal(p + "l 1 0\n"), "line 7: \"0\" is no vertex"));
  CHECK(contains(refusal(p + "l 1 -7\n"), "\"-7\" is no vertex, of the 6 so far"));
  CHECK(contains(refusal(p + "l 1 9223372036854775808\n"), "is no vertex"));
  CHECK(contains(refusal(p + "l 1 -9223372036854775808\n"), "is no vertex"));
  CHECK(contains(refusal(p + "l 1 9223372036854775807\n"), "is no vertex"));
  CHECK(contains(refusal(p + "l 1\n"), "'l' names 1 vertices; it takes 2 at least"));
  CHECK(contains(refusal(p + "f 1 2\n"), "'f' names 2 vertices; it takes 3 at least"));
  CHECK(contains(refusal(p + "l 3 3\n"), "line 7: a polyline of one point"));
  CHECK(contains(refusal(p + "f 1 2 1\n"), "encloses no area"));
  CHECK(contains(refusal(p + "f 1 2 3\nf 2 3 4\n"), "line 8: a second face"));
  CHECK(contains(refusal(p + "f 1 2 3\nl 2 3 4\n"), "line 7: a face ('f') in a file that has"));
  CHECK(contains(refusal("v 1 2\nl 1 1\n"), "line 1: a vertex of 2 numbers"));
  CHECK(contains(refusal("v 1 nan 0\n"), "y = \"nan\" is not a finite number"));
  CHECK(contains(refusal("v 0 0 0\nv 1 0 1\nv 2 0 5\nl 1 2 3\n"),
                 "its vertices lie in the plane y = 0, and curves lie in a plane z = const; "
                 "exchange its axes"));
  CHECK(contains(refusal("v 0 0 0\nv 1 3 1\nv 2 0 5\nl 1 2 3\n"), "z goes from 0 to 5"));
  // a vertex that nobody uses may lie anywhere
  CHECK(parsed("v 0 0 0\nv 1 0 0\nv 2 0 5\nl 1 2\n").size() == 1);
}

TEST_CASE("obj: files by others give the outlines they are named after") {
  const auto data = test::shared_data();
  if (!data || !std::filesystem::is_directory(std::filesystem::path(*data) / "airfoil")) {
    MESSAGE("skipped: ../shared/data/airfoil is absent");
    return;
  }
  const auto folder = std::filesystem::path(*data) / "airfoil";
  // The letter E of 12 corners: a spine of 2 x 10, arms of 4, 2 and 4 by 2.
  const Patches letter = read_obj_curves(folder / "cino_E.obj");
  REQUIRE(letter.size() == 1);
  CHECK(letter[0].ni == 13);
  CHECK(enclosed_area(letter[0].points_world) == 2 * 10 + 2 * (4 + 2 + 4));
  for (const auto& [name, vertices] :
       {std::pair{"fcpw_plus-shape.obj", 96}, std::pair{"fcpw_spiral.obj", 222}}) {
    CAPTURE(name);
    const Patches patches = read_obj_curves(folder / name);
    REQUIRE(patches.size() == 1);
    CHECK(patches[0].ni == vertices + 1);
    CHECK(patches[0].points_world.front() == patches[0].points_world.back());
    CHECK(enclosed_area(patches[0].points_world) > 0);
  }
}
