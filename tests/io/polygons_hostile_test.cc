#include <doctest/doctest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <random>
#include <sstream>

#include "io/plot3d_grid.h"
#include "io/polygon_bytes.h"
#include "support/mutate.h"
#include "support/shapes.h"
#include "support/temp_folder.h"

using namespace vdb_offset;
using namespace vdb_offset::test;
using plot3d_test::contains;

namespace {

constexpr std::string_view kLetters = "0123456789.,-+eEn \n\r\\#vf/";

/// Read or refused; what is read holds together, and is no larger than the file. True if read.
bool is_sound_or_refused(const std::string& bytes, const std::string& name) {
  PolygonMesh mesh;
  try {
    mesh = read(bytes, name);
  } catch (const Error&) {
    return false;
  }
  if (mesh.faces() == 0) FAIL("nothing is read");
  if (mesh.first.back() != mesh.corners.size()) FAIL("faces end where corners do not");
  if (!mesh.family.empty() && mesh.family.size() != mesh.faces()) FAIL("families of other faces");
  if (mesh.corners.size() > bytes.size()) FAIL("more corners than bytes");
  if (mesh.points_world.size() > bytes.size()) FAIL("more points than bytes");
  for (const int corner : mesh.corners) {
    if (corner < 0 || static_cast<std::size_t>(corner) >= mesh.points_world.size())
      FAIL("no point");
    if (!mesh.points_world[static_cast<std::size_t>(corner)].allFinite()) FAIL("not finite");
  }
  return true;
}

struct Sample {
  std::string name;
  std::string bytes;
};

std::vector<Sample> samples() {
  return {{"text.stl", kTextStl + "solid b" + kTextStl.substr(kTextStl.find('\n'))},
          {"binary.stl", binary_stl("solid", kTwoTriangles)},
          {"a.ply", ascii_ply()},
          {"little.ply", binary_ply(false)},
          {"big.ply", binary_ply(true)},
          {"a.obj",
           "o a\nv 0 0 0\nv 1 0 0\nv 1 1 0\nf 1 2/1 3//1\ng b\nf -1 -2 \\\n -3 4\n"
           "v 0 1 0 1 0 0\nusemtl c\nf 1 2 3 4\n"},
          {"a.off", "COFF # c\n4 2 0\n0 0 0 1 1 1\n1 0 0\n1 1 0\n0 1 0\n3 0 1 2\n4 0 1 2 3 7\n"}};
}

std::filesystem::path data_folder(const char* name) {
  const auto data = shared_data();
  return data ? std::filesystem::path(*data) / name : std::filesystem::path();
}

/// The words behind `word` in a line, to the next semicolon; empty without one.
long number_before(const std::string& text, const std::string& word) {
  const std::size_t at = text.find(" " + word);
  if (at == std::string::npos) return -1;
  const std::size_t begin = text.find_last_of(" \t", at - 1) + 1;
  return std::stol(text.substr(begin, at - begin));
}

}  // namespace

TEST_CASE("polygons: files cut off at any byte are read as sound polygons or refused") {
  for (const Sample& sample : samples()) {
    CAPTURE(sample.name);
    CHECK(is_sound_or_refused(sample.bytes, sample.name));
    int read = 0;
    for (std::size_t length = 0; length < sample.bytes.size(); ++length) {
      read += is_sound_or_refused(sample.bytes.substr(0, length), sample.name);
    }
    // Only text may lose its end and be whole; .obj does not say where it ends.
    CHECK(read <= (sample.name == "a.obj" ? 60 : 30));
    if (sample.name == "binary.stl" || sample.name == "big.ply") CHECK(read == 0);
  }
}

TEST_CASE("polygons: files in seeded mutations are read as sound polygons or refused") {
  for (const Sample& sample : samples()) {
    CAPTURE(sample.name);
    std::mt19937 random(7);
    int good = 0;
    constexpr int kRounds = 5000;
    for (int round = 0; round < kRounds; ++round) {
      std::string bytes = sample.bytes;
      for (unsigned n = 1 + random() % 4; n > 0 && !bytes.empty(); --n)
        mutate(bytes, random, kLetters);
      good += is_sound_or_refused(bytes, sample.name);
    }
    CHECK(good > 0);
    CHECK(good < kRounds);
  }
}

TEST_CASE("polygons: counts and lines without bound cost no more than the file's length") {
  const std::string digits(1'000'000, '9');
  CHECK(contains(said_of("OFF\n" + digits + " 1 0\n", "a.off"), "is no whole number"));
  CHECK(said_of("v " + digits + " 0 0\nf 1 1 1\n", "a.obj").size() < 300);
  std::string polygon = "v 0 0 0\nf";
  for (int n = 0; n < 300'000; ++n) polygon += " 1";
  CHECK(read(polygon, "a.obj").corners.size() == 300'000);
  std::string continued = "v 0 0 0\nf";
  for (int n = 0; n < 100'000; ++n) continued += " 1 \\\n";
  CHECK(read(continued, "a.obj").corners.size() == 100'000);
  CHECK(said_of(std::string(1'000'000, '\0'), "a.stl") != "");
  CHECK(said_of(std::string(1'000'000, '\xff'), "a.stl") != "");
  CHECK(said_of("solid\n" + std::string(1'000'000, 'x'), "a.stl").size() < 300);
  CHECK(said_of("ply\n" + std::string(1'000'000, '\n'), "a.ply") != "");
  const std::string elements =
      "ply\nformat ascii 1.0\nelement none 9000000000000000000\n"
      "element vertex 3\nproperty int x\nproperty int y\nproperty int z\n"
      "element face 1\nproperty list int int vertex_index\nend_header\n";
  CHECK(read(elements + "0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n", "a.ply").faces() == 1);
}

TEST_CASE("polygons: files by others have the counts that they are known to have") {
  const std::filesystem::path sources = data_folder("SOURCES.tsv");
  if (sources.empty() || !std::filesystem::exists(sources)) {
    MESSAGE("skipped: ../shared/data/SOURCES.tsv is absent");
    return;
  }
  int compared = 0;
  std::ifstream lines(sources);
  for (std::string line; std::getline(lines, line);) {
    const std::string file = line.substr(0, line.find('\t'));
    const std::string known = line.substr(line.rfind('\t') + 1);
    if (!file.starts_with("tri/") && !file.starts_with("quadobj/")) continue;
    CAPTURE(file);
    const PolygonMesh mesh = read(file_bytes(sources.parent_path() / file), file);
    CHECK(mesh.counted_from_one == (file == "quadobj/hedra_normalized_vase2_fat.off"));
    CHECK(static_cast<long>(mesh.faces()) == number_before(known, "faces"));
    // Of STL, vertices were counted where they differ.
    if (!file.ends_with(".stl")) {
      CHECK(static_cast<long>(mesh.points_world.size()) == number_before(known, "verts"));
    }
    ++compared;
  }
  CHECK(compared >= 19);
}

TEST_CASE("polygons: odd files by others are read or refused, and so in seeded mutations") {
  const std::filesystem::path folder = data_folder("malformed");
  if (folder.empty() || !std::filesystem::is_directory(folder)) {
    MESSAGE("skipped: ../shared/data/malformed is absent");
    return;
  }
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    const std::string name = entry.path().filename().string();
    CAPTURE(name);
    const std::string bytes = file_bytes(entry.path());
    is_sound_or_refused(bytes, name);
    std::mt19937 random(11);
    for (int round = 0; round < 20 && !bytes.empty(); ++round) {
      std::string changed = bytes;
      mutate(changed, random, kLetters);
      is_sound_or_refused(changed, name);
    }
  }
}
