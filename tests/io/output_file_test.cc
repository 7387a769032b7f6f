#include "io/output_file.h"

#include <doctest/doctest.h>
#include <sys/resource.h>

#include <csignal>

#include "support/temp_folder.h"
#include "vdb_offset/core/error.h"

namespace vdb_offset::test {
namespace {

using Names = std::vector<std::string>;

void put(const std::filesystem::path& file, const std::string& text) {
  std::ofstream(file) << text;
}

/// While it lives no file can grow past `bytes`: what a full disk looks like to a writer.
class FullDisk {
 public:
  explicit FullDisk(rlim_t bytes) : old_handler_(std::signal(SIGXFSZ, SIG_IGN)) {
    ::getrlimit(RLIMIT_FSIZE, &old_limit_);
    const rlimit limit{bytes, old_limit_.rlim_max};
    ::setrlimit(RLIMIT_FSIZE, &limit);
  }
  ~FullDisk() {
    ::setrlimit(RLIMIT_FSIZE, &old_limit_);
    std::signal(SIGXFSZ, old_handler_);
  }
  FullDisk(const FullDisk&) = delete;
  FullDisk& operator=(const FullDisk&) = delete;

 private:
  rlimit old_limit_{};
  void (*old_handler_)(int);
};

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

TEST_CASE("output folder: swapped in, but not kept, the old one comes back") {
  const TempFolder folder;
  std::filesystem::create_directory(folder / "out");
  put(folder / "out/p_old.x", "old");
  {
    OutputFolder output(folder / "out", "p_", ".x");
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
    OutputFolder output(folder / "out", "p_", ".x");
    put(output.piece(name), name);
    output.swap_in();
    output.commit();
  }
  CHECK(folder.listing() == Names{"out", "out/p_second.x"});
}

TEST_CASE("output folder: a stranger's file that comes in meanwhile is not lost") {
  const TempFolder folder;
  std::filesystem::create_directory(folder / "out");
  OutputFolder output(folder / "out", "p_", ".x");
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
