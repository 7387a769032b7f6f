#include <doctest/doctest.h>
#include <sys/resource.h>

#include <algorithm>
#include <cstdlib>
#include <map>
#include <optional>
#include <random>
#include <string>
#include <string_view>
#include <vector>

#include "io/plot3d_grid.h"
#include "io/plot3d_parse.h"
#include "support/mutate.h"
#include "vdb_offset/core/error.h"

using namespace vdb_offset;
using namespace plot3d_test;

namespace {

constexpr std::string_view kLetters = "0123456789*,-+eED. \n";

/// Points read; nothing if the bytes are refused. Any other exception fails the test.
std::optional<std::size_t> points_read(const std::string& bytes, const Plot3dHint& hint = {}) {
  try {
    std::size_t points = 0;
    for (const Patch& patch : read_plot3d_bytes(bytes, "grid", hint)) {
      points += patch.points_world.size();
    }
    return points;
  } catch (const IoError&) {
    return std::nullopt;
  }
}

/// Read or refused, and never more points than bytes; true if read.
bool is_bounded_and_read(const std::string& bytes, const Plot3dHint& hint = {}) {
  const std::optional<std::size_t> points = points_read(bytes, hint);
  if (points && *points > bytes.size()) FAIL("more points than bytes");
  return points.has_value();
}

std::string small_file(const Plot3dDialect& dialect) {
  std::vector<Plot3dBlockSize> sizes = {{3, 2, 1}, {1, 2, 2}};
  if (dialect.two_dimensional) sizes[1] = {2, 2, 1};
  if (!dialect.multi_block) sizes.pop_back();
  return encode(dialect, make_grid(sizes, dialect.two_dimensional));
}

long peak_kib() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return usage.ru_maxrss;
}

}  // namespace

TEST_CASE("plot3d: a small file cut at every byte is read or refused") {
  for (const Plot3dDialect& dialect : all_dialects()) {
    const std::string whole = small_file(dialect);
    CAPTURE(dialect.describe());
    CHECK(whole.size() < 4096);
    CHECK(is_bounded_and_read(whole));
    const std::size_t last = dialect.formatted ? whole.find_last_of(' ') + 1 : whole.size();
    const Plot3dHint told = hint_of(dialect);
    for (std::size_t length = 0; length < whole.size(); ++length) {
      const std::string cut = whole.substr(0, length);
      const bool read = is_bounded_and_read(cut);
      // Record marks tell of every cut; a C stream or text may end where another dialect would.
      if (!dialect.formatted && dialect.records) CHECK_FALSE(read);
      // A dialect that is told leaves no doubt, digits missing from the last number aside.
      if (is_bounded_and_read(cut, told)) CHECK(length > last);
    }
  }
}

TEST_CASE("plot3d: one block that lacks a number is not taken for a single block on its side") {
  const Grid grid = make_grid({{3, 4, 1}}, false);
  const std::string text = encode(Plot3dDialect{}, grid);
  const std::string cut_text = text.substr(0, text.find_last_of(' '));
  CHECK_FALSE(points_read(cut_text).has_value());
  CHECK(points_read(cut_text, Plot3dHint::parse("single-block")) == 12);
  for (const bool big_endian : {false, true}) {
    const Plot3dDialect stream{false, false, false, big_endian};
    const std::string bytes = encode(stream, grid);
    CHECK(points_read(bytes) == 12);
    CHECK_FALSE(points_read(bytes.substr(0, bytes.size() - 4)).has_value());
  }
}

TEST_CASE("plot3d: a small file with any byte flipped is read or refused") {
  for (const Plot3dDialect& dialect : all_dialects()) {
    const std::string whole = small_file(dialect);
    CAPTURE(dialect.describe());
    int read = 0;
    int refused = 0;
    for (const int pattern : {0x01, 0x20, 0x80, 0xff}) {
      for (std::size_t at = 0; at < whole.size(); ++at) {
        std::string bytes = whole;
        bytes[at] = static_cast<char>(bytes[at] ^ pattern);
        (is_bounded_and_read(bytes) ? read : refused) += 1;
      }
    }
    // Flips in the coordinates mostly give other coordinates, flips in the sizes mostly nonsense.
    CHECK(read > 0);
    CHECK(refused > 0);
  }
}

TEST_CASE("plot3d: small files under any hint, and random bytes, are read or refused") {
  std::mt19937 random(11);
  const std::vector<Plot3dDialect> dialects = all_dialects();
  for (int round = 0; round < 20000; ++round) {
    std::string bytes = small_file(dialects[random() % dialects.size()]);
    for (unsigned n = random() % 4; n > 0 && !bytes.empty(); --n)
      test::mutate(bytes, random, kLetters);
    if (round % 10 == 0) {
      for (char& c : bytes) c = static_cast<char>(random());
    }
    Plot3dHint hint;
    if (random() % 2 == 0) hint.formatted = random() % 2 == 0;
    if (random() % 4 == 0) hint.records = random() % 2 == 0;
    if (random() % 4 == 0) hint.multi_block = random() % 2 == 0;
    if (random() % 4 == 0) hint.iblank = random() % 2 == 0;
    is_bounded_and_read(bytes, hint);
  }
}

TEST_CASE("plot3d: real files in 10,000 seeded mutations are read or refused") {
  const std::filesystem::path folder = shared_folder();
  if (folder.empty()) {
    MESSAGE("skipped: ../shared/data/plot3d is absent");
    return;
  }
  const std::map<std::string, int> rounds = {{"bwb.fmt", 700},
                                             {"m6_small.fmt", 700},
                                             {"uneven_sphere.fmt", 1400},
                                             {"even_sphere.fmt", 1400},
                                             {"rae2822_p3d.xyz", 1400},
                                             {"vtk_bluntfinxyz.bin", 700},
                                             {"vtk_multi-ascii.xyz", 800},
                                             {"vtk_multi-bin-2D.xyz", 1400},
                                             {"vtk_multi-bin-C.xyz", 700},
                                             {"vtk_multi-bin.xyz", 800}};
  // For a long hunt: VDB_OFFSET_MUTATIONS=10000 takes that many of each file.
  const char* each = std::getenv("VDB_OFFSET_MUTATIONS");
  std::mt19937 random(2024);
  int total = 0;
  int read = 0;
  for (const auto& [name, share] : rounds) {
    const int count = each != nullptr ? std::stoi(each) : share;
    const std::string whole = file_bytes(folder / name);
    REQUIRE(!whole.empty());
    for (int round = 0; round < count; ++round, ++total) {
      std::string bytes = whole;
      for (unsigned n = 1 + random() % 4; n > 0 && !bytes.empty(); --n)
        test::mutate(bytes, random, kLetters);
      read += is_bounded_and_read(bytes);
    }
  }
  CHECK(total >= 10000);
  CHECK(read > 0);
  CHECK(read < total / 2);
}

TEST_CASE("plot3d: absurd counts and sizes in a header are refused before anything is allocated") {
  const long before = peak_kib();
  const std::string tail = " 0.5 0.5 0.5 0.5 0 0 1 1 0 0 0 0";
  for (const char* header :
       {"0", "-1 2 2 1", "1 0 2 1", "1 2 -2 1", "1 -2 -2 1", "2147483647 2 2 1",
        "1 2147483647 2147483647 1", "1 4294967296 4294967296 1", "1 3037000500 3037000500 1",
        "1 9223372036854775807 2 1", "1 18446744073709551618 2 1", "999999999999999999999 2 2 1",
        "1 2 2 4611686018427387905", "1000000000*1 2 2 1", "9000000000 9000000000*1",
        "1 100 100 1 30000*0.5", "1 100000 100000 1 30000000000*0.5", "1 2.0 2 1", "1e0 2 2 1"}) {
    CAPTURE(header);
    CHECK_FALSE(points_read(header + tail).has_value());
  }
  for (const Plot3dDialect& dialect : all_dialects()) {
    if (dialect.formatted) continue;
    const std::string whole = small_file(dialect);
    for (const unsigned evil :
         {0u, 1u, 0x7fffffffu, 0x80000000u, 0xffffffffu, 0x10000u, 0x40000000u}) {
      for (std::size_t at = 0; at + 4 <= 32; at += 4) {
        std::string bytes = whole;
        for (unsigned b = 0; b < 4; ++b) bytes[at + b] = static_cast<char>(evil >> 8 * b);
        is_bounded_and_read(bytes);
      }
    }
  }
#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
  CHECK(peak_kib() - before < 16 * 1024);
#else
  CHECK(peak_kib() >= before);
#endif
}

TEST_CASE(
    "plot3d: a message names the file, the nearest dialect, the byte, the value, the remedy") {
  Plot3dDialect dialect;
  dialect.formatted = false;
  std::string bytes = small_file(dialect);
  const std::size_t length = bytes.size();
  const auto said = [&bytes] {
    return io_error([&bytes] { read_plot3d_bytes(bytes, "wing.xyz"); });
  };
  bytes.pop_back();
  const std::string cut = said();
  CAPTURE(cut);
  CHECK(contains(cut,
                 "wing.xyz: no PLOT3D dialect fits; the nearest is Fortran records, double, "
                 "little-endian, multi-block, 3-D, but its sizes (blocks: 2, points: 10) need " +
                     std::to_string(length) + " bytes, and the file has " +
                     std::to_string(length - 1)));
  CHECK(contains(cut, "force the dialect with --input-format"));
  bytes = small_file(dialect);
  bytes[16] = static_cast<char>(-3);
  bytes[17] = bytes[18] = bytes[19] = static_cast<char>(-1);
  const std::string negative = said();
  CAPTURE(negative);
  CHECK(contains(negative, "a block's size, byte 16, is -3, and must be at least 1"));
}
