#include "io/output_file.h"

#include <doctest/doctest.h>
#include <sys/stat.h>

#include "support/full_disk.h"
#include "support/temp_folder.h"
#include "vdb_offset/core/error.h"

namespace vdb_offset::test {
namespace {

using Names = std::vector<std::string>;

void put(const std::filesystem::path& file, const std::string& text) {
  std::ofstream(file) << text;
}

TEST_CASE("output file: the old file stays until commit, and for good without it") {
  const TempFolder folder;
  put(folder / "a.txt", "old");
  {
    OutputFile output(folder / "a.txt");
    output.stream() << "new";
    CHECK(file_bytes(folder / "a.txt") == "old");
  }
  CHECK(folder.listing() == Names{"a.txt"});
  CHECK(file_bytes(folder / "a.txt") == "old");
  OutputFile output(folder / "a.txt");
  output.stream() << "new";
  output.commit();
  CHECK(file_bytes(folder / "a.txt") == "new");
  CHECK(folder.listing() == Names{"a.txt"});
}

TEST_CASE("output file: a full disk is an error that names the file, and the old file survives") {
  const TempFolder folder;
  put(folder / "a.txt", "old");
  {
    OutputFile output(folder / "a.txt");
    const FullDisk full(1000);
    output.stream() << std::string(100000, 'x');
    const std::string name = (folder / "a.txt").string();
    CHECK_THROWS_WITH_AS(output.commit(), (name + ": writing failed (is the disk full?)").c_str(),
                         IoError);
  }
  CHECK(folder.listing() == Names{"a.txt"});
  CHECK(file_bytes(folder / "a.txt") == "old");
}

TEST_CASE("output file: through a link the target is replaced, and the link stays one") {
  const TempFolder folder;
  std::filesystem::create_directory(folder / "there");
  const auto link = folder / "link.txt";
  SUBCASE("to a file in another folder") {
    put(folder / "there/target.txt", "old");
    std::filesystem::create_symlink("there/target.txt", link);
  }
  SUBCASE("to a link to a file") {
    put(folder / "there/target.txt", "old");
    std::filesystem::create_symlink("target.txt", folder / "there/second.txt");
    std::filesystem::create_symlink("there/second.txt", link);
  }
  SUBCASE("to a link to nothing: the file is made") {
    std::filesystem::create_symlink("target.txt", folder / "there/second.txt");
    std::filesystem::create_symlink("there/second.txt", link);
  }
  const Names before = folder.listing();
  {
    OutputFile output(link);
    CHECK(output.part().parent_path().filename() == "there");
  }
  CHECK(folder.listing() == before);
  OutputFile output(link);
  output.stream() << "new";
  output.commit();
  CHECK(std::filesystem::is_symlink(link));
  CHECK(file_bytes(link) == "new");
  CHECK(std::filesystem::is_regular_file(
      std::filesystem::symlink_status(folder / "there/target.txt")));
  CHECK(file_bytes(folder / "there/target.txt") == "new");
}

TEST_CASE("output file: what is no regular file is refused by name, and left alone") {
  const TempFolder folder;
  const auto name = folder / "a.txt";
  SUBCASE("a FIFO") { REQUIRE(::mkfifo(name.c_str(), 0600) == 0); }
  SUBCASE("a link to a FIFO") {
    REQUIRE(::mkfifo((folder / "fifo").c_str(), 0600) == 0);
    std::filesystem::create_symlink("fifo", name);
  }
  SUBCASE("a folder") { std::filesystem::create_directory(name); }
  SUBCASE("a link to a folder") { std::filesystem::create_symlink(".", name); }
  SUBCASE("links in a ring") {
    std::filesystem::create_symlink("b.txt", name);
    std::filesystem::create_symlink("a.txt", folder / "b.txt");
  }
  SUBCASE("a link into a folder that is not there") {
    std::filesystem::create_symlink("none/b.txt", name);
  }
  const Names before = folder.listing();
  const auto type = std::filesystem::symlink_status(name).type();
  std::string said;
  try {
    const OutputFile output(name);
  } catch (const IoError& error) {
    said = error.what();
  }
  CAPTURE(said);
  CHECK(said.find(name.string()) == 0);
  CHECK(folder.listing() == before);
  CHECK(std::filesystem::symlink_status(name).type() == type);
}

TEST_CASE("output file: a replaced file's permissions stay, from the first byte on") {
  const TempFolder folder;
  for (const mode_t mode : {0600U, 0444U, 0751U}) {
    CAPTURE(mode);
    put(folder / "a.txt", "old");
    REQUIRE(::chmod((folder / "a.txt").c_str(), mode) == 0);
    const auto bits = [](const std::filesystem::path& file) {
      return static_cast<mode_t>(std::filesystem::status(file).permissions());
    };
    OutputFile output(folder / "a.txt");
    CHECK((bits(output.part()) & ~(mode | 0200U)) == 0);
    output.commit();
    CHECK(bits(folder / "a.txt") == mode);
    std::filesystem::remove(folder / "a.txt");
  }
}

TEST_CASE("output folder: swapped in, but not kept, the old one comes back") {
  const TempFolder folder;
  std::filesystem::create_directory(folder / "out");
  put(folder / "out/p_old.x", "old");
  {
    OutputFolder output({folder / "out", "p_", ".x"});
    put(output.piece("new"), "new");
    CHECK(file_bytes(folder / "out/p_old.x") == "old");
    output.swap_in();
    CHECK(file_bytes(folder / "out/p_new.x") == "new");
  }
  CHECK(folder.listing() == Names{"out", "out/p_old.x"});
  CHECK(file_bytes(folder / "out/p_old.x") == "old");
}

TEST_CASE("output folder: kept, it replaces the old one") {
  const TempFolder folder;
  for (const char* name : {"first", "second"}) {
    OutputFolder output({folder / "out", "p_", ".x"});
    put(output.piece(name), name);
    output.swap_in();
    output.commit();
  }
  CHECK(folder.listing() == Names{"out", "out/p_second.x"});
}

TEST_CASE("output folder: a stranger's file that comes in meanwhile is not lost") {
  const TempFolder folder;
  std::filesystem::create_directory(folder / "out");
  OutputFolder output({folder / "out", "p_", ".x"});
  SUBCASE("before the swap, which is refused") {
    put(folder / "out/notes.txt", "mine");
    CHECK_THROWS_AS(output.swap_in(), IoError);
    CHECK(file_bytes(folder / "out/notes.txt") == "mine");
  }
  SUBCASE("after the swap: the old folder is not deleted") {
    output.swap_in();
    std::filesystem::path old;
    for (const std::string& name : folder.listing()) {
      if (name.find(".old-") != std::string::npos) old = folder / name;
    }
    REQUIRE(!old.empty());
    put(old / "notes.txt", "mine");
    output.commit();
    CHECK(file_bytes(old / "notes.txt") == "mine");
  }
}

}  // namespace
}  // namespace vdb_offset::test
