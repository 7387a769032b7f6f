#include <cgnslib.h>
#include <doctest/doctest.h>

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <optional>
#include <random>
#include <string>
#include <string_view>

#include "io/cgns_round.h"
#include "support/full_disk.h"
#include "support/temp_folder.h"
#include "vdb_offset/core/error.h"
#include "vdb_offset/io/cgns.h"
#include "vdb_offset/surface/example.h"

namespace vdb_offset::test {
namespace {

void put_bytes(const std::filesystem::path& file, const std::string& bytes) {
  std::ofstream(file, std::ios::binary)
      .write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
}

/// Points read; nothing if the file is refused. Any other exception fails the test.
std::optional<std::size_t> points_read(const std::filesystem::path& file) {
  try {
    inspect_cgns(file);
    return read_cgns_mesh(file).points();
  } catch (const IoError&) {
    return std::nullopt;
  }
}

MultiBlock small_mesh() { return any_mesh(build_surface(polar_ball()), 2); }

/// The same file in the older container.
void to_adf(const std::filesystem::path& from, const std::filesystem::path& to) {
  int file = 0;
  REQUIRE(cg_open(from.c_str(), CG_MODE_READ, &file) == CG_OK);
  REQUIRE(cg_save_as(file, to.c_str(), CG_FILE_ADF, 0) == CG_OK);
  REQUIRE(cg_close(file) == CG_OK);
}

/// Opens a file to change it; zone 1 of base 1.
class Changed {
 public:
  explicit Changed(const std::filesystem::path& file) {
    REQUIRE(cg_open(file.c_str(), CG_MODE_MODIFY, &file_) == CG_OK);
  }
  ~Changed() { cg_close(file_); }
  Changed(const Changed&) = delete;
  Changed& operator=(const Changed&) = delete;
  int file() const { return file_; }
  void remove(const char* parent, const std::string& name) {
    REQUIRE(cg_goto(file_, 1, "Zone_t", 1, parent, 1, "end") == CG_OK);
    CHECK(cg_delete_node(name.c_str()) == CG_OK);
  }

 private:
  int file_ = 0;
};

TEST_CASE("cgns: the older container is read as the newer is") {
  const TempFolder folder;
  const MultiBlock mesh = small_mesh();
  write_cgns(folder / "mesh.cgns", mesh);
  to_adf(folder / "mesh.cgns", folder / "adf.cgns");
  CHECK(inspect_cgns(folder / "adf.cgns").container == "ADF");
  check_same(zone_mesh(mesh), read_cgns_mesh(folder / "adf.cgns"));
}

TEST_CASE("cgns: connectivity that does not fit is a fault by name, not an error") {
  const TempFolder folder;
  const auto file = folder / "mesh.cgns";
  write_cgns(file, small_mesh());
  REQUIRE(read_cgns_mesh(file).interfaces.size() == 1);
  SUBCASE("in one zone alone") {
    Changed(file).remove("ZoneGridConnectivity_t", "to ball-2");
    const ZoneMesh read = read_cgns_mesh(file);
    CHECK(read.interfaces.size() == 1);
    REQUIRE(read.faults.size() == 1);
    CHECK(read.faults[0] == "zone 'ball': 'to ball' has no counterpart in the donor 'ball'");
  }
  SUBCASE("a donor that is no zone, ranges off faces, a transform that does not fit") {
    {
      const Changed changed(file);
      constexpr std::array<int, 3> kSame{1, 2, 3};
      constexpr std::array<int, 3> kTurned{1, -2, 3};
      const std::array<cgsize_t, 6> side{1, 1, 1, 1, 7, 3};
      const std::array<cgsize_t, 6> inner{2, 1, 1, 2, 7, 3};
      int index = 0;
      const auto add = [&](const char* name, const char* donor, const auto& range,
                           const auto& donor_range, const auto& transform) {
        CHECK(cg_1to1_write(changed.file(), 1, 1, name, donor, range.data(), donor_range.data(),
                            transform.data(), &index) == CG_OK);
      };
      add("stranger", "bell", side, side, kSame);
      add("inner", "ball", inner, side, kSame);
      add("no donor's", "ball", side, inner, kSame);
      add("turned", "ball", side, side, kTurned);
    }
    const ZoneMesh read = read_cgns_mesh(file);
    CHECK(read.interfaces.size() == 1);
    CHECK(read.faults.size() == 4);
    for (const char* name : {"stranger", "inner", "no donor's", "turned"}) {
      CHECK(std::ranges::count_if(read.faults, [&](const std::string& fault) {
              return fault.find("'" + std::string(name) + "'") != std::string::npos;
            }) == 1);
    }
  }
}

TEST_CASE("cgns: files that are cut are refused, unless nothing but padding is gone") {
  const TempFolder folder;
  write_cgns(folder / "mesh.cgns", small_mesh());
  to_adf(folder / "mesh.cgns", folder / "adf.cgns");
  for (const char* name : {"mesh.cgns", "adf.cgns"}) {
    const std::string bytes = file_bytes(folder / name);
    int refused = 0;
    constexpr std::size_t kCuts = 40;
    for (std::size_t cut = 0; cut < kCuts; ++cut) {
      put_bytes(folder / "cut.cgns", bytes.substr(0, cut * bytes.size() / kCuts));
      if (points_read(folder / "cut.cgns")) {
        check_same(zone_mesh(small_mesh()), read_cgns_mesh(folder / "cut.cgns"));
      } else {
        ++refused;
      }
    }
    CHECK(refused >= 36);
  }
}

TEST_CASE("cgns: damaged files are read or refused, and never hold more than they have room for") {
  const TempFolder folder;
  write_cgns(folder / "mesh.cgns", small_mesh());
  to_adf(folder / "mesh.cgns", folder / "adf.cgns");
  std::mt19937 random(7);
  for (const char* name : {"mesh.cgns", "adf.cgns"}) {
    const std::string whole = file_bytes(folder / name);
    int refused = 0;
    for (int round = 0; round < 150; ++round) {
      std::string bytes = whole;
      const int changes = 1 + static_cast<int>(random() % 20);
      for (int n = 0; n < changes; ++n) {
        bytes[random() % bytes.size()] = static_cast<char>(round % 2 == 0 ? 0xFF : random());
      }
      put_bytes(folder / "damaged.cgns", bytes);
      const auto points = points_read(folder / "damaged.cgns");
      refused += points ? 0 : 1;
      if (points) CHECK(*points <= bytes.size());
    }
    CHECK(refused > 0);
  }
}

TEST_CASE("cgns: files with a node that cannot be opened are inspected, or refused") {
  const TempFolder folder;
  write_cgns(folder / "mesh.cgns", small_mesh());
  const std::string whole = file_bytes(folder / "mesh.cgns");
  constexpr std::string_view kHeader = "OHDR";  // of an object, with a checksum behind
  int damaged = 0;
  int inspected = 0;
  for (std::size_t at = whole.find(kHeader); at != std::string::npos;
       at = whole.find(kHeader, at + 1)) {
    std::string bytes = whole;
    bytes[at + 8] = static_cast<char>(~bytes[at + 8]);
    put_bytes(folder / "damaged.cgns", bytes);
    ++damaged;
    try {
      inspected += inspect_cgns(folder / "damaged.cgns").zones.empty() ? 0 : 1;
    } catch (const IoError&) {
    }
  }
  CHECK(damaged > 20);
  CHECK(inspected > 0);  // what is not looked at may be damaged
  CHECK(inspected < damaged);
}

TEST_CASE("cgns: what cannot be opened leaves HDF5 nothing to trip over as the program ends") {
  const std::string self = std::filesystem::read_symlink("/proc/self/exe");
  const std::string command =
      "'" + self + "' -tc='cgns: files with a node that cannot be opened*' 2>&1";
  FILE* const pipe = ::popen(command.c_str(), "r");
  REQUIRE(pipe != nullptr);
  std::string said;
  for (int c = std::fgetc(pipe); c != EOF; c = std::fgetc(pipe)) said += static_cast<char>(c);
  CHECK(::pclose(pipe) == 0);
  CAPTURE(said);
  CHECK(said.find("1 passed") != std::string::npos);
  CHECK(said.find("infinite") == std::string::npos);
}

TEST_CASE("cgns: what libcgns asserts of a damaged head ends no run") {
  const TempFolder folder;
  write_cgns(folder / "mesh.cgns", small_mesh());
  to_adf(folder / "mesh.cgns", folder / "adf.cgns");
  const std::string whole = file_bytes(folder / "adf.cgns");
  constexpr std::size_t kHead = 186;
  int refused = 0;
  for (std::size_t at = 0; at < kHead; ++at) {
    std::string bytes = whole;
    bytes[at] = '~';
    put_bytes(folder / "damaged.cgns", bytes);
    refused += points_read(folder / "damaged.cgns") ? 0 : 1;
  }
  CHECK(refused > 0);
  put_bytes(folder / "damaged.cgns", whole.substr(0, 20));  // shorter than any head
  CHECK_THROWS_AS(read_cgns(folder / "damaged.cgns"), IoError);
}

TEST_CASE("cgns: a file of a newer HDF5, or of another kind, is refused with what to do") {
  const TempFolder folder;
  write_cgns(folder / "mesh.cgns", small_mesh());
  std::string bytes = file_bytes(folder / "mesh.cgns");
  bytes[8] = 9;  // the version of the superblock
  put_bytes(folder / "newer.cgns", bytes);
  CHECK_THROWS_WITH_AS(read_cgns(folder / "newer.cgns"), doctest::Contains("h5repack"), IoError);
  put_bytes(folder / "text.cgns", std::string(5000, 'x'));
  CHECK_THROWS_WITH_AS(read_cgns(folder / "text.cgns"), doctest::Contains("neither HDF5 nor ADF"),
                       IoError);
  put_bytes(folder / "empty.cgns", "");
  CHECK_THROWS_AS(read_cgns(folder / "empty.cgns"), IoError);
  CHECK_THROWS_WITH_AS(read_cgns(folder / "none.cgns"), doctest::Contains("does not exist"),
                       IoError);
  CHECK_THROWS_WITH_AS(read_cgns(folder / ""), doctest::Contains("regular"), IoError);
}

TEST_CASE("cgns: a zone that says it is larger than its points is refused before room is made") {
  const TempFolder folder;
  const auto file = folder / "huge.cgns";
  int index = 0;
  int base = 0;
  int zone = 0;
  int grid = 0;
  const std::array<cgsize_t, 9> size{30000, 30000, 30000, 29999, 29999, 29999, 0, 0, 0};
  REQUIRE(cg_set_file_type(CG_FILE_HDF5) == CG_OK);
  REQUIRE(cg_open(file.c_str(), CG_MODE_WRITE, &index) == CG_OK);
  REQUIRE(cg_base_write(index, "Base", 3, 3, &base) == CG_OK);
  REQUIRE(cg_zone_write(index, base, "huge", size.data(), CGNS_ENUMV(Structured), &zone) == CG_OK);
  REQUIRE(cg_grid_write(index, base, zone, "GridCoordinates", &grid) == CG_OK);
  REQUIRE(cg_goto(index, base, "Zone_t", zone, "GridCoordinates_t", 1, "end") == CG_OK);
  const std::array<cgsize_t, 3> small{2, 2, 2};
  const std::array<double, 8> values{};
  CHECK(cg_array_write("CoordinateX", CGNS_ENUMV(RealDouble), 3, small.data(), values.data()) ==
        CG_OK);
  REQUIRE(cg_close(index) == CG_OK);
  CHECK(inspect_cgns(file).zones.at(0).ni == 30000);
  CHECK_THROWS_WITH_AS(read_cgns_mesh(file), doctest::Contains("30000 x 30000 x 30000"), IoError);
}

TEST_CASE("cgns: on a full disk the old file stays, and nothing beside it") {
  const TempFolder folder;
  const auto file = folder / "mesh.cgns";
  put_bytes(file, "old");
  {
    const FullDisk disk(1U << 20U);
    CHECK_THROWS_AS(write_cgns(file, wavy_plate(101, 101, 40)), IoError);
  }
  CHECK(file_bytes(file) == "old");
  CHECK(folder.listing() == std::vector<std::string>{"mesh.cgns"});
  write_cgns(file, small_mesh());  // and the library goes on
  CHECK(read_cgns_mesh(file).zones.size() == 1);
}

}  // namespace
}  // namespace vdb_offset::test
