#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <string>
#include <string_view>

#include "io/airfoil_parse.h"
#include "io/obj_parse.h"
#include "io/plot3d_grid.h"
#include "support/mutate.h"
#include "support/shapes.h"

using namespace vdb_offset;
using plot3d_test::contains;
using plot3d_test::io_error;

namespace {

constexpr std::string_view kLetters = "0123456789.,-+eED \n\\#lvf/";

using Read = Patches (*)(const std::string&);

Patches as_airfoil(const std::string& bytes) {
  AirfoilInfo info;
  return read_airfoil_bytes(bytes, "a.dat", info);
}
Patches as_obj(const std::string& bytes) { return read_obj_curves_bytes(bytes, "a.obj"); }

/// Read or refused; what is read is sound, and no larger than the file. True if read.
bool is_sound_or_refused(Read read, const std::string& bytes) {
  Patches patches;
  try {
    patches = read(bytes);
  } catch (const IoError&) {
    return false;
  }
  std::size_t points = 0;
  for (const Patch& patch : patches) {
    points += patch.points_world.size();
    if (patch.nj != 1 || patch.ni < 2) FAIL("a curve of " << patch.ni << " x " << patch.nj);
    if (static_cast<std::size_t>(patch.ni) != patch.points_world.size()) FAIL("not its size");
    for (std::size_t n = 0; n < patch.points_world.size(); ++n) {
      if (!patch.points_world[n].allFinite()) FAIL("not finite");
      if (n > 0 && patch.points_world[n] == patch.points_world[n - 1]) FAIL("repeated");
    }
  }
  if (patches.empty() || points > bytes.size()) FAIL(points << " points");
  return true;
}

void mutate_often(Read read, const std::string& whole, int rounds) {
  std::mt19937 random(7);
  int good = 0;
  for (int round = 0; round < rounds; ++round) {
    std::string bytes = whole;
    for (unsigned n = 1 + random() % 4; n > 0 && !bytes.empty(); --n)
      test::mutate(bytes, random, kLetters);
    good += is_sound_or_refused(read, bytes);
  }
  CHECK(good > 0);
  CHECK(good < rounds);
}

std::string ellipse_points(int count, const char* word, const char* end) {
  std::string text;
  for (int k = 0; k < count; ++k) {
    const double angle = 6.283185307179586 * k / count;
    text += fmt::format("{}{:.6f} {:.6f}{}\n", word, 0.5 + 0.5 * std::cos(angle),
                        0.1 * std::sin(angle), end);
  }
  return text;
}

}  // namespace

TEST_CASE("curves: damaged files are read as sound curves or refused") {
  const std::string halves = "0 0\n.3 .1\n.6 .1\n1 .01\n\n0 0\n.3 -.1\n.6 -.1\n1 -.01\n";
  mutate_often(as_airfoil, ellipse_points(30, "", ""), 5000);
  mutate_often(as_airfoil, halves, 5000);
  mutate_often(as_airfoil, "name\n4. 4.\n\n" + halves, 5000);
  const std::string vertices = ellipse_points(12, "v ", " 0");
  mutate_often(as_obj, vertices + "o a\nf 1 2 3 4 5 6 7 8 9 10 11 12\n", 5000);
  mutate_often(as_obj, vertices + "l 1 2\nl 2 3\nl 3 1\ng b\nl 4 -1 5/3 6//2\nl 7 8\nl 9 8\n",
               5000);
}

TEST_CASE("curves: files by others in seeded mutations are read as sound curves or refused") {
  const auto data = test::shared_data();
  if (!data || !std::filesystem::is_directory(std::filesystem::path(*data) / "airfoil")) {
    MESSAGE("skipped: ../shared/data/airfoil is absent");
    return;
  }
  for (const auto& entry :
       std::filesystem::directory_iterator(std::filesystem::path(*data) / "airfoil")) {
    CAPTURE(entry.path().filename().string());
    const bool obj = entry.path().extension() == ".obj";
    mutate_often(obj ? as_obj : as_airfoil, test::file_bytes(entry.path()), 1000);
  }
}

TEST_CASE("curves: hostile airfoils are refused with file, line, value and remedy") {
  const auto said = [](const std::string& text) { return io_error([&] { as_airfoil(text); }); };
  const std::string tail = "1 0\n.5 .1\n0 0\n.5 -.1\n";
  CHECK(contains(said(""), "a.dat: holds no points"));
  CHECK(contains(said("name\n"), "a.dat: holds no points"));
  CHECK(contains(said("1 0\n"), "a.dat: its points (1, 1 of them different from the one before)"));
  CHECK(contains(said("1 0\n0 0\n1 0\n"), "enclose no area"));
  CHECK(contains(said("1 nan\n" + tail), "a.dat, line 1: y = \"nan\" is not finite"));
  CHECK(contains(said(tail + "1e999 0\n"), "a.dat, line 5: x = \"1e999\" is not finite"));
  CHECK(contains(said(tail + "-inf 0\n"), "line 5: x = \"-inf\" is not finite"));
  CHECK(contains(said(tail + "once upon\n"), "line 5: x = \"once\" is not a number"));
  CHECK(contains(said(tail + "once upon a time\n"), "line 5: holds 4 words or numbers"));
  CHECK(contains(said("x\n4 4\n" + tail), "line 2: counts 4 and 4 points, and 4 follow"));
  CHECK(contains(said("x\n1e300 1e90\n" + tail), "line 2: x = \"1e300\" is not finite"));
  CHECK(contains(said("x\n1e90 1e90\n" + tail), "counts 1e+90 and 1e+90 points, and 4 follow"));
  CHECK(
      contains(said("x\n2 3\n\n0 0\n.5 .1\n1 0\n\n0 0\n1 0\n"), "line 4: begins 3 points where 2"));
  CHECK(contains(said(tail + "\n7 0\n8 0\n"), "line 6: the second surface begins at (7, 0)"));
  CHECK(contains(said("1 0\n\n2 0\n\n3 0\n"), "line 5: begins the third of 3 groups"));
  CHECK(contains(said(std::string(1000, '\0')), "holds no points"));
  const std::string digits(10'000'000, '7');
  CHECK(contains(said("1 0\n" + digits + " 0\n"), "line 2: x = \"7777"));
  CHECK(contains(said("1 0\n" + digits + " 0\n"), "...\" is not finite"));
  CHECK(said("1 0\n" + digits + " 0\n").size() < 300);
  CHECK(said("1 0\n0.5 0." + digits + "\n0 0\n0.5 -0.1\n").empty());  // a number, if a long one
}
